/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What `tmini calibrate` finds in scans: the robot's front from a wall, its own parts, and how far
 * ranges are off. No input or output. A function that cannot answer returns the reason, else
 * NULL. */

#ifndef CALIBRATE_H
#define CALIBRATE_H

#include "tmini/tmini_mount.h"

#define CALIBRATE_SCANS 20u
#define CALIBRATE_POINTS 16000u
#define CALIBRATE_TURNS 400u
#define CALIBRATE_ARCS 8u

/* Points of several scans of a robot that stands, in the lidar's directions. */
typedef struct {
    size_t count;
    unsigned scans;
    struct {
        double x; /* In mm: the lidar's 0 degrees, */
        double y; /* and 90 degrees clockwise of that. */
        unsigned scan;
    } points[CALIBRATE_POINTS];
} sample_t;

void calibrate_begin(sample_t *sample);
void calibrate_add(sample_t *sample, const tmini_scan_t *scan);

/* Adds an offset to each range. */
void calibrate_shift(sample_t *sample, double offset_mm);

typedef struct {
    double degrees;  /* The lidar's angle that is square to the wall. */
    double away_mm;  /* The wall's distance. */
    double long_mm;  /* How long it is. */
    double rough_mm; /* How far points are from it, root mean square. */
} wall_t;

/* The nearest wall; with `is_rough`, the nearest within 30 degrees of `rough_deg`. */
const char *calibrate_wall(sample_t *sample, bool is_rough, double rough_deg, wall_t *wall);

/* By how much ranges are too short, if what is straight ahead of the robot is `true_mm` away. */
const char *calibrate_offset(const sample_t *sample, double front_deg, double true_mm,
                             double *offset_mm);

/* What a robot that is turned sees in each of its own directions, in whole degrees. */
typedef struct {
    unsigned scans;
    uint16_t nearest_mm[CALIBRATE_TURNS][360]; /* UINT16_MAX: no point there; 0: no range. */
} turning_t;

void calibrate_begin_turning(turning_t *turning);
void calibrate_add_turning(turning_t *turning, const tmini_mount_t *mount,
                           const tmini_scan_t *scan);

/* The directions in which something turns with the robot, each two degrees wider than seen. */
const char *calibrate_masks(const turning_t *turning, tmini_arc_t arcs[CALIBRATE_ARCS],
                            size_t *count);

#endif
