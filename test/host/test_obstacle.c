/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The obstacle stop of the examples: when may the robot move? test_fields.c has the fields. */

#include "obstacle.h"

#include "unity.h"

#define DEGREE_Q6 64u

static tmini_point_t points[40];
static tmini_scan_t scan;
static obstacle_t obstacle;
static uint32_t now_ms;

void setUp(void)
{
    obstacle = (obstacle_t){.moves = false};
    now_ms = 1000;
}

void tearDown(void) {}

/* Three scans, 100 ms apart, with something ten degrees wide at this distance and angle, and 2 m
 * all around. */
static bool may_move_after(uint16_t distance_mm, unsigned degrees)
{
    scan = (tmini_scan_t){.points = points, .count = 40, .complete = true};
    for (uint16_t i = 0; i < 40; i++) {
        points[i] =
            (tmini_point_t){.angle_q6 = (uint16_t)(i * 9u * DEGREE_Q6), .distance_mm = 2000};
    }
    for (unsigned i = 0; i < 2; i++) {
        const unsigned place = (degrees + 9 * i) / 9 % 40;
        points[place].angle_q6 = (uint16_t)((degrees + 5 * i) % 360 * DEGREE_Q6);
        points[place].distance_mm = distance_mm;
    }
    for (unsigned i = 0; i < 3; i++) {
        now_ms += 100;
        scan.end_ms = now_ms;
        obstacle_see(&obstacle, &scan);
    }
    return obstacle_may_move(&obstacle, now_ms);
}

void test_it_may_move_when_complete_scans_have_seen_that_the_way_is_free(void)
{
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, now_ms));
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
}

void test_what_is_before_it_stops_it_and_what_is_beside_it_does_not(void)
{
    TEST_ASSERT_FALSE(may_move_after(290, 0));
    TEST_ASSERT_FALSE(may_move_after(290, 20));
    TEST_ASSERT_FALSE(may_move_after(290, 335));
    TEST_ASSERT_TRUE(may_move_after(200, 50));
    TEST_ASSERT_TRUE(may_move_after(100, 180));
    TEST_ASSERT_TRUE(may_move_after(200, 305));
}

void test_once_stopped_it_needs_more_room_to_go_on(void)
{
    TEST_ASSERT_TRUE(may_move_after(360, 0));
    TEST_ASSERT_TRUE(may_move_after(310, 0));
    TEST_ASSERT_FALSE(may_move_after(290, 0));
    TEST_ASSERT_FALSE(may_move_after(340, 0));
    TEST_ASSERT_TRUE(may_move_after(360, 0));
}

void test_it_stops_when_three_turns_bring_no_complete_scan(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    TEST_ASSERT_TRUE(obstacle_may_move(&obstacle, now_ms + 300));
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, now_ms + 301));
}

void test_a_blind_robot_may_not_move(void)
{
    TEST_ASSERT_TRUE(may_move_after(2000, 0));
    obstacle_blind(&obstacle);
    TEST_ASSERT_FALSE(obstacle_may_move(&obstacle, now_ms));
}

void test_each_sector_knows_its_nearest_point(void)
{
    (void)may_move_after(700, 90);
    TEST_ASSERT_EQUAL_UINT16(700, obstacle.sectors[2].nearest_mm);
    TEST_ASSERT_EQUAL_UINT16(2000, obstacle.sectors[0].nearest_mm);
}
