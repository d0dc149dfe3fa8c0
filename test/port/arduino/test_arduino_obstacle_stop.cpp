/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The sketch ObstacleStop, as it is, against the simulated lidar: upside down, a mast at the back.
 * A sketch begins once: the tests are one story, in the order of main(). */

#include <Arduino.h>

#include "ObstacleStop/ObstacleStop.ino"

#include "unity.h"

#include "virtual_lidar.h"

static VirtualLidar *unit;

static void run_for(unsigned ms)
{
    for (unsigned i = 0; i < ms; i++) {
        unit->pass();
        loop();
    }
}

void setUp(void) {}

void tearDown(void) {}

static void it_stops_until_the_way_is_seen_and_free(void)
{
    setup();
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
    run_for(4000);
    TEST_ASSERT_EQUAL_INT(LOW, arduino_pins[STOP_PIN]);
    TEST_ASSERT_UINT_WITHIN(20, 1000, lidar.scan().frequency_chz);
}

static void something_near_in_front_is_a_stop(void)
{
    unit->placeObstacle(250);
    run_for(300);
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
    unit->clearObstacles();
    run_for(300);
    TEST_ASSERT_EQUAL_INT(LOW, arduino_pins[STOP_PIN]);
}

/* The lidar's 90 degrees are the left of a robot from which it hangs. */
static void what_is_beside_it_is_on_the_side_where_it_is(void)
{
    unit->placeObstacle(250, 90 * 64);
    run_for(300);
    TEST_ASSERT_UINT_WITHIN(10, 250, sector[6].nearest_mm);
    TEST_ASSERT_EQUAL_INT(LOW, arduino_pins[STOP_PIN]);
    unit->clearObstacles();
}

static void the_mast_is_nothing(void)
{
    unit->placeObstacle(150, 180 * 64);
    run_for(300);
    TEST_ASSERT_TRUE(sector[4].nearest_mm > 200);
    unit->clearObstacles();
}

static void a_lidar_that_has_gone_is_a_stop(void)
{
    unit->unplug();
    run_for(500);
    TEST_ASSERT_EQUAL_INT(HIGH, arduino_pins[STOP_PIN]);
}

int main(void)
{
    VirtualLidar lidar_on_the_robot;
    unit = &lidar_on_the_robot;
    UnityBegin("test_arduino_obstacle_stop.cpp");
    RUN_TEST(it_stops_until_the_way_is_seen_and_free);
    RUN_TEST(something_near_in_front_is_a_stop);
    RUN_TEST(what_is_beside_it_is_on_the_side_where_it_is);
    RUN_TEST(the_mast_is_nothing);
    RUN_TEST(a_lidar_that_has_gone_is_a_stop);
    return UnityEnd();
}
