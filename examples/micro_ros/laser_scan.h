/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Converts a scan to ROS's LaserScan message, in the caller's memory: nothing is allocated.
 *
 * Ray 0 points ahead, the next one to its left, counter-clockwise and in equal steps, as ROS
 * counts. The lidar turns the other way, so the message's first ray is measured last: the header
 * has its time, and time_increment is negative. This is exact if the revolution begins ahead, as
 * with the T-mini Plus. */

#ifndef LASER_SCAN_H
#define LASER_SCAN_H

#include <sensor_msgs/msg/laser_scan.h>
#include <stdbool.h>
#include <stdint.h>

#include "tmini/tmini_ranges.h"

/* Rays in a message, an even number: with 360 hardly one is empty at 6 Hz, see tmini_ranges.h. */
#ifndef LASER_SCAN_RAYS
#define LASER_SCAN_RAYS 360u
#endif

/* Memory that a message points to, and memory to compute it. */
typedef struct {
    float ranges[LASER_SCAN_RAYS];
    float intensities[LASER_SCAN_RAYS];
    uint16_t bins_mm[LASER_SCAN_RAYS];
    uint8_t bin_intensities[LASER_SCAN_RAYS];
} laser_scan_memory_t;

/* Makes `message` use `memory`, and fills in what is the same in every scan. All three must outlive
 * the message's use; `frame_id` is the name of the lidar's frame, such as "laser". */
void laser_scan_init(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     char *frame_id);

/* Fills in a scan that ended at `end_ns` (nanoseconds of ROS's clock). A ray without a valid range
 * is NAN, because the lidar does not distinguish free space from an unseen obstacle. Returns false
 * and changes nothing if the scan is null. */
bool laser_scan_fill(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     const tmini_scan_t *scan, int64_t end_ns);

#endif
