/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program that uses each optional module once, on a scan of 400 points. Each function is one
 * module's use of it, called by optional.py. */

#include "tmini/tmini_cartesian.h"
#include "tmini/tmini_fields.h"
#include "tmini/tmini_isolated.h"
#include "tmini/tmini_mount.h"
#include "tmini/tmini_ranges.h"
#include "tmini/tmini_sectors.h"
#include "tmini/tmini_steps.h"
#include "tmini/tmini_units.h"

#define POINTS 400u

static tmini_point_t points[POINTS];
static tmini_scan_t scan = {.points = points, .count = POINTS, .complete = true};
static volatile uint32_t sink;

static const tmini_arc_t mast[] = {{170, 190}};
static const tmini_mount_t mount = {.front_q6 = 5594, .masked = mast, .masked_count = 1};
static const tmini_xy_t stop_box[] = {{0, -250}, {600, 250}};
static const tmini_xy_t hall[] = {{-5000, -5000}, {5000, 5000}};
static tmini_field_t list[] = {{.corners = stop_box, .corner_count = 2},
                               {.corners = hall, .corner_count = 2}};
static const tmini_fields_t far_field = {.list = &list[0], .count = 1};
static const tmini_fields_t near_field = {.list = &list[1], .count = 1};
static const tmini_one_step_t steps_list[] = {{tmini_mount_step, &mount}};
static const tmini_steps_t steps = {steps_list, 1};
static tmini_sector_t memory[8];
static tmini_sectors_t sectors;
static uint16_t ranges_mm[360];

/* A wall from 1.0 to 2.6 m away, and back. */
void bench_fill(void)
{
    for (uint16_t i = 0; i < POINTS; i++) {
        const uint16_t along = i < POINTS / 2 ? i : (uint16_t)(POINTS - i);
        points[i] = (tmini_point_t){.angle_q6 = (uint16_t)(i * 57u),
                                    .distance_mm = (uint16_t)(1000u + 8u * along)};
    }
    (void)tmini_fields_init(&far_field);
    (void)tmini_fields_init(&near_field);
    (void)tmini_sectors_init(&sectors, memory, 8, TMINI_FILTER_NONE);
}

#define USE(name, call)     \
    void bench_##name(void) \
    {                       \
        (void)(call);       \
    }

USE(mount, tmini_mount_step(&mount, &scan))
USE(steps, tmini_steps_step(&steps, &scan))
USE(fields, tmini_fields_step(&far_field, &scan))
USE(fields_near, tmini_fields_step(&near_field, &scan))
USE(isolated, tmini_isolated_step(NULL, &scan))
USE(sectors, tmini_sectors_add_scan(&sectors, &scan))
USE(ranges, tmini_ranges_of_scan(&scan, ranges_mm, NULL, 360))

void bench_cartesian(void)
{
    for (uint16_t i = 0; i < POINTS; i++) {
        sink = (uint32_t)tmini_cartesian_point(&points[i]).x_mm;
    }
}

void bench_units(void)
{
    for (uint16_t i = 0; i < POINTS; i++) {
        sink = tmini_point_time_us(&scan, i);
    }
}
