/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar on a serial port, as the tool's commands use it: opened, driven, and left stopped, with a
 * message for everything that can go wrong. */

#ifndef DEVICE_H
#define DEVICE_H

#include "options.h"
#include "scan_list.h"
#include "tmini_posix.h"

typedef struct {
    tmini_t lidar;
    tmini_posix_t serial;
    const char *path;
    bool was_started;
    bool ignores_interrupt; /* While stopping. */
    uint8_t rx[4096];
    tmini_point_t points[SCAN_CAPACITY];
} device_t;

/* Opens the port of the options and sets the lidar up; sends nothing. From now on Ctrl-C is only noted.
 * Returns STATUS_OK, or the status to leave with, and says why. One at a time. */
int device_open(device_t **opened, const options_t *options);

/* Stops the lidar if it was started, and closes the port. */
void device_close(device_t *device);

/* The next event; TMINI_EVENT_NONE when none came within `timeout_ms`, when the port has failed, or
 * when Ctrl-C was pressed: ask device_is_usable(). */
tmini_event_t device_wait(device_t *device, uint32_t timeout_ms);

/* False once the port has failed or Ctrl-C was pressed. */
bool device_is_usable(const device_t *device);

/* Waits for the end of a command: `begun` is what the command's function returned, `wanted` the event
 * that ends it. Returns STATUS_OK, or STATUS_FAILED and says what is wrong and what to try. */
int device_finish(device_t *device, tmini_status_t begun, tmini_event_t wanted);

/* Begins to scan, and waits for the first packet. Returns as device_finish(). */
int device_start(device_t *device);

/* Stops scanning, and waits until the line is quiet. Returns as device_finish(). */
int device_stop(device_t *device);

/* Waits for the next scan. Returns NULL if none comes, and then device_why() says why. */
const tmini_scan_t *device_next_scan(device_t *device);

/* Says why the lidar does not do what it should, and what to try. Returns STATUS_FAILED; after Ctrl-C
 * says nothing. */
int device_why(const device_t *device);

#endif
