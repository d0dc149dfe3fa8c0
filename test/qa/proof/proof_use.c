/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proofs of the optional modules: ranges, sectors, mounting, times. For all angles and all numbers
 * of bins or sectors, nothing is written outside of the arrays, and nothing overflows. */

#include "proof.h"
#include "tmini/tmini_mount.h"
#include "tmini/tmini_ranges.h"
#include "tmini/tmini_sectors.h"
#include "tmini/tmini_units.h"

#define POINTS 3u

static tmini_point_t points[POINTS];

tmini_scan_t nondet_scan(void);
tmini_point_t nondet_point(void);

static tmini_scan_t any_scan(void)
{
    tmini_scan_t scan = nondet_scan();
    for (size_t i = 0; i < POINTS; i++) {
        points[i] = nondet_point();
        ASSUME(points[i].angle_q6 < TMINI_FULL_CIRCLE_Q6);
    }
    scan.points = points;
    scan.complete = any_bool();
    scan.upside_down = any_bool();
    ASSUME(scan.count <= POINTS);
    return scan;
}

/* Every angle has a bin and a sector, for any number of them. */
void prove_bins(void)
{
    const uint16_t angle_q6 = nondet_half();
    const uint16_t count = nondet_half();
    const tmini_sectors_t sectors = {.count = count};
    ASSUME(angle_q6 < TMINI_FULL_CIRCLE_Q6 && count >= 1);
    CLAIM(tmini_ranges_bin(angle_q6, count) < count);
    CLAIM(tmini_sectors_at(&sectors, angle_q6) < count);
}

void prove_ranges_of_scan(void)
{
    const tmini_scan_t scan = any_scan();
    uint16_t ranges_mm[4];
    uint8_t intensities[4];
    const size_t count = nondet_size();
    ASSUME(count <= 4);
    const tmini_status_t status =
        tmini_ranges_of_scan(&scan, ranges_mm, any_bool() ? intensities : NULL, count);
    CLAIM((status == TMINI_OK) == (count > 0));
}

void prove_sectors(void)
{
    const tmini_scan_t scan = any_scan();
    tmini_sector_t array[4];
    tmini_sectors_t sectors;
    const size_t count = nondet_size();
    ASSUME(count <= 4);
    if (tmini_sectors_init(&sectors, array, count, nondet_byte()) == TMINI_OK) {
        tmini_sectors_add_scan(&sectors, &scan);
    }
}

void prove_mount_angle(void)
{
    const tmini_mount_t mount = {.front_q6 = (int16_t)nondet_half(), .upside_down = any_bool()};
    const uint16_t angle_q6 = nondet_half();
    ASSUME(angle_q6 < TMINI_FULL_CIRCLE_Q6);
    CLAIM(tmini_mount_angle(&mount, angle_q6) < TMINI_FULL_CIRCLE_Q6);
}

static int16_t any_direction(void)
{
    const int16_t degrees = (int16_t)nondet_half();
    ASSUME(degrees >= -720 && degrees <= 720);
    return degrees;
}

void prove_mount(void)
{
    tmini_scan_t scan = any_scan();
    const tmini_arc_t arc = {any_direction(), any_direction()};
    const tmini_mount_t mount = {.front_q6 = (int16_t)nondet_half(),
                                 .upside_down = any_bool(),
                                 .offset_mm = (int16_t)nondet_half(),
                                 .min_mm = nondet_half(),
                                 .max_mm = nondet_half(),
                                 .masked = &arc,
                                 .masked_count = any_bool() ? 1 : 0};
    const size_t index = nondet_size();
    tmini_mount_step(&mount, &scan);
    CLAIM(index >= scan.count || points[index].angle_q6 < TMINI_FULL_CIRCLE_Q6);
}

/* A point's time is at most a revolution and its jitter. */
void prove_time(void)
{
    const tmini_scan_t scan = any_scan();
    const size_t index = nondet_size();
    ASSUME(scan.count >= 1 && index < scan.count);
    const uint32_t period_ms = tmini_scan_period_ms(&scan);
    const uint32_t time_us = tmini_point_time_us(&scan, index);
    /* The last points may be 4 degrees beyond the circle. The period has been rounded. */
    CLAIM(time_us <= (period_ms * 1000u + 500u) / 90 * 91 + 91);
    /* A reported frequency gives the period. 3 points are no revolution at any frequency. */
    CLAIM(scan.frequency_chz == 0 || period_ms == (100000000u / scan.frequency_chz + 500u) / 1000u);
    CLAIM(scan.frequency_chz > 0 || scan.complete || time_us == index * 250u);
}
