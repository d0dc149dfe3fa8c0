/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: scans in the robot's own directions, for a lidar that is mounted turned or upside down.
 * It also removes the robot's own parts, and ranges that are too near or too far. It is a step of
 * the configuration: each scan is changed once, before it is delivered. Integers only.
 *
 *     static const tmini_arc_t masts[] = {{170, 190}};
 *     static const tmini_mount_t mount = {.front_q6 = 5594,      87.4 degrees * 64
 *                                         .upside_down = true, .min_mm = 100,
 *                                         .masked = masts, .masked_count = 1};
 *
 *     static const tmini_config_t config = {
 *         ..., .step = tmini_mount_step, .step_data = &mount,
 *     };
 *
 * `tmini calibrate` finds the values for a robot. If there are more steps (tmini_steps.h), the
 * mounting comes first. Without a scan buffer, call tmini_mount_point() for each point. All
 * functions: any context; no waiting. */

#ifndef TMINI_MOUNT_H
#define TMINI_MOUNT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The directions from `from_deg` clockwise to `to_deg`, both included, in whole degrees. They are
 * the robot's directions: 0 is its front. {350, 10} and {-10, 10} are the same 20 degrees; {0, 360}
 * is the full circle. */
typedef struct {
    int16_t from_deg; /**< Where it begins. */
    int16_t to_deg;   /**< Where it ends. */
} tmini_arc_t;

/** How the lidar is mounted, and what is removed. All 0: nothing changes. */
typedef struct {
    int16_t front_q6;          /**< The angle that the lidar reports for the robot's front, in 1/64
                                * degree, also if it is upside down: 90 * 64 for 90 degrees. */
    bool upside_down;          /**< The lidar is upside down: its angles run the other way round. */
    int16_t offset_mm;         /**< Added to each distance but 0. The sum is 1 to 16383. */
    uint16_t min_mm;           /**< Smaller distances, offset included, become 0: an obstacle so
                                * near is unknown. Masks hide less. */
    uint16_t max_mm;           /**< Larger distances become 0; 0: no limit. */
    const tmini_arc_t *masked; /**< Directions in which the lidar sees the robot itself. */
    size_t masked_count;       /**< How many such directions there are. */
} tmini_mount_t;

/** Converts an angle of the lidar to the robot's: both clockwise, in 1/64 degree, 0 to 23039. */
uint16_t tmini_mount_angle(const tmini_mount_t *mount, uint16_t angle_q6);

/** Changes one point: its angle becomes the robot's, the offset is added to its distance, and the
 * distance becomes 0 (unknown) if it is masked or out of range. */
void tmini_mount_point(const tmini_mount_t *mount, tmini_point_t *point);

/** The step for the configuration's `step`, with a tmini_mount_t as its `step_data`; NULL changes
 * nothing. The points keep their order, and scan->upside_down makes their times right. About 50
 * instructions per point on a Cortex-M4, and 45 per arc. */
void tmini_mount_step(const void *mount, tmini_scan_t *scan);

#ifdef __cplusplus
}
#endif

#endif
