/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The obstacle stop of the examples: when may the robot move? */

#include "obstacle.h"

#include "unity.h"

#define DEGREE_Q6 64u

static tmini_point_t points[3];
static tmini_scan_t scan;
static obstacle_t obstacle;

void setUp(void)
{
    obstacle = (obstacle_t){.clear = false};
    scan = (tmini_scan_t){.points = points, .count = 1, .complete = true, .end_ms = 1000};
    points[0] = (tmini_point_t){.angle_q6 = 0, .distance_mm = 2000};
}

void tearDown(void) {}

static bool may_move_after(uint16_t distance_mm, unsigned degrees)
{
    points[0].distance_mm = distance_mm;
    points[0].angle_q6 = (uint16_t)(degrees * DEGREE_Q6);
    obstacle_see(&obstacle, &scan);
    return obstacle_may_move(&obstacle, 1000);
}

void test_it_may_not_move_before_the_first_scan(void)
{
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, 0));
}

void test_it_may_move_when_everything_is_far(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
}

void test_it_may_not_move_when_something_is_near_in_front(void)
{
    TEST_ASSERT_FALSE(may_move_after(299, 0));
    TEST_ASSERT_FALSE(may_move_after(299, 22));
    TEST_ASSERT_FALSE(may_move_after(299, 338));
}

/* The scan also has a distant point in front. */
static bool may_move_with(uint16_t distance_mm, unsigned degrees)
{
    scan.count = 2;
    points[1] = (tmini_point_t){.angle_q6 = 5 * DEGREE_Q6, .distance_mm = 2000};
    return may_move_after(distance_mm, degrees);
}

void test_a_near_object_elsewhere_does_not_stop_it(void)
{
    TEST_ASSERT_TRUE(may_move_with(100, 23));
    TEST_ASSERT_TRUE(may_move_with(100, 180));
    TEST_ASSERT_TRUE(may_move_with(100, 337));
}

void test_a_point_without_range_is_not_near(void)
{
    TEST_ASSERT_TRUE(may_move_with(0, 0));
}

void test_without_any_range_in_front_it_may_not_move(void)
{
    TEST_ASSERT_TRUE(may_move_with(2000, 0));
    scan.count = 1;
    TEST_ASSERT_FALSE(may_move_after(2000, 180));
}

void test_a_scan_without_any_range_is_blind_and_not_free(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    TEST_ASSERT_FALSE(may_move_after(0, 0));
}

void test_once_stopped_it_needs_more_room_to_go_on(void)
{
    TEST_ASSERT_FALSE(may_move_after(299, 0));
    TEST_ASSERT_FALSE(may_move_after(349, 0));
    TEST_ASSERT_TRUE(may_move_after(350, 0));
    TEST_ASSERT_TRUE(may_move_after(301, 0));
}

void test_it_stops_when_half_a_second_brings_no_complete_scan(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    TEST_ASSERT_TRUE(obstacle_may_move(&obstacle, 1499));
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, 1500));
}

void test_a_scan_that_is_seen_late_does_not_let_it_go(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    scan.end_ms = 1200;
    obstacle_see(&obstacle, &scan);
    TEST_ASSERT_TRUE(obstacle_may_move(&obstacle, 1699));
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, 1700));
}

void test_an_incomplete_scan_can_stop_it_but_not_let_it_go(void)
{
    scan.complete = false;
    TEST_ASSERT_FALSE(may_move_after(2000, 0));
    scan.complete = true;
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    scan.complete = false;
    TEST_ASSERT_FALSE(may_move_after(200, 0));
    TEST_ASSERT_FALSE(may_move_after(2000, 0));
}

void test_a_blind_robot_may_not_move(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    obstacle_blind(&obstacle);
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, 1000));
}

void test_each_sector_knows_its_nearest_point(void)
{
    scan.count = 3;
    points[0] = (tmini_point_t){.angle_q6 = 90 * DEGREE_Q6, .distance_mm = 700};
    points[1] = (tmini_point_t){.angle_q6 = 100 * DEGREE_Q6, .distance_mm = 600};
    points[2] = (tmini_point_t){.angle_q6 = 80 * DEGREE_Q6, .distance_mm = 800};
    obstacle_see(&obstacle, &scan);
    TEST_ASSERT_EQUAL_UINT16(600, obstacle.sectors[2].nearest_mm);
    TEST_ASSERT_EQUAL_UINT16(0, obstacle.sectors[0].nearest_mm);
}
