/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: points as the robot sees them, from a lidar that is mounted turned or upside down,
 * without those that the robot itself is in the way of, or that are nearer or farther than wanted.
 * Integers only; nothing else in the library needs it.
 *
 *     static const tmini_arc_t masts[] = {{170 * 64, 190 * 64}};
 *     static const tmini_mount_t mount = {.front_q6 = 90 * 64, .min_mm = 100,
 *                                         .masked = masts, .masked_count = 1};
 *     ...
 *     case TMINI_EVENT_SCAN: {
 *         const tmini_scan_t *const scan = tmini_scan(&lidar);
 *         const size_t count = tmini_mount_apply(&mount, scan->points, scan->count);
 *
 * The points stay in the order in which they were measured. All functions: any context; no
 * waiting. */

#ifndef TMINI_MOUNT_H
#define TMINI_MOUNT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The directions from `from_q6` clockwise to `to_q6`, both included, in 1/64 degree below 23040;
 * as the robot counts them, 0 to its front. From 350 to 10 degrees is 20 degrees wide. */
typedef struct {
    uint16_t from_q6; /**< Where it begins. */
    uint16_t to_q6;   /**< Where it ends. */
} tmini_arc_t;

/** How the lidar is mounted, and what is to be left out. All 0: nothing changes. */
typedef struct {
    uint16_t front_q6; /**< The lidar's angle that looks to the robot's front, below 23040. */
    bool upside_down;  /**< The lidar hangs: its angles run the other way round. */
    bool drops;        /**< What is masked or out of range is removed; else its distance is 0. */
    uint16_t min_mm;   /**< Distances below are out of range. */
    uint16_t max_mm;   /**< Distances above are; 0: none. */
    const tmini_arc_t *masked; /**< Directions in which the robot sees itself. */
    size_t masked_count;       /**< How many. */
} tmini_mount_t;

/** The robot's angle of a lidar's angle, both clockwise, in 1/64 degree, 0 to 23039. */
uint16_t tmini_mount_angle(const tmini_mount_t *mount, uint16_t angle_q6);

/** Changes `count` points in place. Returns how many are left: as many, unless the mount drops
 * some. A distance of 0, unknown, is never out of range. About 15 instructions a point, and 5 an
 * arc. */
size_t tmini_mount_apply(const tmini_mount_t *mount, tmini_point_t *points, size_t count);

#ifdef __cplusplus
}
#endif

#endif
