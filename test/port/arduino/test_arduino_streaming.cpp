/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged sketch Streaming with the simulated lidar. */

#include <Arduino.h>

#include "Streaming/Streaming.ino"

#include "cpp_tests.h"

#include "virtual_lidar.h"

void setUp(void) {}

void tearDown(void) {}

/* The nearest distances that the sketch has printed, one per line. */
static std::vector<unsigned> printed_numbers()
{
    std::vector<unsigned> numbers;
    std::string line;
    for (uint8_t byte : Serial.sent) {
        line += static_cast<char>(byte);
        if (byte == '\n') {
            numbers.push_back(
                static_cast<unsigned>(std::stoul(line.substr(line.rfind("nearest ") + 8))));
            line.clear();
        }
    }
    return numbers;
}

static unsigned nearest_of(const std::vector<reference_point_t> &points)
{
    unsigned result = 0;
    for (const reference_point_t &point : points) {
        if (point.distance_mm != 0 && (result == 0 || point.distance_mm < result)) {
            result = point.distance_mm;
        }
    }
    return result;
}

TEST(the_sketch_prints_the_nearest_distance_of_each_revolution)
{
    VirtualLidar unit;
    setup();
    for (unsigned i = 0; i < 2500; i++) {
        unit.pass();
        loop();
    }
    const std::vector<unsigned> numbers = printed_numbers();
    TEST_ASSERT_TRUE(numbers.size() >= 8);
    TEST_ASSERT_EQUAL_UINT(scans, complete);
    /* Revolution 0 has the points before the first start packet. */
    for (size_t i = 0; i < numbers.size(); i++) {
        TEST_ASSERT_EQUAL_UINT(nearest_of(unit.revolutions[static_cast<uint32_t>(i + 1)]),
                               numbers[i]);
    }
}
