/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * What a sensor_msgs/PointCloud2 holds, from a scan: its points as measured, in the order of their
 * times, each with its own. No ROS, nothing allocated. */

#ifndef TMINI_CLOUD_H
#define TMINI_CLOUD_H

#include "tmini_laser.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A point: five floats in this order, as the fields of the message. */
typedef struct {
    float x;         /**< Metres ahead. */
    float y;         /**< Metres to the left. */
    float z;         /**< 0. */
    float intensity; /**< 0 to 255. */
    float time;      /**< Seconds after the scan's start_ms, which is the message's stamp. */
} tmini_cloud_point_t;

/** Converts the points that have a range, in the directions and within the range of `config`.
 * `points` has room for scan->count. Returns how many there are. */
size_t tmini_cloud_of_scan(const tmini_laser_config_t *config, const tmini_scan_t *scan,
                           tmini_cloud_point_t *points);

#ifdef __cplusplus
}
#endif

#endif
