/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The sketch Scan, as it is, against the simulated lidar. */

#include <Arduino.h>

#include "Scan/Scan.ino"

#include "unity.h"

#include "virtual_lidar.h"

static std::string printed()
{
    return std::string(Serial.sent.begin(), Serial.sent.end());
}

/* What is in front, from the lidar's own truth: valid, within 30 degrees of 0. */
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

static void the_sketch_tells_the_model_and_every_second_what_is_in_front(void)
{
    VirtualLidar unit;
    setup();
    for (unsigned i = 0; i < 3500; i++) {
        unit.pass();
        loop();
    }
    const std::string line = std::to_string(scans) + " scans, nearest in front " +
                             std::to_string(nearest_in_front(unit.revolutions[scans])) + " mm";
    TEST_ASSERT_TRUE(printed().find("lidar model 151\r\n") != std::string::npos);
    TEST_ASSERT_TRUE(scans >= 12);
    for (unsigned i = 0; i < 1000; i++) {
        loop(); /* Time stands still: the next report is about the same scans. */
    }
    TEST_ASSERT_EQUAL_UINT(nearest_in_front(unit.revolutions[scans]), nearest);
    arduino_millis += 1000;
    report();
    TEST_ASSERT_TRUE(printed().find(line) != std::string::npos);
}

int main(void)
{
    UnityBegin("test_arduino_scan.cpp");
    RUN_TEST(the_sketch_tells_the_model_and_every_second_what_is_in_front);
    return UnityEnd();
}
