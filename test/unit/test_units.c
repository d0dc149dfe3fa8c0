/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The library's integers converted to floats: values that a float can hold must be exact. */

#include "tmini/tmini_units.h"
#include "unity.h"

void test_degrees_are_exact(void)
{
    TEST_ASSERT_TRUE(tmini_degrees(0) == 0.0f);
    TEST_ASSERT_TRUE(tmini_degrees(1) == 0.015625f);
    TEST_ASSERT_TRUE(tmini_degrees(23039) == 359.984375f);
}

#define NEAR(expected, call)  \
    {                         \
#call, expected, call \
    }

void test_other_values_are_right_to_ten_millionths(void)
{
    const tmini_scan_t scan = {.frequency_chz = 1000, .complete = true};
    const struct {
        const char *call;
        float expected;
        float value;
    } cases[] = {
        /* Radians are clockwise like degrees. */
        NEAR(0.0f, tmini_radians(0)),
        NEAR(1.5707963f, tmini_radians(5760)),
        NEAR(4.7123890f, tmini_radians(17280)),
        /* ROS's are counter-clockwise, from minus pi to pi: 5760 is to the right. */
        NEAR(0.0f, tmini_ros_radians(0)),
        NEAR(-1.5707963f, tmini_ros_radians(5760)),
        NEAR(-3.1415927f, tmini_ros_radians(11520)),
        NEAR(3.1413200f, tmini_ros_radians(11521)), /* pi - 2 pi / 23040 */
        NEAR(1.5707963f, tmini_ros_radians(17280)),
        NEAR(6.0f, tmini_hertz(600)),
        NEAR(11.9f, tmini_hertz(1190)),
        NEAR(0.149f, tmini_metres(149)),
        NEAR(12.0f, tmini_metres(12000)),
        /* 360 ranges are a degree apart. */
        NEAR(-3.1415927f, tmini_ranges_angle_min()),
        NEAR(0.0174533f, tmini_ranges_increment(360)),
        /* A scan takes its period, a bin its share of it, backwards. */
        NEAR(0.1f, tmini_ranges_scan_time(&scan)),
        NEAR(-0.00025f, tmini_ranges_time_increment(&scan, 400)),
        NEAR(0.05f, tmini_range_min()),
        NEAR(12.0f, tmini_range_max()),
    };
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const float error = cases[i].value - cases[i].expected;
        TEST_ASSERT_TRUE_MESSAGE(error < 1e-5f && error > -1e-5f, cases[i].call);
    }
}

void test_ranges_in_metres_name_what_is_missing_as_the_caller_wishes(void)
{
    static const uint16_t ranges_mm[4] = {1500, 0, 250, 100};
    float ranges_m[4] = {0};
    tmini_ranges_metres(ranges_mm, 3, -1.0f, ranges_m);
    TEST_ASSERT_TRUE(ranges_m[0] == 1.5f);
    TEST_ASSERT_TRUE(ranges_m[1] == -1.0f);
    TEST_ASSERT_TRUE(ranges_m[2] == 0.25f);
    TEST_ASSERT_TRUE(ranges_m[3] == 0.0f);
}
