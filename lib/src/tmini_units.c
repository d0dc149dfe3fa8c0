/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_units.h"

#define CIRCLE_Q6 ((uint32_t)TMINI_FULL_CIRCLE_Q6)
#define JITTER_Q6 256u /* 4 degrees. */
#define SAMPLE_US 250u

/* No revolution takes longer; so nothing below overflows: 2 * 23040 * 3000 * 25 < 2^32. */
#define PERIOD_MAX_MS 3000u

uint32_t tmini_scan_period_ms(const tmini_scan_t *scan)
{
    const uint32_t told_ms = scan->frequency_chz > 0 ? 100000u / scan->frequency_chz : 0;
    const uint32_t timed_ms = scan->end_ms - scan->start_ms;
    const bool is_timed =
        told_ms == 0 || (timed_ms > told_ms / 4 * 3 && timed_ms < told_ms / 4 * 5);
    return scan->complete && is_timed ? timed_ms : told_ms;
}

/* The angle from the scan's first point to this one. The encoder jitters: early points may lie a
 * little behind the first, late ones a little beyond the full circle. */
static uint32_t swept_q6(const tmini_scan_t *scan, size_t index)
{
    const uint32_t swept = tmini_clockwise(scan->points[0].angle_q6, scan->points[index].angle_q6);
    const bool is_early = index < scan->count / 2u;
    if (is_early && swept > CIRCLE_Q6 - JITTER_Q6) {
        return 0;
    }
    return swept + (!is_early && swept < JITTER_Q6 ? CIRCLE_Q6 : 0);
}

uint32_t tmini_point_time_us(const tmini_scan_t *scan, size_t index)
{
    const uint32_t period_ms = tmini_scan_period_ms(scan);
    if (period_ms == 0 || period_ms > PERIOD_MAX_MS) {
        return (uint32_t)index * SAMPLE_US;
    }
    return swept_q6(scan, index) * period_ms * 25u / (CIRCLE_Q6 / 40u); /* 1000 / 23040 */
}
