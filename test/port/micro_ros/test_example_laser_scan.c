/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests that a LaserScan message gets what port/ros2/src/tmini_laser.c makes of a scan, whose own
 * test is test/port/ros2/test_laser.c. */

#include <math.h>
#include <string.h>

#include "laser_scan.h"

#include "unity.h"

#define NEAR 1e-6f

static sensor_msgs__msg__LaserScan message;
static laser_scan_memory_t memory;
static char frame[] = "laser";
/* To the right; the lidar counts clockwise. */
static tmini_point_t points[] = {{0, 0, 9, 0}, {90 * 64, 7161, 100, 0}};
static tmini_scan_t scan;

void setUp(void)
{
    memset(&memory, 0xEE, sizeof memory);
    memset(&message, 0xEE, sizeof message);
    scan = (tmini_scan_t){.points = points,
                          .count = 2,
                          .frequency_chz = 1000,
                          .start_ms = 900,
                          .end_ms = 1000,
                          .complete = true};
    laser_scan_init(&message, &memory, frame);
}

void tearDown(void) {}

void test_a_message_points_to_the_callers_memory(void)
{
    TEST_ASSERT_EQUAL_UINT(360, LASER_SCAN_RAYS);
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

void test_every_field_is_filled_in(void)
{
    TEST_ASSERT_TRUE(laser_scan_fill(&message, &memory, &scan, INT64_C(1790000000123456789)));
    TEST_ASSERT_EQUAL_INT32(1790000000, message.header.stamp.sec);
    TEST_ASSERT_EQUAL_UINT32(123456789, message.header.stamp.nanosec);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, message.angle_min);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 6.26573201f, message.angle_max);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.01745329f, message.angle_increment);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.1f, message.scan_time);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, -0.00027778f, message.time_increment);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.05f, message.range_min);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 12.0f, message.range_max);
    TEST_ASSERT_FLOAT_WITHIN(NEAR, 7.161f, message.ranges.data[270]);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, message.intensities.data[270]);
    TEST_ASSERT_TRUE(isnan(message.ranges.data[0]));
}

/* A quarter of the next turn, the last one: it began at 1000 and the packet after it came late. */
void test_the_stamp_of_a_part_is_when_its_turn_ended(void)
{
    (void)laser_scan_fill(&message, &memory, &scan, 0);
    points[0].angle_q6 = 270 * 64;
    scan.count = 1;
    scan.complete = false;
    scan.start_ms = 1075;
    scan.end_ms = 1200;
    TEST_ASSERT_TRUE(laser_scan_fill(&message, &memory, &scan, INT64_C(5000000000)));
    points[0].angle_q6 = 0;
    TEST_ASSERT_EQUAL_INT32(4, message.header.stamp.sec);
    TEST_ASSERT_UINT32_WITHIN(500000, 900000000, message.header.stamp.nanosec);
}

void test_a_null_scan_is_refused(void)
{
    message.header.stamp.nanosec = 5;
    TEST_ASSERT_FALSE(laser_scan_fill(&message, &memory, NULL, 6));
    TEST_ASSERT_EQUAL_UINT32(5, message.header.stamp.nanosec);
}
