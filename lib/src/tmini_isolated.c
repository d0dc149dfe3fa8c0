/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_isolated.h"

#define REACH 2u /* Neighbours on each side. */

/* The arc of an angle at a range: angle / 64 * pi / 180 * range. No overflow: 16383 * 11520 / 128 *
 * 143 is below 2^32, and 143 / 2^19 is pi / 11520. */
static uint32_t arc_mm(uint32_t range_mm, uint32_t angle_q6)
{
    return range_mm * angle_q6 / 128u * 143u / 4096u;
}

/* The same in both directions. So a point that is removed was nobody's neighbour, and the result
 * does not depend on the order. */
static bool are_near(const tmini_isolated_t *limit, const tmini_point_t *one,
                     const tmini_point_t *other)
{
    const bool is_nearer = one->distance_mm < other->distance_mm;
    const uint32_t near_mm = is_nearer ? one->distance_mm : other->distance_mm;
    const uint32_t far_mm = is_nearer ? other->distance_mm : one->distance_mm;
    const uint32_t clockwise = tmini_clockwise(one->angle_q6, other->angle_q6);
    const uint32_t back = TMINI_FULL_CIRCLE_Q6 - clockwise;
    const uint32_t apart_mm =
        far_mm - near_mm + arc_mm(near_mm, clockwise < back ? clockwise : back);
    return near_mm != 0 &&
           100u * apart_mm <= (uint32_t)100 * limit->near_mm + limit->percent * near_mm;
}

static bool has_neighbour(const tmini_isolated_t *limit, const tmini_scan_t *scan, size_t index)
{
    for (size_t i = 1; i <= REACH && i < scan->count; i++) {
        const size_t after = index + i < scan->count ? index + i : index + i - scan->count;
        const size_t before = index >= i ? index - i : index + scan->count - i;
        if (are_near(limit, &scan->points[index], &scan->points[after]) ||
            are_near(limit, &scan->points[index], &scan->points[before])) {
            return true;
        }
    }
    return false;
}

void tmini_isolated_step(const void *isolated, tmini_scan_t *scan)
{
    tmini_isolated_t limit = {0};
    if (isolated != NULL) {
        limit = *(const tmini_isolated_t *)isolated;
    }
    limit.near_mm = limit.near_mm != 0 ? limit.near_mm : TMINI_ISOLATED_NEAR_MM;
    limit.percent = limit.percent != 0 ? limit.percent : TMINI_ISOLATED_PERCENT;
    for (size_t i = 0; i < scan->count; i++) {
        if (scan->points[i].distance_mm != 0 && !has_neighbour(&limit, scan, i)) {
            scan->points[i].distance_mm = 0;
        }
    }
}
