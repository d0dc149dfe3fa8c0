/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged sketches, with the simulated lidar. A sketch starts only once: each of its
 * tests continues where the one before it ended. */

#include <TMiniLidar.h>
#include <TMiniPins.h>
#include <tmini/tmini_fields.h>

#include "cpp_tests.h"

#include "virtual_lidar.h"

namespace Bridge
{
#include "Bridge/Bridge.ino"
}
namespace ObstacleStop
{
#include "ObstacleStop/ObstacleStop.ino"
}
namespace Scan
{
#include "Scan/Scan.ino"
}
namespace Streaming
{
#include "Streaming/Streaming.ino"
}

static VirtualLidar *unit;
static void (*sketch)();

static void begin(void (*setup)(), void (*loop)())
{
    Serial = HardwareSerial();
    Serial1 = SerialPort();
    delete unit;
    unit = new VirtualLidar;
    sketch = loop;
    setup();
}

static void run_for(unsigned ms)
{
    for (unsigned i = 0; i < ms; i++) {
        unit->pass();
        sketch();
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

/* The nearest valid point of a revolution that the lidar has sent, within an angle to either side
 * of 0. */
static unsigned nearest(unsigned revolution, unsigned half_q6)
{
    unsigned result = 0;
    for (const reference_point_t &point : unit->revolution(revolution)) {
        const bool is_in = point.angle_q6 <= half_q6 || point.angle_q6 >= 23040 - half_q6;
        if (is_in && point.distance_mm != 0 && (result == 0 || point.distance_mm < result)) {
            result = point.distance_mm;
        }
    }
    return result;
}

void setUp(void) {}

void tearDown(void) {}

/* ---- Scan ---- */

TEST(scan_prints_the_model_and_every_second_the_nearest_distance)
{
    begin(Scan::setup, Scan::loop);
    run_for(3500);
    TEST_ASSERT_TRUE(has_printed("lidar model 151\r\n"));
    /* The first turn was too slow. */
    TEST_ASSERT_TRUE(Scan::scans >= 12 && Scan::complete >= Scan::scans - 1);
    const std::string line = next_line();
    const std::string expected = std::to_string(Scan::scans) + " scans, " +
                                 std::to_string(Scan::complete) + " complete, nearest in front " +
                                 std::to_string(nearest(Scan::scans, 30 * 64)) + " mm\r\n";
    TEST_ASSERT_EQUAL_STRING(expected.c_str(), line.c_str());
}

/* Something is near, then the lidar is faulty, then it is unplugged. */
TEST(scan_stops_the_robot_only_while_it_must)
{
    unit->placeObstacle(350);
    run_for(1500);
    TEST_ASSERT_TRUE(has_printed(" mm: STOP\r\n"));
    sim_clear_obstacles(&unit->sim);
    run_for(1500);
    TEST_ASSERT_FALSE(next_line().find("STOP") != std::string::npos);
    sim_set_health(&unit->sim, SIM_HEALTH_PD);
    run_for(1500);
    TEST_ASSERT_TRUE(has_printed("lidar faults 8\r\n"));
    TEST_ASSERT_TRUE(has_printed(" complete, blind: STOP\r\n"));
    sim_set_health(&unit->sim, 0);
    run_for(1500);
    TEST_ASSERT_FALSE(next_line().find("STOP") != std::string::npos);
    unit->isPlugged = false;
    run_for(600);
    TEST_ASSERT_TRUE(next_line().find(" complete, blind: STOP\r\n") != std::string::npos);
}

/* ---- ObstacleStop ---- */

static uint8_t stop_pin()
{
    return arduino_pins[ObstacleStop::STOP_PIN];
}

TEST(obstacle_stop_stops_until_it_has_seen_that_the_way_is_free)
{
    begin(ObstacleStop::setup, ObstacleStop::loop);
    TEST_ASSERT_EQUAL_INT(HIGH, stop_pin());
    run_for(4000);
    TEST_ASSERT_EQUAL_INT(LOW, stop_pin());
    TEST_ASSERT_UINT_WITHIN(20, 1000, ObstacleStop::lidar.scan().frequency_chz);
}

/* Obstacles, and whether they stop the robot. The lidar hangs upside down: its 50 degrees are at
 * the robot's left. */
static const struct {
    uint16_t distance_mm;
    uint16_t degrees;
    uint8_t pin;
} obstacles[] = {{250, 0, HIGH}, {250, 50, LOW}, {170, 30, HIGH}};

/* Three whole scans make the field free again, at 10 Hz. */
TEST(obstacle_stop_something_in_the_box_stops_the_robot_and_nothing_beside_it)
{
    for (const auto &obstacle : obstacles) {
        unit->placeObstacle(obstacle.distance_mm, obstacle.degrees * 64);
        run_for(300);
        TEST_ASSERT_EQUAL_INT(obstacle.pin, stop_pin());
        sim_clear_obstacles(&unit->sim);
        run_for(500);
        TEST_ASSERT_EQUAL_INT(LOW, stop_pin());
    }
}

/* At the end it is unplugged: it stops. */
TEST(obstacle_stop_ignores_the_mast_but_not_a_lost_lidar)
{
    unit->placeObstacle(150, 180 * 64);
    run_for(200);
    unsigned points = 0;
    for (unsigned i = 0; i < 100; i++) {
        unit->pass();
        while (ObstacleStop::lidar.loop()) {
            for (TMiniPoint point : ObstacleStop::lidar.points()) {
                points++;
                TEST_ASSERT_TRUE(!point.isValid() || point.distanceMm() > 200);
            }
        }
    }
    TEST_ASSERT_TRUE(points > 300);
    unit->isPlugged = false;
    run_for(500);
    TEST_ASSERT_EQUAL_INT(HIGH, stop_pin());
}

/* ---- Streaming, Bridge ---- */

TEST(streaming_prints_the_nearest_distance_of_each_revolution)
{
    begin(Streaming::setup, Streaming::loop);
    run_for(2500);
    TEST_ASSERT_TRUE(Streaming::scans >= 8);
    std::string expected;
    /* Revolution 0 has the points before the first start packet. */
    for (unsigned i = 1; i <= Streaming::scans; i++) {
        const std::string number = std::to_string(i);
        expected += number + " scans, " + number + " complete, nearest " +
                    std::to_string(nearest(i, 11520)) + " mm\r\n";
    }
    TEST_ASSERT_EQUAL_STRING(expected.c_str(), printed().c_str());
}

TEST(bridge_forwards_every_byte_in_both_directions_at_the_lidars_baud_rate)
{
    begin(Bridge::setup, Bridge::loop);
    TEST_ASSERT_EQUAL_UINT(230400, Serial.baud_rate);
    TEST_ASSERT_EQUAL_UINT(230400, Serial1.baud_rate);
    for (unsigned i = 0; i < 256; i++) {
        Serial1.take(static_cast<uint8_t>(i));
        Serial.take(static_cast<uint8_t>(255 - i));
        sketch();
    }
    TEST_ASSERT_EQUAL_UINT(256, Serial.sent.size());
    TEST_ASSERT_EQUAL_UINT(256, Serial1.sent.size());
    for (unsigned i = 0; i < 256; i++) {
        TEST_ASSERT_EQUAL_HEX8(i, Serial.sent[i]);
        TEST_ASSERT_EQUAL_HEX8(255 - i, Serial1.sent[i]);
    }
}
