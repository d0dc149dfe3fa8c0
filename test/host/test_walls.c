/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What `tmini calibrate` finds in scans of a square room whose walls are 1, 2, 2 and 2 m away, or
 * as the test sets them, or refuses. */

#include "calibrate.h"

#include <math.h>
#include <string.h>

#include "unity.h"

#define RADIANS (3.14159265358979323846 / 180)

static sample_t sample;
static tmini_point_t points[720];
static double walls_mm[4]; /* At 0, 90, 180 and 270 degrees of the room. */
static double turned_deg;  /* The lidar's angle at the room's 0. */
static double rough_mm;    /* How far points are off the walls, to either side in turn. */
static double gap_deg;     /* The wall at the room's 0 has a gap as far to either side. */
static wall_t wall;

void setUp(void)
{
    for (unsigned i = 0; i < 4; i++) {
        walls_mm[i] = i == 0 ? 1000 : 2000;
    }
    turned_deg = 0;
    rough_mm = 0;
    gap_deg = 0;
    calibrate_begin(&sample);
}

static double distance_at(double degrees)
{
    double nearest = fabs(remainder(degrees, 360)) < gap_deg ? 1700 : 1e9;
    for (unsigned i = 0; i < 4; i++) {
        const double towards = cos((degrees - 90.0 * i) * RADIANS);
        const double away = walls_mm[i] / towards;
        const bool is_gap = i == 0 && fabs(remainder(degrees, 360)) < gap_deg;
        nearest = towards > 0 && away < nearest && !is_gap ? away : nearest;
    }
    return nearest;
}

static void look(unsigned scans)
{
    for (unsigned i = 0; i < scans; i++) {
        for (unsigned j = 0; j < 720; j++) {
            points[j].angle_q6 = (uint16_t)(j * 32);
            points[j].distance_mm = (uint16_t)lround(distance_at(j / 2.0 - turned_deg) +
                                                     (j % 2 == 0 ? rough_mm : -rough_mm));
        }
        const tmini_scan_t scan = {.points = points, .count = 720, .complete = true};
        calibrate_add(&sample, &scan);
    }
}

static void finds(double degrees, double away_mm, bool is_rough, double rough_deg)
{
    TEST_ASSERT_NULL(calibrate_wall(&sample, is_rough, rough_deg, &wall));
    TEST_ASSERT_TRUE(fabs(remainder(wall.degrees - degrees, 360)) < 0.05);
    TEST_ASSERT_TRUE(fabs(wall.away_mm - away_mm) < 1);
}

static void refuses(const char *reason)
{
    const char *const said = calibrate_wall(&sample, false, 0, &wall);
    TEST_ASSERT_NOT_NULL(said);
    TEST_ASSERT_EQUAL_STRING_LEN(reason, said, strlen(reason));
}

void test_the_nearest_wall_is_found_at_any_angle(void)
{
    for (turned_deg = 0; turned_deg < 360; turned_deg += 73.3) {
        calibrate_begin(&sample);
        look(4);
        finds(turned_deg, 1000, false, 0);
    }
}

void test_a_hint_chooses_another_wall(void)
{
    turned_deg = 10;
    look(4);
    finds(100, 2000, true, 128);
    finds(280, 2000, true, -75);
}

void test_two_walls_that_are_equally_near_are_refused(void)
{
    walls_mm[1] = 1150;
    look(4);
    refuses("two walls are about equally near");
    finds(0, 1000, true, 20);
}

void test_two_faces_with_another_thing_between_them_are_refused(void)
{
    gap_deg = 5;
    look(4);
    refuses("straight towards the nearest wall, at 0 degrees, is another thing");
    finds(90, 2000, true, 90);
}

void test_a_wall_that_is_not_straight_is_refused(void)
{
    rough_mm = 20;
    look(4);
    refuses("the wall is not straight");
}

void test_a_wall_too_near_or_too_far_is_refused(void)
{
    walls_mm[0] = 140;
    look(4);
    refuses("the wall is 140 mm away");
    calibrate_begin(&sample);
    refuses("there is no straight wall");
}

void test_a_robot_that_moves_is_refused(void)
{
    look(4);
    turned_deg = 1;
    look(4);
    refuses("the robot or the wall has moved");
}

void test_an_offset_is_what_is_missing_straight_ahead(void)
{
    double offset_mm = 0;
    turned_deg = 30;
    look(4);
    TEST_ASSERT_NULL(calibrate_offset(&sample, 30, 1069, &offset_mm));
    TEST_ASSERT_TRUE(fabs(offset_mm - 69) < 1);
    calibrate_shift(&sample, 69);
    TEST_ASSERT_NULL(calibrate_offset(&sample, 30, 1069, &offset_mm));
    TEST_ASSERT_TRUE(fabs(offset_mm) < 1);
    TEST_ASSERT_NOT_NULL(calibrate_offset(&sample, 75, 1400, &offset_mm)); /* A corner. */
}
