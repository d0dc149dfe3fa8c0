/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: when each point of a scan was measured, for compensating the robot's own motion.
 * Integers only; nothing else in the library needs it.
 *
 * How well it is known: a scan's start_ms and end_ms are the times at which its start packet and
 * the next one had come, less what the bytes behind them took on the line. They are late by the
 * time that the bytes waited where nobody counts them (a UART's FIFO, a task's queue, a USB
 * adapter: some milliseconds) and by up to a millisecond of the clock. The difference of two points
 * of a scan is better: the rotor turns evenly. All functions: any context; no waiting. */

#ifndef TMINI_TIME_H
#define TMINI_TIME_H

#include <stddef.h>
#include <stdint.h>

#include "tmini_scan.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How long the revolution took, in milliseconds: by the clock if the scan is complete, and its two
 * start packets did not come in one block; else by the frequency that the lidar measured, from
 * which the clock's period may differ by a quarter. 0 if that is not known either. */
uint32_t tmini_scan_period_ms(const tmini_scan_t *scan);

/** When point `index` (below scan->count) was measured, in microseconds after scan->start_ms: by
 * its angle, or, when the period is not known, by its place at 4000 samples a second (section
 * 1). Two divisions. */
uint32_t tmini_point_time_us(const tmini_scan_t *scan, size_t index);

#ifdef __cplusplus
}
#endif

#endif
