/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Console output of the obstacle stops in examples/: one line for each important event, and one per
 * second. It needs no stdio. Your own program does not need this file. */

#ifndef LIDAR_LOG_H
#define LIDAR_LOG_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini/tmini.h"

typedef struct {
    const tmini_t *lidar;
    void (*print)(const char *text); /* Prints a piece of a line; "\n" ends the line. */
    uint32_t gaps;                   /* The sum over all scans. */
    uint32_t reported_ms;            /* When the last line was due. */
} lidar_log_t;

/* Call it with each event that tmini_poll() returns. */
void lidar_log_event(lidar_log_t *log, tmini_event_t event);

/* True once per second: then call lidar_log_status(). */
bool lidar_log_is_due(lidar_log_t *log, uint32_t now_ms);

/* Prints the line. `bytes`: received by the port; `lost`: bytes that did not reach the library. */
void lidar_log_status(const lidar_log_t *log, uint16_t ahead_mm, bool stop, uint32_t bytes,
                      uint32_t lost);

#endif
