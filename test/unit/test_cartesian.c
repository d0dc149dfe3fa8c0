/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Points as x and y. */

#include <float.h>

#include "tmini/tmini_cartesian.h"
#include "unity.h"

static void is_at(int16_t x_mm, int16_t y_mm, uint16_t degrees, uint16_t distance_mm)
{
    const tmini_point_t point = {(uint16_t)(degrees * 64u), distance_mm, 0, 0};
    const tmini_xy_t at = tmini_cartesian_point(&point);
    TEST_ASSERT_EQUAL_INT16(x_mm, at.x_mm);
    TEST_ASSERT_EQUAL_INT16(y_mm, at.y_mm);
}

void test_x_points_ahead_and_y_to_the_left(void)
{
    is_at(1000, 0, 0, 1000);
    is_at(0, -1000, 90, 1000);
    is_at(-1000, 0, 180, 1000);
    is_at(0, 1000, 270, 1000);
    is_at(866, -500, 30, 1000);
    is_at(-500, 866, 240, 1000);
    is_at(707, 707, 315, 1000);
}

void test_no_range_is_the_origin_and_the_farthest_is_no_overflow(void)
{
    is_at(0, 0, 77, 0);
    is_at(16383, 0, 0, 16383);
    is_at(0, 32767, 270, 32767);
    is_at(-32767, 0, 180, 32767);
}

/* A ray that turns by 1/64 degree at a time. */
static double largest_error_mm(uint16_t distance_mm)
{
    static const double cosine = 0.9999999628152566; /* Of 1/64 degree. */
    static const double sine = 0.00027270769224392545;
    double x = distance_mm;
    double y = 0;
    double largest = 0;
    for (uint16_t angle = 0; angle < TMINI_FULL_CIRCLE_Q6; angle++) {
        const tmini_xy_t at = tmini_cartesian(angle, distance_mm);
        const double square = (at.x_mm - x) * (at.x_mm - x) + (at.y_mm - y) * (at.y_mm - y);
        const double ahead = x * cosine + y * sine;
        y = y * cosine - x * sine;
        x = ahead;
        largest = square > largest ? square : largest;
    }
    TEST_ASSERT_TRUE(x > distance_mm - 0.001 && y < 0.001 && y > -0.001); /* Back at the front. */
    return largest;
}

/* The mean of many errors shows each entry of the table: none is off by more than its rounding. A
 * line between two of them is below the curve, so they are 19 millionths above it. */
static void check_entries(void)
{
    double x = 1;
    double y = 0; /* Of 0 degrees; then a degree more each time. */
    for (uint16_t degree = 0; degree < 90; degree++) {
        double sum = 0;
        for (uint16_t distance_mm = 30000; distance_mm < 32760; distance_mm++) {
            sum += -tmini_cartesian((uint16_t)(degree * 64u), distance_mm).y_mm -
                   y * 1.000019 * distance_mm;
        }
        const double off = sum / 2760 / 31380 * 65536;
        TEST_ASSERT_TRUE(off < 0.52 && off > -0.52);
        const double ahead = x * 0.9998476951563913 - y * 0.01745240643728351;
        y = y * 0.9998476951563913 + x * 0.01745240643728351;
        x = ahead;
    }
}

void test_at_every_angle_the_error_is_at_most_1_2_mm_at_12_m(void)
{
#if DBL_MANT_DIG > 24 /* Where a double is a float the ray goes astray. */
    check_entries();
    TEST_ASSERT_TRUE(largest_error_mm(12000) <= 1.2 * 1.2);
    TEST_ASSERT_TRUE(largest_error_mm(16383) <= 1.4 * 1.4);
    for (uint16_t distance_mm = 1; distance_mm < 12000;
         distance_mm = (uint16_t)(distance_mm + 499)) {
        TEST_ASSERT_TRUE(largest_error_mm(distance_mm) <= 1.2 * 1.2);
    }
#else
    (void)largest_error_mm;
    (void)check_entries;
#endif
}
