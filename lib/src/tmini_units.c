/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_units.h"

#define TURN_Q6 ((uint32_t)TMINI_FULL_CIRCLE_Q6)
#define JITTER_Q6 256u /* 4 degrees. */
#define SAMPLE_US 250u

/* Longer periods are not used, so nothing below overflows: 23295 * (2900000 / 16) < 2^32. */
#define PERIOD_MAX_US 2900000u

/* A complete scan has all samples of its revolution, 4000 per second (section 1). That is more
 * exact than the reported frequency, which has steps of 0.1 Hz. start_ms and end_ms are not used,
 * because they are as late as the bytes were. */
static uint32_t period_us(const tmini_scan_t *scan)
{
    const uint32_t reported_us = scan->frequency_chz > 0 ? 100000000u / scan->frequency_chz : 0;
    const uint32_t counted_us = (uint32_t)scan->count * SAMPLE_US;
    const uint32_t apart_us =
        counted_us > reported_us ? counted_us - reported_us : reported_us - counted_us;
    const bool is_counted = reported_us == 0 || apart_us < reported_us / 16;
    return scan->complete && is_counted ? counted_us : reported_us;
}

uint32_t tmini_scan_period_ms(const tmini_scan_t *scan)
{
    return (period_us(scan) + 500u) / 1000u;
}

/* The angle from the scan's first point to this one, as the rotor turns. */
static uint32_t turned_q6(const tmini_scan_t *scan, size_t index)
{
    const uint16_t first = scan->points[0].angle_q6;
    const uint16_t point = scan->points[index].angle_q6;
    return scan->upside_down ? tmini_clockwise(point, first) : tmini_clockwise(first, point);
}

/* Near enough that jitter alone can lead from here to the other side of the first point. */
static bool is_near_first(const tmini_scan_t *scan, size_t index)
{
    const uint32_t turned = turned_q6(scan, index);
    return turned < 2 * JITTER_Q6 || turned > TURN_Q6 - 2 * JITTER_Q6;
}

/* The angle turned since the first point, up to slightly more than a circle. Because of the
 * encoder's jitter, early points may lie slightly before the first one, and late points slightly
 * beyond the full circle. A point is late if some earlier point is not near the first one: at least
 * twice the jitter from it. */
static uint32_t swept_q6(const tmini_scan_t *scan, size_t index)
{
    const uint32_t turned = turned_q6(scan, index);
    size_t away = index;
    while (away > 0 && is_near_first(scan, away)) {
        away--;
    }
    if (away > 0) {
        return turned + (turned < JITTER_Q6 ? TURN_Q6 : 0);
    }
    return turned > TURN_Q6 - JITTER_Q6 ? 0 : turned;
}

uint32_t tmini_point_time_us(const tmini_scan_t *scan, size_t index)
{
    const uint32_t turn_us = period_us(scan);
    if (turn_us == 0 || turn_us > PERIOD_MAX_US) {
        return (uint32_t)index * SAMPLE_US;
    }
    return swept_q6(scan, index) * (turn_us / 16u) / (TURN_Q6 / 16u);
}
