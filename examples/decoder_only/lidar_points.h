/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Scans from the lidar's bytes, without the driver: ring, parser and scan builder. Your program
 * starts the lidar (A5 60) and stops it (A5 65). README.md says what you do without. */

#ifndef LIDAR_POINTS_H
#define LIDAR_POINTS_H

#include "tmini/parts/tmini_builder.h"

/* Call it once, before the receive interrupt is enabled. */
void lidar_points_init(void);

/* Call it from the UART's receive interrupt, for each byte. */
void lidar_points_byte(uint8_t byte);

/* Returns the next scan, or NULL: none has ended yet. Call it in your loop until it returns NULL.
 * The scan is valid until the next call. `now_ms`: your clock. It never waits. */
const tmini_scan_t *lidar_points_next(uint32_t now_ms);

#endif
