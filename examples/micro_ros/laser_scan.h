/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Converts a scan to ROS's LaserScan message, in the caller's memory: nothing is allocated. What
 * the message holds is decided in port/ros2/src/tmini_laser.h. */

#ifndef LASER_SCAN_H
#define LASER_SCAN_H

#include <sensor_msgs/msg/laser_scan.h>
#include <stdbool.h>
#include <stdint.h>

#include "tmini_laser.h"

/* Rays in a message, an even number: with 360 hardly one is empty. */
#ifndef LASER_SCAN_RAYS
#define LASER_SCAN_RAYS 360u
#endif

/* Memory that a message points to, and memory to compute it. */
typedef struct {
    float ranges[LASER_SCAN_RAYS];
    float intensities[LASER_SCAN_RAYS];
    tmini_laser_t laser;
} laser_scan_memory_t;

/* Makes `message` use `memory`. All three must outlive the message's use; `frame_id` is the name of
 * the lidar's frame, such as "laser". */
void laser_scan_init(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     char *frame_id);

/* Fills in a scan that ended at `end_ns` (nanoseconds of ROS's clock). A ray without a valid range
 * is NAN, because the lidar does not distinguish free space from an unseen obstacle. Returns false
 * and changes nothing if the scan is null. */
bool laser_scan_fill(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     const tmini_scan_t *scan, int64_t end_ns);

#endif
