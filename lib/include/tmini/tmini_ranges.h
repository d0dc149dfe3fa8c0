/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: a scan as ranges at equal angles, counter-clockwise, as a ROS LaserScan message needs
 * them. Integers only; tmini_units.h turns them into metres and radians. Nothing else in the
 * library needs it.
 *
 * The lidar counts angles clockwise, and its points have no fixed angles. ROS counts
 * counter-clockwise (x ahead, y to the left) and wants ranges at fixed steps. With
 * `count` bins:
 *
 *     bin i is centred on the ROS angle   -180 degrees + i * 360 degrees / count
 *     bin 0                is behind      (angle_min; angle_max is one bin short of +180 degrees)
 *     bin count / 4        is to the right
 *     bin count / 2        is ahead
 *     bin 3 * count / 4    is to the left
 *
 * so `count` is best a multiple of 4. A bin's range is that of its nearest point. At 6 Hz some of
 * 720 bins are empty, and hardly any of 360. */

#ifndef TMINI_RANGES_H
#define TMINI_RANGES_H

#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Writes `count` ranges in mm to `ranges_mm`, 0 where nothing was measured, and the intensities of
 * the same points to `intensities`, unless that is null. Both have room for `count` values. Any
 * context; no waiting; one division per point.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: scan or ranges null, count 0 or above 65535. */
tmini_status_t tmini_ranges_of_scan(const tmini_scan_t *scan, uint16_t *ranges_mm,
                                    uint8_t *intensities, size_t count);

/** Which of `count` bins (1 to 65535) contains an angle of the lidar (in 1/64 degree, below
 * TMINI_FULL_CIRCLE_Q6). Any context; no waiting; one division. */
size_t tmini_ranges_bin(uint16_t angle_q6, size_t count);

#ifdef __cplusplus
}
#endif

#endif
