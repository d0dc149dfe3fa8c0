/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * What a sensor_msgs/LaserScan holds, from a scan: rays at equal angles in metres, and their times.
 * No ROS, nothing allocated: the node of port/ros2 and examples/micro_ros share it.
 *
 * Ray 0 lies where the lidar begins its turn, so that the rays' times are linear:
 * stamp + i * time_increment is right for every ray. A T-mini Plus begins ahead; the first complete
 * scan shows where another unit does. ROS counts counter-clockwise and the lidar turns clockwise:
 * ray 0 is the youngest, and time_increment is negative. */

#ifndef TMINI_LASER_H
#define TMINI_LASER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The most pairs of angles that can be masked. */
#define TMINI_LASER_MASKS_MAX 16u

/** Directions of the message, both included, in degrees from -180 to 180; `from` is not above
 * `to`. */
typedef struct {
    float from_deg; /**< Where it begins. */
    float to_deg;   /**< Where it ends, counter-clockwise. */
} tmini_laser_arc_t;

/** How the message is made. tmini_laser_default is for a lidar that stands upright. */
typedef struct {
    uint16_t rays;          /**< How many: an even number from 2. With 360 hardly one is empty. */
    bool is_mirrored;       /**< Angles grow as the lidar turns, for a lidar that hangs upside down;
                        * time_increment is then positive. */
    bool is_turned;         /**< 0 degrees of the message is the lidar's back. */
    bool missing_inf;       /**< A direction where the lidar saw nothing is INFINITY. False: NAN. */
    uint16_t min_mm;        /**< Nearer ranges are NAN: range_min. */
    uint16_t max_mm;        /**< Farther ones count as seen nothing: range_max. */
    tmini_laser_arc_t seen; /**< Outside of it everything is NAN. */
    size_t masked_count;    /**< How many of `masked` are used. */
    tmini_laser_arc_t masked[TMINI_LASER_MASKS_MAX]; /**< In these everything is NAN. */
} tmini_laser_config_t;

/** 360 rays, upright, 0.05 to 12 m, all around, NAN. */
extern const tmini_laser_config_t tmini_laser_default;

/** The fields of a message: radians, seconds and metres. */
typedef struct {
    float angle_min;
    float angle_max;
    float angle_increment;
    float time_increment; /**< 0 while the lidar's frequency is unknown, as scan_time. */
    float scan_time;
    float range_min;
    float range_max;
    int32_t stamp_us; /**< When ray 0 was measured, after the scan's end_ms: 0 or negative. */
} tmini_laser_fields_t;

/** A converter. Its members are private. */
typedef struct {
    tmini_laser_config_t config;
    bool is_known;  /* Whether a complete scan has shown where the turn begins. */
    uint16_t first; /* The bin of tmini_ranges.h there. */
} tmini_laser_t;

/** Sets up a converter; the configuration is copied. */
void tmini_laser_init(tmini_laser_t *laser, const tmini_laser_config_t *config);

/** Converts a scan: `ranges` and `intensities` have room for config.rays values each. A ray has the
 * nearest of its points. Until the first complete scan a turn counts as begun ahead. Returns false,
 * and writes nothing, if the scan is null or there are no rays. */
bool tmini_laser_of_scan(tmini_laser_t *laser, const tmini_scan_t *scan, float *ranges,
                         float *intensities, tmini_laser_fields_t *fields);

/** True if something at this angle of the message (in degrees, -180 to 180) is published. */
bool tmini_laser_sees(const tmini_laser_config_t *config, float degrees);

#ifdef __cplusplus
}
#endif

#endif
