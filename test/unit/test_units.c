/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The library's integers converted to floats: values that a float can hold must be exact. */

#include "tmini/tmini_units.h"
#include "unity.h"

static void expect_near(float expected, float value)
{
    const float error = value - expected;
    TEST_ASSERT_TRUE(error < 1e-5f && error > -1e-5f);
}

void test_degrees_are_exact(void)
{
    TEST_ASSERT_TRUE(tmini_degrees(0) == 0.0f);
    TEST_ASSERT_TRUE(tmini_degrees(1) == 0.015625f);
    TEST_ASSERT_TRUE(tmini_degrees(23039) == 359.984375f);
}

void test_radians_are_clockwise_like_degrees(void)
{
    expect_near(0.0f, tmini_radians(0));
    expect_near(1.5707963f, tmini_radians(5760));
    expect_near(4.7123890f, tmini_radians(17280));
}

void test_ros_radians_are_counter_clockwise_from_minus_pi_to_pi(void)
{
    expect_near(0.0f, tmini_ros_radians(0));
    expect_near(-1.5707963f, tmini_ros_radians(5760)); /* right */
    expect_near(-3.1415927f, tmini_ros_radians(11520));
    expect_near(3.1413200f, tmini_ros_radians(11521)); /* pi - 2 pi / 23040 */
    expect_near(1.5707963f, tmini_ros_radians(17280)); /* left */
}

void test_hundredths_become_hertz_and_millimetres_become_metres(void)
{
    expect_near(6.0f, tmini_hertz(600));
    expect_near(11.9f, tmini_hertz(1190));
    expect_near(0.149f, tmini_metres(149));
    expect_near(12.0f, tmini_metres(12000));
}

void test_360_ranges_are_a_degree_apart_from_minus_pi(void)
{
    expect_near(-3.1415927f, tmini_ranges_angle_min());
    expect_near(0.0174533f, tmini_ranges_increment(360));
}

void test_ranges_in_metres_name_what_is_missing_as_the_caller_wishes(void)
{
    static const uint16_t ranges_mm[4] = {1500, 0, 250, 100};
    float ranges_m[4] = {0};
    tmini_ranges_metres(ranges_mm, 3, -1.0f, ranges_m);
    expect_near(1.5f, ranges_m[0]);
    TEST_ASSERT_TRUE(ranges_m[1] == -1.0f);
    expect_near(0.25f, ranges_m[2]);
    TEST_ASSERT_TRUE(ranges_m[3] == 0.0f);
}

void test_a_scan_takes_its_period_and_a_bin_its_share_backwards(void)
{
    const tmini_scan_t scan = {.frequency_chz = 1000, .complete = true};
    expect_near(0.1f, tmini_ranges_scan_time(&scan));
    expect_near(-0.00025f, tmini_ranges_time_increment(&scan, 400));
}

void test_the_lidar_is_made_for_5_cm_to_12_m(void)
{
    expect_near(0.05f, tmini_range_min());
    expect_near(12.0f, tmini_range_max());
}
