/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: points as x and y in millimetres, in integers. x points ahead, y to the left, as in
 * ROS:
 *
 *              x
 *              ^               const tmini_xy_t at = tmini_cartesian_point(&scan->points[i]);
 *              |               if (scan->points[i].distance_mm != 0 && at.x_mm > 0 &&
 *        y <---L               at.x_mm < 500 && abs(at.y_mm) < 200) { stop(); }
 *
 * A point without a range is at (0, 0): look at its distance first. The error is at most 1.2 mm at
 * 12 m, at every angle. Any context; no waiting; on a Cortex-M4 about 80 instructions per point,
 * and no division. A table takes 184 bytes, on AVR of RAM. */

#ifndef TMINI_CARTESIAN_H
#define TMINI_CARTESIAN_H

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A place in millimetres. */
typedef struct {
    int16_t x_mm; /**< Ahead. */
    int16_t y_mm; /**< To the left. */
} tmini_xy_t;

/** The place in a direction, clockwise in 1/64 degree (below TMINI_FULL_CIRCLE_Q6), at a distance
 * of 0 to 32767 mm. */
tmini_xy_t tmini_cartesian(uint16_t angle_q6, uint16_t distance_mm);

/** The place of a point; (0, 0) if it has no range. */
static inline tmini_xy_t tmini_cartesian_point(const tmini_point_t *point)
{
    return tmini_cartesian(point->angle_q6, point->distance_mm);
}

#ifdef __cplusplus
}
#endif

#endif
