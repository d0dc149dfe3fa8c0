/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the conversion of a scan to a LaserScan. Expected numbers follow from ROS's definition of
 * the message. */

#include <math.h>
#include <string.h>

#include "laser_scan.h"

#include "unity.h"

#define DEGREE 64u
#define NEAR 1e-6f

static sensor_msgs__msg__LaserScan message;
static laser_scan_memory_t memory;
static char frame[] = "laser";
static tmini_point_t points[4];
static tmini_scan_t scan;

void setUp(void)
{
    memset(&memory, 0xEE, sizeof memory);
    memset(&message, 0xEE, sizeof message);
    scan = (tmini_scan_t){.points = points, .frequency_chz = 600};
    laser_scan_init(&message, &memory, frame);
}

void tearDown(void) {}

static void add(uint16_t angle_q6, uint16_t distance_mm, uint8_t intensity)
{
    points[scan.count++] = (tmini_point_t){angle_q6, distance_mm, intensity, 0};
}

static void fill(void)
{
    TEST_ASSERT_TRUE(laser_scan_fill(&message, &memory, &scan, 0));
}

void test_the_rays_go_once_around_counter_clockwise_from_ahead(void)
{
    TEST_ASSERT_EQUAL_UINT(360, LASER_SCAN_RAYS);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, message.angle_min);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.01745329f, message.angle_increment);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 6.26573201f, message.angle_max);
}

void test_a_message_points_to_the_callers_memory(void)
{
    TEST_ASSERT_EQUAL_PTR(memory.ranges, message.ranges.data);
    TEST_ASSERT_EQUAL_UINT(360, message.ranges.size);
    TEST_ASSERT_EQUAL_UINT(360, message.ranges.capacity);
    TEST_ASSERT_EQUAL_PTR(memory.intensities, message.intensities.data);
    TEST_ASSERT_EQUAL_UINT(360, message.intensities.size);
    TEST_ASSERT_EQUAL_UINT(360, message.intensities.capacity);
}

void test_the_frame_is_the_callers(void)
{
    TEST_ASSERT_EQUAL_PTR(frame, message.header.frame_id.data);
    TEST_ASSERT_EQUAL_UINT(5, message.header.frame_id.size);
    TEST_ASSERT_EQUAL_UINT(6, message.header.frame_id.capacity);
}

void test_the_range_limits_are_those_of_the_data_sheet(void)
{
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.05f, message.range_min);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 12.0f, message.range_max);
}

void test_points_ahead_left_back_and_right_are_in_their_bins(void)
{
    add(0, 1000, 1);
    add(90 * DEGREE, 2000, 2); /* To the right: the lidar counts clockwise. */
    add(180 * DEGREE, 3000, 3);
    add(270 * DEGREE, 4000, 4);
    fill();
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 1.0f, message.ranges.data[0]);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 4.0f, message.ranges.data[90]);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 3.0f, message.ranges.data[180]);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 2.0f, message.ranges.data[270]);
}

void test_intensities_go_with_the_ranges(void)
{
    add(270 * DEGREE, 4000, 100);
    fill();
    TEST_ASSERT_EQUAL_FLOAT(100.0f, message.intensities.data[90]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, message.intensities.data[91]);
}

void test_ranges_are_in_metres(void)
{
    add(0, 7161, 1);
    fill();
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 7.161f, message.ranges.data[0]);
}

void test_a_ray_without_a_valid_range_is_not_a_number(void)
{
    add(0, 1000, 1);
    add(10 * DEGREE, 0, 9);
    fill();
    TEST_ASSERT_FALSE(isnan(message.ranges.data[0]));
    for (size_t ray = 1; ray < 360; ray++) {
        TEST_ASSERT_TRUE(isnan(message.ranges.data[ray]));
    }
}

void test_nothing_remains_of_the_previous_scan(void)
{
    add(0, 1000, 1);
    fill();
    scan.count = 0;
    fill();
    TEST_ASSERT_TRUE(isnan(message.ranges.data[0]));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, message.intensities.data[0]);
}

void test_the_turns_duration_comes_from_the_measured_frequency(void)
{
    fill();
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.16666667f, message.scan_time);
}

/* The lidar turns clockwise. Ray 90, to the left, was measured a quarter turn before the turn's
 * end. */
void test_the_time_increment_is_negative_as_the_lidar_turns_clockwise(void)
{
    fill();
    TEST_ASSERT_FLOAT_WITHIN(NEAR, -0.00046296f, message.time_increment);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -0.04166667f, 90.0f * message.time_increment);
}

void test_without_a_frequency_the_times_are_unknown(void)
{
    scan.frequency_chz = 0;
    fill();
    TEST_ASSERT_EQUAL_FLOAT(0.0f, message.scan_time);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, message.time_increment);
}

void test_the_stamp_is_the_scans_end(void)
{
    TEST_ASSERT_TRUE(laser_scan_fill(&message, &memory, &scan, INT64_C(1790000000123456789)));
    TEST_ASSERT_EQUAL_INT32(1790000000, message.header.stamp.sec);
    TEST_ASSERT_EQUAL_UINT32(123456789, message.header.stamp.nanosec);
}

void test_a_null_scan_is_refused(void)
{
    TEST_ASSERT_FALSE(laser_scan_fill(&message, &memory, NULL, 5));
    TEST_ASSERT_EQUAL_UINT32(0, message.header.stamp.nanosec);
}
