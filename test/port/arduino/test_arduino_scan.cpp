/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged sketch Scan with the simulated lidar. A sketch starts only once: each test
 * continues where the one before it ended. */

#include <Arduino.h>

#include "Scan/Scan.ino"

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

static std::string printed()
{
    return std::string(Serial.sent.begin(), Serial.sent.end());
}

static bool has_printed(const std::string &text)
{
    return printed().find(text) != std::string::npos;
}

static std::string next_line()
{
    Serial.sent.clear();
    for (unsigned i = 0; i < 1500 && Serial.sent.empty(); i++) {
        run_for(1);
    }
    return printed();
}

/* The nearest valid point that the lidar sent within 30 degrees of 0. */
static unsigned nearest_in_front(const std::vector<reference_point_t> &points)
{
    unsigned result = 0;
    for (const reference_point_t &point : points) {
        const bool in_front = point.angle_q6 <= 1920 || point.angle_q6 >= 21120;
        if (in_front && point.distance_mm != 0 && (result == 0 || point.distance_mm < result)) {
            result = point.distance_mm;
        }
    }
    return result;
}

void setUp(void) {}

void tearDown(void) {}

TEST(the_sketch_prints_the_model_and_every_second_the_nearest_distance)
{
    setup();
    run_for(3500);
    TEST_ASSERT_TRUE(has_printed("lidar model 151\r\n"));
    TEST_ASSERT_TRUE(scans >= 12 && complete >= scans - 1); /* The first turn was too slow. */
    const std::string line = next_line();
    const unsigned truth = nearest_in_front(unit.revolutions[scans]);
    const std::string expected = std::to_string(scans) + " scans, " + std::to_string(complete) +
                                 " complete, nearest in front " + std::to_string(truth) + " mm\r\n";
    TEST_ASSERT_EQUAL_STRING(expected.c_str(), line.c_str());
}

TEST(something_near_in_front_stops_the_robot)
{
    unit.placeObstacle(350);
    run_for(1500);
    TEST_ASSERT_TRUE(has_printed(" mm: STOP\r\n"));
    unit.clearObstacles();
    run_for(1500);
    TEST_ASSERT_FALSE(next_line().find("STOP") != std::string::npos);
}

TEST(a_faulty_lidar_stops_the_robot_whatever_it_measures)
{
    unit.setHealth(SIM_HEALTH_PD);
    run_for(1500);
    TEST_ASSERT_TRUE(has_printed("lidar faults 8\r\n"));
    TEST_ASSERT_TRUE(has_printed(" complete, blind: STOP\r\n"));
    unit.setHealth(0);
    run_for(1500);
    TEST_ASSERT_FALSE(next_line().find("STOP") != std::string::npos);
}

TEST(an_unplugged_lidar_stops_the_robot)
{
    unit.unplug();
    run_for(600);
    TEST_ASSERT_TRUE(next_line().find(" complete, blind: STOP\r\n") != std::string::npos);
}
