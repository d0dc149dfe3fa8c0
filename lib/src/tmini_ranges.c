/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_ranges.h"

#include "tmini_bins.h"

/* Counter-clockwise, beginning at the back. */
size_t tmini_ranges_bin(uint16_t angle_q6, size_t count)
{
    const uint32_t behind = TMINI_FULL_CIRCLE_Q6 / 2;
    return tmini_bin(behind + (angle_q6 > behind ? TMINI_FULL_CIRCLE_Q6 : 0) - angle_q6, count);
}

static void clear(uint16_t *ranges_mm, uint8_t *intensities, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        ranges_mm[i] = 0;
        if (intensities != NULL) {
            intensities[i] = 0;
        }
    }
}

/* The nearest point of a bin is its range. */
static void take(const tmini_point_t *point, uint16_t *range_mm, uint8_t *intensity)
{
    if (!tmini_is_nearer(point, *range_mm)) {
        return;
    }
    *range_mm = point->distance_mm;
    if (intensity != NULL) {
        *intensity = point->intensity;
    }
}

tmini_status_t tmini_ranges_of_scan(const tmini_scan_t *scan, uint16_t *ranges_mm,
                                    uint8_t *intensities, size_t count)
{
    if (scan == NULL || ranges_mm == NULL || count == 0 || count > UINT16_MAX) {
        return TMINI_ERROR_ARGUMENT;
    }
    clear(ranges_mm, intensities, count);
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        const size_t bin = tmini_ranges_bin(point->angle_q6, count);
        take(point, &ranges_mm[bin], intensities != NULL ? &intensities[bin] : NULL);
    }
    return TMINI_OK;
}
