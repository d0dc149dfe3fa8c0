/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rows.h"

#include <stdio.h>

void row_print(uint64_t scan, uint64_t packet, size_t index, const tmini_point_t *point)
{
    (void)printf("%" PRIu64 ",%" PRIu64 ",%zu," ANGLE_FORMAT ",%d,%d,%d\n", scan, packet, index,
                 ANGLE_VALUES(point->angle_q6), point->distance_mm, point->intensity, point->flag);
}

void row_print_json(const tmini_point_t *points, size_t count)
{
    (void)putchar('[');
    for (size_t i = 0; i < count; i++) {
        (void)printf("%s[" ANGLE_FORMAT ",%d,%d,%d]", i > 0 ? "," : "",
                     ANGLE_VALUES(points[i].angle_q6), points[i].distance_mm, points[i].intensity,
                     points[i].flag);
    }
    (void)putchar(']');
}
