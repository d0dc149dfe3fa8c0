/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop: what a robot builder starts from. Shows the nearest obstacle in each of eight
 * sectors, and STOP when something is nearer than 30 cm in front.
 *
 *     obstacle_stop /dev/ttyUSB0          or the port that `tmini-sim --pty` prints */

#include <signal.h>
#include <stdio.h>

#include "obstacle.h"
#include "tmini/tmini_blocking.h"
#include "tmini_posix.h"

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_posix_t serial;
static obstacle_t obstacle;
static volatile sig_atomic_t ended;

static void end(int signal_number)
{
    (void)signal_number;
    ended = 1;
}

static void show(bool may_move)
{
    (void)printf("%s  front %5d  right %5d  back %5d  left %5d mm\n", may_move ? "go  " : "STOP",
                 obstacle.nearest_mm[0], obstacle.nearest_mm[2], obstacle.nearest_mm[4],
                 obstacle.nearest_mm[6]);
    (void)fflush(stdout);
}

/* In firmware this is the main loop; nothing else changes. */
static void drive(void)
{
    static bool could_move;
    const tmini_event_t event = tmini_poll(&lidar);
    const uint32_t now_ms = tmini_posix_port.now_ms(&serial);
    if (event == TMINI_EVENT_SCAN) {
        obstacle_see(&obstacle, tmini_scan(&lidar), now_ms);
    } else if (event == TMINI_EVENT_LOST || event == TMINI_EVENT_FAULT) {
        obstacle_blind(&obstacle);
    }
    const bool may_move = obstacle_may_move(&obstacle, now_ms);
    if (event == TMINI_EVENT_SCAN || may_move != could_move) {
        show(may_move); /* A robot sets its motors here, each time round. */
    }
    could_move = may_move;
}

int main(int argc, char **argv)
{
    const tmini_config_t config = {
        .port = &tmini_posix_port,
        .port_context = &serial,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
    };
    if (argc != 2) {
        (void)fprintf(stderr, "usage: obstacle_stop PORT\n");
        return 2;
    }
    const tmini_posix_status_t opened = tmini_posix_open(&serial, argv[1]);
    if (opened != TMINI_POSIX_OK) {
        (void)fprintf(stderr, "%s: %s\n", argv[1], tmini_posix_status_name(opened));
        return 1;
    }
    (void)signal(SIGINT, end);
    (void)signal(SIGTERM, end);
    (void)tmini_init(&lidar, &config);
    tmini_posix_attach(&serial, &lidar);
    (void)tmini_start(&lidar);
    while (ended == 0 && tmini_posix_receive(&serial, 10) == TMINI_POSIX_OK) {
        drive();
    }
    show(false); /* Without a lidar, whatever the reason, the robot stops. */
    (void)tmini_stop_and_wait(&lidar, 1000);
    tmini_posix_close(&serial);
    return ended != 0 ? 0 : 1;
}
