/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_mount.h"

#define Q6_PER_DEGREE 64
#define CIRCLE_DEG 360
#define CIRCLE_Q6 ((int32_t)TMINI_FULL_CIRCLE_Q6)
#define DISTANCE_MAX_MM 16383 /* Of a sample's 14 bits (section 5). */

/* Converts whole degrees, also negative ones, to 0 to 23039. It runs for each point, so it avoids a
 * division: on an 8-bit machine that would take longer than everything else. */
static uint16_t from_degrees(int16_t degrees)
{
    int16_t within = degrees;
    while (within < 0) {
        within = (int16_t)(within + CIRCLE_DEG);
    }
    while (within >= CIRCLE_DEG) {
        within = (int16_t)(within - CIRCLE_DEG);
    }
    return (uint16_t)(within * Q6_PER_DEGREE);
}

uint16_t tmini_mount_angle(const tmini_mount_t *mount, uint16_t angle_q6)
{
    int32_t within_q6 = (int32_t)angle_q6 - mount->front_q6;
    if (mount->upside_down) {
        within_q6 = -within_q6;
    }
    while (within_q6 < 0) {
        within_q6 += CIRCLE_Q6;
    }
    while (within_q6 >= CIRCLE_Q6) {
        within_q6 -= CIRCLE_Q6;
    }
    return (uint16_t)within_q6;
}

static bool is_in_arc(const tmini_arc_t *arc, uint16_t angle_q6)
{
    const uint16_t from_q6 = from_degrees(arc->from_deg);
    const uint16_t wide_q6 = tmini_clockwise(from_q6, from_degrees(arc->to_deg));
    const bool is_all_around = (int32_t)arc->to_deg - arc->from_deg >= CIRCLE_DEG;
    return is_all_around || tmini_clockwise(from_q6, angle_q6) <= wide_q6;
}

static bool is_masked(const tmini_mount_t *mount, uint16_t angle_q6)
{
    for (size_t i = 0; i < mount->masked_count; i++) {
        if (is_in_arc(&mount->masked[i], angle_q6)) {
            return true;
        }
    }
    return false;
}

static bool is_in_range(const tmini_mount_t *mount, uint16_t distance_mm)
{
    return distance_mm >= mount->min_mm && (mount->max_mm == 0 || distance_mm <= mount->max_mm);
}

/* An offset may neither make a range unknown nor the other way round. */
static uint16_t corrected(const tmini_mount_t *mount, uint16_t distance_mm)
{
    const int32_t sum_mm = (int32_t)distance_mm + mount->offset_mm;
    if (distance_mm == 0) {
        return 0;
    }
    return (uint16_t)(sum_mm < 1 ? 1 : sum_mm > DISTANCE_MAX_MM ? DISTANCE_MAX_MM : sum_mm);
}

void tmini_mount_point(const tmini_mount_t *mount, tmini_point_t *point)
{
    point->angle_q6 = tmini_mount_angle(mount, point->angle_q6);
    point->distance_mm = corrected(mount, point->distance_mm);
    if (!is_in_range(mount, point->distance_mm) || is_masked(mount, point->angle_q6)) {
        point->distance_mm = 0;
    }
}

void tmini_mount_step(const void *mount, tmini_scan_t *scan)
{
    const tmini_mount_t *const mounted = mount;
    if (mounted == NULL) {
        return;
    }
    scan->upside_down = mounted->upside_down;
    for (uint16_t i = 0; i < scan->count; i++) {
        tmini_mount_point(mounted, &scan->points[i]);
    }
}
