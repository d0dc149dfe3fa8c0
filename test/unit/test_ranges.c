/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ranges at equal angular steps, counter-clockwise from the back. */

#include "tmini/tmini_ranges.h"
#include "unity.h"

#define DEGREE 64u
#define BINS 8

static uint16_t ranges_mm[BINS + 1];
static uint8_t intensities[BINS + 1];
static tmini_point_t points[4];
static tmini_scan_t scan;

void setUp(void)
{
    for (size_t i = 0; i <= BINS; i++) {
        ranges_mm[i] = 0xEEEE;
        intensities[i] = 0xEE;
    }
    scan = (tmini_scan_t){.points = points};
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, ranges_mm[BINS]);
    TEST_ASSERT_EQUAL_HEX8(0xEE, intensities[BINS]);
}

static void add(uint16_t angle_q6, uint16_t distance_mm, uint8_t intensity)
{
    points[scan.count++] = (tmini_point_t){angle_q6, distance_mm, intensity, 0};
}

static void resample(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ranges_of_scan(&scan, ranges_mm, intensities, BINS));
}

void test_the_bins_go_counter_clockwise_from_the_back(void)
{
    TEST_ASSERT_EQUAL_size_t(0, tmini_ranges_bin(180 * DEGREE, 360));
    TEST_ASSERT_EQUAL_size_t(90, tmini_ranges_bin(90 * DEGREE, 360));   /* right, -90 in ROS */
    TEST_ASSERT_EQUAL_size_t(180, tmini_ranges_bin(0, 360));            /* ahead, 0 */
    TEST_ASSERT_EQUAL_size_t(270, tmini_ranges_bin(270 * DEGREE, 360)); /* left, +90 */
    TEST_ASSERT_EQUAL_size_t(359, tmini_ranges_bin(181 * DEGREE, 360));
    TEST_ASSERT_EQUAL_size_t(1, tmini_ranges_bin(179 * DEGREE, 360));
}

void test_a_bin_reaches_half_its_width_to_either_side(void)
{
    /* The bin straight ahead is one degree wide: from half a degree to the right to less than half
     * a degree to the left. */
    TEST_ASSERT_EQUAL_size_t(180, tmini_ranges_bin(32, 360));
    TEST_ASSERT_EQUAL_size_t(179, tmini_ranges_bin(33, 360));
    TEST_ASSERT_EQUAL_size_t(180, tmini_ranges_bin(23040 - 31, 360));
    TEST_ASSERT_EQUAL_size_t(181, tmini_ranges_bin(23040 - 32, 360));
    /* The same for the bin straight back, where the numbers begin. */
    TEST_ASSERT_EQUAL_size_t(0, tmini_ranges_bin(11520 - 31, 360));
    TEST_ASSERT_EQUAL_size_t(0, tmini_ranges_bin(11520 + 32, 360));
    TEST_ASSERT_EQUAL_size_t(359, tmini_ranges_bin(11520 + 33, 360));
}

void test_one_bin_holds_everything(void)
{
    TEST_ASSERT_EQUAL_size_t(0, tmini_ranges_bin(0, 1));
    TEST_ASSERT_EQUAL_size_t(0, tmini_ranges_bin(23039, 1));
    TEST_ASSERT_EQUAL_size_t(0, tmini_ranges_bin(11521, 1));
}

void test_65535_bins_do_not_overflow(void)
{
    TEST_ASSERT_EQUAL_size_t(32768, tmini_ranges_bin(0, 65535));     /* 32767.5 */
    TEST_ASSERT_EQUAL_size_t(65532, tmini_ranges_bin(11521, 65535)); /* 65532.16 */
}

void test_a_scan_without_points_gives_no_ranges(void)
{
    resample();
    for (size_t i = 0; i < BINS; i++) {
        TEST_ASSERT_EQUAL_UINT16(0, ranges_mm[i]);
        TEST_ASSERT_EQUAL_UINT8(0, intensities[i]);
    }
}

void test_each_point_goes_to_its_bin_with_its_intensity(void)
{
    add(0, 1000, 11);
    add(90 * DEGREE, 2000, 22);
    add(180 * DEGREE, 3000, 33);
    add(270 * DEGREE, 4000, 44);
    resample();
    static const uint16_t expected_mm[BINS] = {3000, 0, 2000, 0, 1000, 0, 4000, 0};
    static const uint8_t expected[BINS] = {33, 0, 22, 0, 11, 0, 44, 0};
    TEST_ASSERT_EQUAL_UINT16_ARRAY(expected_mm, ranges_mm, BINS);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(expected, intensities, BINS);
}

void test_the_nearest_point_of_a_bin_counts(void)
{
    add(0, 700, 7);
    add(64, 500, 5);
    add(128, 600, 6);
    resample();
    TEST_ASSERT_EQUAL_UINT16(500, ranges_mm[4]);
    TEST_ASSERT_EQUAL_UINT8(5, intensities[4]);
}

void test_of_points_that_are_equally_near_the_first_counts(void)
{
    add(0, 500, 5);
    add(64, 500, 6);
    resample();
    TEST_ASSERT_EQUAL_UINT16(500, ranges_mm[4]);
    TEST_ASSERT_EQUAL_UINT8(5, intensities[4]);
}

void test_a_point_without_distance_is_no_range(void)
{
    add(0, 0, 9);
    add(90 * DEGREE, 800, 8);
    add(90 * DEGREE, 0, 9);
    resample();
    TEST_ASSERT_EQUAL_UINT16(0, ranges_mm[4]);
    TEST_ASSERT_EQUAL_UINT8(0, intensities[4]);
    TEST_ASSERT_EQUAL_UINT16(800, ranges_mm[2]);
    TEST_ASSERT_EQUAL_UINT8(8, intensities[2]);
}

void test_intensities_may_be_left_out(void)
{
    add(0, 1000, 11);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ranges_of_scan(&scan, ranges_mm, NULL, BINS));
    TEST_ASSERT_EQUAL_UINT16(1000, ranges_mm[4]);
    TEST_ASSERT_EQUAL_HEX8(0xEE, intensities[4]);
}

/* Needs 128 KB: too large for a small machine. */
void test_65535_ranges_are_given(void)
{
#if defined(__linux__)
    static uint16_t many_mm[65536];
    many_mm[65534] = 0x5555;
    many_mm[65535] = 0x5555;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ranges_of_scan(&scan, many_mm, NULL, 65535));
    TEST_ASSERT_EQUAL_UINT16(0, many_mm[65534]);
    TEST_ASSERT_EQUAL_HEX16(0x5555, many_mm[65535]);
#endif
}

void test_a_scan_gives_all_its_points_and_none_after_them(void)
{
    static const uint16_t expected_mm[BINS] = {0, 0, 700, 0, 900, 0, 0, 0};
    add(0, 900, 9);
    add(90 * DEGREE, 700, 7);
    points[scan.count] = (tmini_point_t){270 * DEGREE, 600, 6, 0};
    resample();
    TEST_ASSERT_EQUAL_UINT16_ARRAY(expected_mm, ranges_mm, BINS);
}

/* 720 points half a degree apart, in 360 bins of a degree: too large for a small machine. */
void test_more_points_and_bins_than_256_are_all_there(void)
{
#if SIZE_MAX > 65535
    static uint16_t many_mm[360];
    static tmini_point_t many[720];
    scan = (tmini_scan_t){.points = many, .count = 720};
    for (uint16_t i = 0; i < 720; i++) {
        many[i] = (tmini_point_t){(uint16_t)(i * 32u), (uint16_t)(i + 1u), 0, 0};
    }
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ranges_of_scan(&scan, many_mm, NULL, 360));
    /* Each bin has the points at its degree and half a degree more. */
    for (uint16_t degree = 0; degree < 360; degree++) {
        TEST_ASSERT_EQUAL_UINT16(2 * degree + 1, many_mm[(180 + 360 - degree) % 360]);
    }
#endif
}

void test_arguments_out_of_range_are_refused_and_nothing_is_written(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ranges_of_scan(NULL, ranges_mm, NULL, BINS));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ranges_of_scan(&scan, NULL, NULL, BINS));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ranges_of_scan(&scan, ranges_mm, NULL, 0));
#if SIZE_MAX > 65535
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                          tmini_ranges_of_scan(&scan, ranges_mm, NULL, 65536));
#endif
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, ranges_mm[0]);
}
