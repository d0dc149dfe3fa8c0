/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged sketch ObstacleStop with the simulated lidar, mounted upside down, with a mast
 * at the back. A sketch starts only once: each test continues where the one before it ended. */

#include <Arduino.h>

#include "ObstacleStop/ObstacleStop.ino"

#include "cpp_tests.h"

#include "virtual_lidar.h"

static VirtualLidar unit;

static void run_for(unsigned ms)
{
    for (unsigned i = 0; i < ms; i++) {
        unit.pass();
        loop();
    }
}

void setUp(void) {}

void tearDown(void) {}

TEST(it_stops_until_it_has_seen_that_the_way_is_free)
{
    setup();
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
    run_for(4000);
    TEST_ASSERT_EQUAL_INT(LOW, arduino_pins[STOP_PIN]);
    TEST_ASSERT_UINT_WITHIN(20, 1000, lidar.scan().frequency_chz);
}

/* Three whole scans make the field free again, at 10 Hz. */
TEST(something_near_in_front_stops_the_robot)
{
    unit.placeObstacle(250);
    run_for(300);
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
    unit.clearObstacles();
    run_for(500);
    TEST_ASSERT_EQUAL_INT(LOW, arduino_pins[STOP_PIN]);
}

/* The lidar hangs upside down: its 50 degrees are at the robot's left. */
TEST(an_obstacle_at_the_side_does_not)
{
    unit.placeObstacle(250, 50 * 64);
    run_for(300);
    TEST_ASSERT_EQUAL_INT(LOW, arduino_pins[STOP_PIN]);
    unit.placeObstacle(170, 30 * 64);
    run_for(300);
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
    unit.clearObstacles();
    run_for(500);
}

TEST(the_mast_is_ignored)
{
    unit.placeObstacle(150, 180 * 64);
    run_for(200);
    unsigned points = 0;
    for (unsigned i = 0; i < 100; i++) {
        unit.pass();
        while (lidar.loop()) {
            for (TMiniPoint point : lidar.points()) {
                points++;
                TEST_ASSERT_TRUE(!point.isValid() || point.distanceMm() > 200);
            }
        }
    }
    TEST_ASSERT_TRUE(points > 300);
    unit.clearObstacles();
}

TEST(an_unplugged_lidar_stops_the_robot)
{
    unit.unplug();
    run_for(500);
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
}
