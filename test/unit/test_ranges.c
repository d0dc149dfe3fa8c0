/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ranges at equal angular steps, counter-clockwise from the back. */

#include "rows.h"

#include "tmini/tmini_ranges.h"
#include "unity.h"

#include <stdlib.h>

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

/* Words of the rows. Angles are sixty-fourths of a degree, with "d" degrees: 45d+1.
 *
 *     bin:90d:360=270 the angle belongs to this bin of 360
 *     90d:1000,11     a point at this angle, with distance and intensity; after: one after the scan
 *     eight           makes eight bins of the scan
 *     no-intensities  the same without their intensities
 *     4=500,5         the bin's range and intensity */

static void expect_bin(const char *text)
{
    char *rest;
    const uint16_t angle_q6 = (uint16_t)row_angle(text, &rest);
    const size_t count = strtoul(rest + 1, &rest, 10);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(strtoul(rest + 1, NULL, 10), tmini_ranges_bin(angle_q6, count),
                                   text);
}

/* "90d:1000,11" adds a point, "4=500,5" expects one. */
static void tell_numbers(const char *word)
{
    char *rest;
    const uint16_t place = (uint16_t)row_angle(word, &rest);
    const bool is_expected = rest[0] == '=';
    const uint16_t distance_mm = (uint16_t)strtoul(rest + 1, &rest, 10);
    const uint8_t intensity = (uint8_t)strtoul(rest + 1, NULL, 10);
    if (is_expected) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(distance_mm, ranges_mm[place], word);
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(intensity, intensities[place], word);
    } else {
        points[scan.count++] = (tmini_point_t){place, distance_mm, intensity, 0};
    }
}

static void tell_word(char *word)
{
    if (row_is(word, "bin")) {
        expect_bin(row_text(word));
    } else if (row_is(word, "after")) {
        scan.count--;
    } else if (row_is(word, "eight") || row_is(word, "no-intensities")) {
        TEST_ASSERT_EQUAL_INT(
            TMINI_OK,
            tmini_ranges_of_scan(&scan, ranges_mm, word[0] == 'e' ? intensities : NULL, BINS));
    } else {
        tell_numbers(word);
    }
}

static const row_t rows[] IN_FLASH = {
    ROW(the_bins_go_counter_clockwise_from_the_back, /* Right is -90 degrees in ROS, left 90. */
        "bin:180d:360=0 bin:90d:360=90 bin:0d:360=180 bin:270d:360=270 bin:181d:360=359 "
        "bin:179d:360=1"),
    ROW(a_bin_reaches_half_its_width_to_either_side, /* It has its boundary to the right. */
        "bin:45d:4=2 bin:45d+1:4=1 bin:315d:4=3 bin:315d+1:4=2 bin:135d+1:4=0 bin:225d:4=0 "
        "bin:225d+1:4=3"),
    ROW(one_bin_holds_everything, "bin:0d:1=0 bin:360d-1:1=0 bin:180d+1:1=0"),
    ROW(bins_can_be_65535, "bin:0d:65535=32768 bin:180d+1:65535=65532"), /* 32767.5, 65532.16. */
    ROW(a_scan_without_points_gives_no_ranges, "eight 0=0,0 3=0,0 7=0,0"),
    ROW(each_point_goes_to_its_bin_with_its_intensity,
        "0d:1000,11 90d:2000,22 180d:3000,33 270d:4000,44 eight 0=3000,33 1=0,0 2=2000,22 3=0,0 "
        "4=1000,11 5=0,0 6=4000,44 7=0,0"),
    ROW(the_nearest_point_of_a_bin_counts, "0d:700,7 1d:500,5 2d:600,6 eight 4=500,5"),
    ROW(of_points_that_are_equally_near_the_first_counts, "0d:500,5 1d:500,6 eight 4=500,5"),
    ROW(a_point_without_distance_is_no_range, "0d:0,9 90d:800,8 90d:0,9 eight 4=0,0 2=800,8"),
    ROW(intensities_may_be_left_out, "0d:1000,11 no-intensities 4=1000,238"), /* 0xEE. */
    ROW(a_scan_gives_all_its_points_and_none_after_them,
        "0d:900,9 90d:700,7 270d:600,6 after eight 0=0,0 2=700,7 4=900,9 6=0,0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
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
