/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* When the points of a scan were measured. */

#include "rows.h"

#include "tmini/tmini_units.h"
#include "unity.h"

#include <stdlib.h>

static tmini_point_t points[640];
static tmini_scan_t scan;

void setUp(void)
{
    scan = (tmini_scan_t){.points = points,
                          .count = 4,
                          .start_ms = 0xFFFFFFF0u,
                          .end_ms = 84, /* 100 ms later, across the wraparound of the clock. */
                          .frequency_chz = 1000,
                          .complete = true};
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows. Angles are sixty-fourths of a degree, with "d" degrees: 4d-1.
 *
 *     chz:630 count:640 incomplete upside-down    the scan's frequency, how many points it has, …
 *     took:120        its time by the clock
 *     angles:0,90d,180d,270d      its first points' angles
 *     period:160      its period in milliseconds
 *     @3:750          the time of the point with this index, in microseconds */

static void set_angles(const char *text)
{
    for (unsigned i = 0; text[0] != '\0'; i++) {
        char *rest;
        points[i].angle_q6 = (uint16_t)row_angle(text, &rest);
        text = rest + (rest[0] == ',' ? 1 : 0);
    }
}

static void tell_word(char *word)
{
    const row_number_t numbers[] = {{"period", tmini_scan_period_ms(&scan)}};
    const row_member_t members[] = {
        {"chz", MEMBER(scan.frequency_chz)},
        {"count", MEMBER(scan.count)},
    };
    if (row_stores(word, members)) {
        return;
    } else if (row_is(word, "took")) {
        scan.end_ms = scan.start_ms + row_number(word);
    } else if (row_is(word, "incomplete")) {
        scan.complete = false;
    } else if (row_is(word, "upside-down")) {
        scan.upside_down = true;
    } else if (row_is(word, "angles")) {
        set_angles(row_text(word));
    } else if (word[0] == '@') {
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(
            row_number(word), tmini_point_time_us(&scan, strtoul(word + 1, NULL, 10)), word);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

static const row_t rows[] IN_FLASH = {
    /* ---- Periods ---- */
    ROW(a_complete_scans_period_is_that_of_its_samples, /* At 4000 per second. */
        "count:640 chz:630 period:160 chz:0 period:160"),
    ROW(a_number_of_samples_that_no_revolution_has_is_not_believed, /* A sixteenth off 400. */
        "count:375 period:100 count:376 period:94 count:424 period:106 count:425 period:100"),
    ROW(a_number_of_samples_just_less_than_a_sixteenth_apart_is_believed, /* By 1 us. */
        "count:513 chz:731 period:128"),
    ROW(the_clock_is_not_asked_for_a_period, "took:120 period:100"), /* Bytes may be late. */
    ROW(a_period_is_rounded_to_the_nearest, /* 163.93, 81.499 and 160.5 ms. */
        "chz:610 period:164 chz:1227 period:81 chz:0 count:642 period:161"),
    ROW(an_incomplete_scans_period_is_what_the_lidar_measured, "incomplete chz:625 period:160"),
    ROW(an_unknown_period_is_0, "incomplete chz:0 period:0"),
    ROW(the_lowest_frequency_has_a_period_too, "incomplete chz:1 period:100000"),
    /* ---- Times of points: a quarter of 100 ms is 25,000 us ---- */
    ROW(a_points_time_goes_with_its_angle, /* The start angle need not be 0 (section 9.8). */
        "angles:115d,205d,295d,25d @0:0 @1:25000 @2:50000 @3:75000"),
    ROW(an_early_point_just_before_the_first_is_not_a_turn_later, "angles:10,8,180d,300d @1:0"),
    ROW(a_late_point_just_beyond_the_circle_is_a_turn_later, /* By 6 / 23040 of a turn. */
        "angles:10,90d,180d,16 @3:100026"),
    ROW(an_early_point_less_than_4_degrees_before_the_first_is_not_a_turn_later, /* Jitter. */
        "angles:0,356d,357d,358d @1:98888 angles:0,356d+1,357d,358d @1:0"),
    ROW(a_late_point_less_than_4_degrees_beyond_the_circle_is_a_turn_later,
        "angles:0,1d,8d,4d-1 @2:2222 @3:101106 angles:0,1d,8d,4d @3:1111"),
    ROW(the_third_of_three_points_may_be_a_turn_later, /* The second is 8 degrees away. */
        "angles:10,90d,16,0 @2:100026 angles:0,352d,1d,0 @2:100277 angles:0,353d,1d,0 @2:277"),
    ROW(the_late_points_of_a_part_of_a_turn_are_no_turn_later,
        "angles:0,20d,40d,80d incomplete @2:11111 @3:22222"),
    ROW(points_of_a_short_scan_are_not_a_turn_later, "angles:0,24,24,24 @1:104 @3:104"),
    ROW(a_scan_of_a_start_packet_alone_has_its_point_at_0, "count:1 angles:116d @0:0"),
    ROW(the_angles_of_a_lidar_upside_down_run_against_time,
        "upside-down angles:115d,25d,295d,205d @0:0 @1:25000 @2:50000 @3:75000 "
        "angles:10,280d,90d,4 @3:100026"),
    ROW(with_an_unknown_period_a_sample_takes_250_us,
        "angles:0,1,2,3 incomplete chz:0 @0:0 @3:750"),
    /* 23039 / 23040 of 2,857,142 us, rounded to 16 us. 0.34 Hz is impossible: unknown. */
    ROW(the_longest_period_does_not_overflow,
        "count:5 angles:0,90d,180d,23039,355d chz:35 @3:2857011 chz:34 @3:750"),
    ROW(a_small_step_back_near_four_degrees_is_no_turn, /* 255 * 6250 / 1440. */
        "angles:0,258,255,300 @1:1119 @2:1106"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* ---------------------------------------------------------------------------------- long scans */

/* A turn of 128.5 ms, computed as 16 times 8031 us; the last point is 5 / 23040 of a turn after
 * it. */
void test_late_points_beyond_256_are_a_turn_later(void)
{
    scan.count = 514;
    scan.frequency_chz = 781;
    for (uint16_t i = 0; i < 512; i++) {
        points[i].angle_q6 = (uint16_t)(i * 45u);
    }
    points[512].angle_q6 = 0;
    points[513].angle_q6 = 5;
    row_tell("@512:128496 @513:128523", tell_word);
    for (uint16_t i = 1; i < 256; i++) {
        points[i].angle_q6 = 0; /* Many early points change nothing. */
    }
    row_tell("@513:128523", tell_word);
}

/* The lidar turns at exactly `chz`, takes 4000 samples per second, and reports 0.05 Hz less. */
static void is_at_most_off(uint16_t chz, uint16_t count, bool complete, uint32_t off_us)
{
    scan = (tmini_scan_t){.points = points, .count = count, .complete = complete};
    scan.frequency_chz = (uint16_t)(chz - 5);
    for (uint16_t i = 0; i < count; i++) {
        points[i].angle_q6 = (uint16_t)((uint32_t)i * chz / 100u * 576u / 100u % 23040u);
        const uint32_t true_us = (uint32_t)i * 250u;
        const uint32_t time_us = tmini_point_time_us(&scan, i);
        TEST_ASSERT_UINT32_WITHIN(off_us, true_us, time_us);
    }
}

void test_points_are_a_millisecond_and_a_half_off_at_most(void)
{
    is_at_most_off(650, 615, true, 300);
    is_at_most_off(650, 600, false, 1500);
    is_at_most_off(1200, 333, true, 300);
    is_at_most_off(1200, 300, false, 1000);
}
