/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A companion computer between the lidar and a flight controller:
 *
 *     mavlink_proximity LIDAR FLIGHT_CONTROLLER [SYSTEM_ID]
 *     mavlink_proximity /dev/ttyUSB0 /dev/serial0
 *
 * In firmware the loop is the same, and write_serial() is the second UART's. */

#define _GNU_SOURCE /* cfmakeraw() */

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "proximity.h"
#include "tmini/tmini_blocking.h"
#include "tmini_posix.h"

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_posix_t port;
static tmini_timing_t timing;
static proximity_t proximity;
static volatile sig_atomic_t ended;

static void end(int signal_number)
{
    (void)signal_number;
    ended = 1;
}

static int write_serial(void *context, const uint8_t *bytes, size_t count)
{
    const ssize_t written = write(*(const int *)context, bytes, count);
    if (written < 0 && errno != EAGAIN && errno != EINTR) {
        ended = 1; /* The flight controller's port is gone. */
    }
    return (int)written;
}

static int open_serial(const char *path)
{
    struct termios settings;
    const int file = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file >= 0 && tcgetattr(file, &settings) == 0) {
        cfmakeraw(&settings);
        (void)cfsetspeed(&settings, B115200);
        (void)tcsetattr(file, TCSANOW, &settings);
    }
    return file;
}

/* Mount and masks belong into `step`: angles must be the vehicle's. */
static tmini_posix_status_t set_up(const char *path)
{
    timing = tmini_timing_default;
    timing.frame_timeout_ms = 250; /* On a computer bytes may come late, and in bursts. */
    timing.max_pause_ms = 250;
    const tmini_config_t config = {.port = &tmini_posix_port,
                                   .port_context = &port,
                                   .rx_buffer = rx,
                                   .rx_size = sizeof rx,
                                   .points = points,
                                   .max_points = TMINI_SCAN_POINTS_TYPICAL,
                                   .frequency_chz = 1000,
                                   .timing = &timing};
    tmini_posix_init(&port, path);
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        return TMINI_POSIX_FAILED;
    }
    const tmini_posix_status_t status = tmini_posix_start(&port, &lidar);
    tmini_posix_reconnect(&port, true);
    return status;
}

static void work(void)
{
    tmini_event_t event = TMINI_EVENT_NONE;
    while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) {
        if (event == TMINI_EVENT_SCAN && tmini_faults(&lidar) == 0) {
            proximity_see(&proximity, tmini_scan(&lidar));
        }
    }
    proximity_poll(&proximity, tmini_posix_port.now_ms(&port));
}

static int run(const char *lidar_path, int *serial, int system_id)
{
    tmini_posix_status_t status = set_up(lidar_path);
    proximity_init(&proximity, write_serial, serial, (uint8_t)system_id);
    (void)tmini_start(&lidar);
    while (ended == 0 && status == TMINI_POSIX_OK) {
        work();
        status = tmini_posix_wait(&port, 5);
    }
    if (status != TMINI_POSIX_OK) {
        (void)fprintf(stderr, "%s: %s\n", lidar_path, tmini_posix_status_name(status));
        return 1;
    }
    (void)tmini_blocking_stop(&lidar, 1000);
    tmini_posix_stop(&port);
    return 0;
}

int main(int argc, char **argv)
{
    const int system_id = argc > 3 ? atoi(argv[3]) : 1;
    if (argc < 3 || argc > 4 || system_id < 1 || system_id > 255) {
        (void)fprintf(stderr, "usage: mavlink_proximity LIDAR FLIGHT_CONTROLLER [SYSTEM_ID]\n");
        return 2;
    }
    int serial = open_serial(argv[2]);
    if (serial < 0) {
        (void)fprintf(stderr, "%s: %s\n", argv[2], strerror(errno));
        return 1;
    }
    (void)signal(SIGINT, end);
    (void)signal(SIGTERM, end);
    const int status = run(argv[1], &serial, system_id);
    (void)close(serial);
    return status;
}
