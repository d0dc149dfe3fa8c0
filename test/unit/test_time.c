/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* When the points of a scan were measured. */

#include "tmini/tmini_units.h"
#include "unity.h"

#define DEGREE 64u

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

void tearDown(void) {}

static void has_angles(uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
    points[0].angle_q6 = a;
    points[1].angle_q6 = b;
    points[2].angle_q6 = c;
    points[3].angle_q6 = d;
}

static void is_at(size_t index, uint32_t time_us)
{
    TEST_ASSERT_EQUAL_UINT32(time_us, tmini_point_time_us(&scan, index));
}

/* 640 samples at 4000 per second. */
void test_a_complete_scans_period_is_that_of_its_samples(void)
{
    scan.count = 640;
    scan.frequency_chz = 630;
    TEST_ASSERT_EQUAL_UINT32(160, tmini_scan_period_ms(&scan));
    scan.frequency_chz = 0;
    TEST_ASSERT_EQUAL_UINT32(160, tmini_scan_period_ms(&scan));
}

/* The frequency gives 100 ms, 400 samples. 375 and 425 differ by a sixteenth. */
void test_a_number_of_samples_that_no_revolution_has_is_not_believed(void)
{
    static const uint16_t counts[] = {375, 376, 424, 425};
    static const uint8_t periods_ms[] = {100, 94, 106, 100};
    for (unsigned i = 0; i < 4; i++) {
        scan.count = counts[i];
        TEST_ASSERT_EQUAL_UINT32(periods_ms[i], tmini_scan_period_ms(&scan));
    }
}

/* 513 samples take 128,250 us, a period at 7.31 Hz 136,798 us: 1 us less than a sixteenth apart. */
void test_a_number_of_samples_just_less_than_a_sixteenth_apart_is_believed(void)
{
    scan.count = 513;
    scan.frequency_chz = 731;
    TEST_ASSERT_EQUAL_UINT32(128, tmini_scan_period_ms(&scan));
}

/* Start packets may have been held back, so their times are not used. */
void test_the_clock_is_not_asked_for_a_period(void)
{
    scan.end_ms = scan.start_ms + 120;
    TEST_ASSERT_EQUAL_UINT32(100, tmini_scan_period_ms(&scan));
}

/* 6.10 Hz are 163.93 ms, 12.27 Hz are 81.499 ms, 642 samples are 160.5 ms. */
void test_a_period_is_rounded_to_the_nearest(void)
{
    scan.frequency_chz = 610;
    TEST_ASSERT_EQUAL_UINT32(164, tmini_scan_period_ms(&scan));
    scan.frequency_chz = 1227;
    TEST_ASSERT_EQUAL_UINT32(81, tmini_scan_period_ms(&scan));
    scan.frequency_chz = 0;
    scan.count = 642;
    TEST_ASSERT_EQUAL_UINT32(161, tmini_scan_period_ms(&scan));
}

void test_an_incomplete_scans_period_is_what_the_lidar_measured(void)
{
    scan.complete = false;
    scan.frequency_chz = 625;
    TEST_ASSERT_EQUAL_UINT32(160, tmini_scan_period_ms(&scan));
}

void test_an_unknown_period_is_0(void)
{
    scan.complete = false;
    scan.frequency_chz = 0;
    TEST_ASSERT_EQUAL_UINT32(0, tmini_scan_period_ms(&scan));
}

/* 0.01 Hz. */
void test_the_lowest_frequency_has_a_period_too(void)
{
    scan.complete = false;
    scan.frequency_chz = 1;
    TEST_ASSERT_EQUAL_UINT32(100000, tmini_scan_period_ms(&scan));
}

/* A quarter of 100 ms is 25,000 us. The start angle need not be 0 (section 9.8). */
void test_a_points_time_goes_with_its_angle(void)
{
    has_angles(115 * DEGREE, 205 * DEGREE, 295 * DEGREE, 25 * DEGREE);
    is_at(0, 0);
    is_at(1, 25000);
    is_at(2, 50000);
    is_at(3, 75000);
}

void test_an_early_point_just_before_the_first_is_not_a_turn_later(void)
{
    has_angles(10, 8, 180 * DEGREE, 300 * DEGREE);
    is_at(1, 0);
}

/* 6 / 23040 of 100 ms are 26 us. */
void test_a_late_point_just_beyond_the_circle_is_a_turn_later(void)
{
    has_angles(10, 90 * DEGREE, 180 * DEGREE, 16);
    is_at(3, 100026);
}

/* The encoder jitters by less than 4 degrees. 22784 / 23040 of 100 ms are 98,888 us. */
void test_an_early_point_less_than_4_degrees_before_the_first_is_not_a_turn_later(void)
{
    has_angles(0, 356 * DEGREE, 357 * DEGREE, 358 * DEGREE);
    is_at(1, 98888);
    has_angles(0, 356 * DEGREE + 1, 357 * DEGREE, 358 * DEGREE);
    is_at(1, 0);
}

/* 512 / 23040 of 100 ms are 2222 us; (255 + 23040) / 23040 are 101,106 us. */
void test_a_late_point_less_than_4_degrees_beyond_the_circle_is_a_turn_later(void)
{
    has_angles(0, 1 * DEGREE, 8 * DEGREE, 4 * DEGREE - 1);
    is_at(2, 2222);
    is_at(3, 101106);
}

/* A point near the first one is a turn later if the second point is at least 8 degrees away. */
void test_the_third_of_three_points_may_be_a_turn_later(void)
{
    has_angles(10, 90 * DEGREE, 16, 0);
    is_at(2, 100026);
    has_angles(0, 352 * DEGREE, 1 * DEGREE, 0);
    is_at(2, 100277);
}

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
    is_at(512, 128496);
    is_at(513, 128523);
    for (uint16_t i = 1; i < 256; i++) {
        points[i].angle_q6 = 0; /* Many early points change nothing. */
    }
    is_at(513, 128523);
}

/* All points of a partial scan are in its first turn. */
void test_the_late_points_of_a_part_of_a_turn_are_no_turn_later(void)
{
    has_angles(0, 20 * DEGREE, 40 * DEGREE, 80 * DEGREE);
    scan.complete = false;
    is_at(2, 11111);
    is_at(3, 22222);
}

/* 24 / 23040 of 100 ms are 104 us. */
void test_points_of_a_short_scan_are_not_a_turn_later(void)
{
    has_angles(0, 24, 24, 24);
    is_at(1, 104);
    is_at(3, 104);
}

void test_a_scan_of_a_start_packet_alone_has_its_point_at_0(void)
{
    scan.count = 1;
    has_angles(116 * DEGREE, 0, 0, 0);
    is_at(0, 0);
}

void test_the_angles_of_a_lidar_upside_down_run_against_time(void)
{
    scan.upside_down = true;
    has_angles(115 * DEGREE, 25 * DEGREE, 295 * DEGREE, 205 * DEGREE);
    is_at(0, 0);
    is_at(1, 25000);
    is_at(2, 50000);
    is_at(3, 75000);
    has_angles(10, 280 * DEGREE, 90 * DEGREE, 4);
    is_at(3, 100026);
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

void test_with_an_unknown_period_a_sample_takes_250_us(void)
{
    has_angles(0, 1, 2, 3);
    scan.complete = false;
    scan.frequency_chz = 0;
    is_at(0, 0);
    is_at(3, 750);
}

/* 23039 / 23040 of 2,857,142 us, rounded to 16 us. 0.34 Hz is impossible, so it counts as
 * unknown. */
void test_the_longest_period_does_not_overflow(void)
{
    has_angles(0, 90 * DEGREE, 180 * DEGREE, 23039);
    points[2].angle_q6 = 180 * DEGREE;
    scan.count = 5;
    points[4].angle_q6 = 355 * DEGREE;
    points[3].angle_q6 = 23039;
    scan.frequency_chz = 35;
    is_at(3, 2857011);
    scan.frequency_chz = 34;
    is_at(3, 750);
}

/* Between 0 and 4.03 degrees; 255 * 6250 / 1440. */
void test_a_small_step_back_near_four_degrees_is_no_turn(void)
{
    has_angles(0, 258, 255, 300);
    is_at(1, 1119);
    is_at(2, 1106);
}
