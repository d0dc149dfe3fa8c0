/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_mount.h"

uint16_t tmini_mount_angle(const tmini_mount_t *mount, uint16_t angle_q6)
{
    return mount->upside_down ? tmini_clockwise(angle_q6, mount->front_q6)
                              : tmini_clockwise(mount->front_q6, angle_q6);
}

static bool is_masked(const tmini_mount_t *mount, uint16_t angle_q6)
{
    for (size_t i = 0; i < mount->masked_count; i++) {
        const tmini_arc_t *const arc = &mount->masked[i];
        if (tmini_clockwise(arc->from_q6, angle_q6) <= tmini_clockwise(arc->from_q6, arc->to_q6)) {
            return true;
        }
    }
    return false;
}

static bool is_in_range(const tmini_mount_t *mount, uint16_t distance_mm)
{
    return distance_mm == 0 ||
           (distance_mm >= mount->min_mm && (mount->max_mm == 0 || distance_mm <= mount->max_mm));
}

size_t tmini_mount_apply(const tmini_mount_t *mount, tmini_point_t *points, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        tmini_point_t point = points[i];
        point.angle_q6 = tmini_mount_angle(mount, point.angle_q6);
        if (!is_in_range(mount, point.distance_mm) || is_masked(mount, point.angle_q6)) {
            if (mount->drops) {
                continue;
            }
            point.distance_mm = 0;
        }
        points[kept++] = point;
    }
    return kept;
}
