/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* This is no safety function: where people can be hurt, use a certified scanner or a bumper.
 *
 * Obstacle stop: a starting point for robots. Shows the nearest obstacle in each of eight sectors,
 * and STOP when something is in the box before the robot, or when that is unknown.
 *
 *     obstacle_stop /dev/ttyUSB0          or the port that `tmini-sim --pty` prints */

#define _GNU_SOURCE /* getopt_long() */

#include <getopt.h>
#include <signal.h>
#include <stdio.h>

#include "obstacle.h"
#include "tmini/tmini_blocking.h"
#include "tmini/tmini_names.h"
#include "tmini_posix.h"

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_posix_t port;
static tmini_timing_t timing;
static obstacle_t obstacle;
static volatile sig_atomic_t ended;

static void end(int signal_number)
{
    (void)signal_number;
    ended = 1;
}

static void show_header(void)
{
    (void)puts("mm    front    45°  right   135°   back   225°   left   315°");
    (void)fflush(stdout);
}

static void show(bool may_move)
{
    (void)printf("%s", may_move ? "go  " : "STOP");
    for (unsigned i = 0; i < OBSTACLE_SECTORS; i++) {
        (void)printf("  %5d", obstacle.sectors[i].nearest_mm);
    }
    (void)putchar('\n');
    (void)fflush(stdout);
}

static void tell(tmini_event_t event)
{
    if (event == TMINI_EVENT_COMMAND_FAILED) {
        (void)fprintf(stderr, "the lidar does not start: %s; trying again\n",
                      tmini_status_name(tmini_command_error(&lidar)));
    } else if (event == TMINI_EVENT_LOST) {
        (void)fprintf(stderr, "the lidar has fallen silent; starting it again\n");
    } else if (event == TMINI_EVENT_FAULTS_CHANGED) {
        char faults[TMINI_FAULTS_TEXT_SIZE];
        (void)fprintf(stderr, "the lidar's faults: %s\n",
                      tmini_faults_text(tmini_faults(&lidar), faults, sizeof faults));
    }
}

/* In firmware this is the main loop; nothing else changes. */
static void drive(void)
{
    static bool could_move;
    bool is_news = false;
    tmini_event_t event = TMINI_EVENT_NONE;
    while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) {
        tell(event);
        if (event == TMINI_EVENT_SCAN) {
            obstacle_see(&obstacle, tmini_scan(&lidar));
            is_news = true;
        }
    }
    /* Checked in each round, not only when the fault begins: a faulty lidar may still send
     * scans. */
    if (tmini_faults(&lidar) != 0 || tmini_state(&lidar) != TMINI_STATE_SCANNING) {
        obstacle_blind(&obstacle);
    }
    const bool may_move = obstacle_may_move(&obstacle, tmini_posix_port.now_ms(&port));
    if (is_news || may_move != could_move) {
        show(may_move); /* A robot sets its motors here, in each round. */
    }
    could_move = may_move;
}

static tmini_posix_status_t set_up(const char *path)
{
    timing = tmini_timing_default;
    timing.frame_timeout_ms = 250; /* On a computer bytes may come late. */
    timing.max_pause_ms = 250;     /* They may also come in bursts. */
    const tmini_config_t config = {
        .port = &tmini_posix_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
        .timing = &timing,
    };
    tmini_posix_init(&port, path);
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        return TMINI_POSIX_FAILED;
    }
    const tmini_posix_status_t status = tmini_posix_start(&port, &lidar);
    tmini_posix_reconnect(&port, true); /* Continue when the cable is pulled and plugged in. */
    return status;
}

/* Runs until the user or the port ends it. */
static tmini_posix_status_t run(void)
{
    tmini_posix_status_t status = TMINI_POSIX_OK;
    (void)tmini_start(&lidar); /* Holds until it is stopped. */
    while (ended == 0 && status == TMINI_POSIX_OK) {
        drive();
        status = tmini_posix_wait(&port, 10);
    }
    show(false); /* Without a lidar, whatever the reason, the robot stops. */
    (void)tmini_blocking_stop(&lidar, 1000);
    tmini_posix_stop(&port);
    return status;
}

static int usage(FILE *file, int status)
{
    (void)fprintf(file, "usage: obstacle_stop PORT, or obstacle_stop -p PORT\n");
    return status;
}

/* Returns the port, or NULL and the exit status. The syntax is that of the host tool. */
static const char *read_options(int argc, char **argv, int *status)
{
    static const struct option options[] = {{"port", required_argument, NULL, 'p'},
                                            {"help", no_argument, NULL, 'h'},
                                            {"version", no_argument, NULL, 'V'},
                                            {NULL, 0, NULL, 0}};
    const char *path = NULL;
    int letter = 0;
    while ((letter = getopt_long(argc, argv, "p:hV", options, NULL)) != -1) {
        switch (letter) {
        case 'p':
            path = optarg;
            break;
        case 'h':
            *status = usage(stdout, 0);
            return NULL;
        case 'V':
            *status = 0;
            (void)puts("obstacle_stop " TMINI_VERSION_TEXT);
            return NULL;
        default:
            *status = usage(stderr, 2);
            return NULL;
        }
    }
    path = path == NULL && optind < argc ? argv[optind++] : path;
    if (path == NULL || optind < argc) {
        *status = usage(stderr, 2);
        return NULL;
    }
    return path;
}

int main(int argc, char **argv)
{
    int wrong = 0;
    const char *const path = read_options(argc, argv, &wrong);
    if (path == NULL) {
        return wrong;
    }
    tmini_posix_status_t status = set_up(path);
    if (status == TMINI_POSIX_OK) {
        (void)signal(SIGINT, end);
        (void)signal(SIGTERM, end);
        if (signal(SIGHUP, end) == SIG_IGN) { /* Under `nohup` it stays ignored. */
            (void)signal(SIGHUP, SIG_IGN);
        }
        show_header();
        status = run();
    }
    if (status != TMINI_POSIX_OK) {
        (void)fprintf(stderr, "%s: %s\n", path, tmini_posix_status_name(status));
        return 1;
    }
    return 0;
}
