/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the class that sketches use, with the simulated lidar. */

#include <TMiniLidar.h>

#include <math.h>

#include "cpp_tests.h"

#include "virtual_lidar.h"

static VirtualLidar *unit;

void setUp(void)
{
    arduino_millis = 0xFFFFFF00u; /* The clock wraps around in every test. */
    Serial1 = SerialPort();
    unit = new VirtualLidar;
}

void tearDown(void)
{
    delete unit;
    TEST_ASSERT_FALSE_MESSAGE(Serial1.waited, "more was read than is available");
}

/* Runs until `wanted` happens; false if it does not within `limit_ms`. */
static bool happens(TMiniLidarBase &lidar, tmini_event_t wanted, unsigned limit_ms)
{
    for (unsigned i = 0; i < limit_ms; i++) {
        unit->pass();
        while (tmini_event_t event = lidar.loop()) {
            if (event == wanted) {
                return true;
            }
        }
    }
    return false;
}

static void scan(TMiniLidarBase &lidar)
{
    lidar.begin(Serial1);
    lidar.start();
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000));
}

static void assert_same_points(const std::vector<reference_point_t> &expected,
                               TMiniLidarBase &lidar)
{
    size_t index = 0;
    TEST_ASSERT_EQUAL_UINT(expected.size(), lidar.points().size());
    for (TMiniPoint point : lidar.points()) {
        TEST_ASSERT_EQUAL_UINT(expected[index].angle_q6, point.angle_q6);
        TEST_ASSERT_EQUAL_UINT(expected[index].distance_mm, point.distanceMm());
        TEST_ASSERT_EQUAL_UINT(expected[index].intensity, point.intensity);
        TEST_ASSERT_EQUAL_UINT(expected[index].flag, point.flag);
        index++;
    }
    TEST_ASSERT_EQUAL_UINT(expected.size(), index);
}

#if defined(ESP32) || defined(ARDUINO_ARCH_RP2040)
static const int8_t NONE = -1;

/* A closed port is opened with a large buffer; an open one is closed first, except on an ESP32
 * without pins: closing it would release those that the sketch has chosen. */
static const struct {
    const char *port;
    bool isOpen;
    int8_t pin; /* Of begin(). */
    size_t size;
    int expectedPin;
} begun[] = {
    {"closed, on default pins", false, NONE, 1024, NONE},
    {"closed, on pins", false, 16, 1024, 16},
    {"open, on pins", true, 16, 1024, 16},
#if defined(ESP32)
    {"open, on its pins", true, NONE, 256, 26},
#else
    {"open, on its pins", true, NONE, 1024, NONE},
#endif
};

TEST(begin_opens_the_port_with_a_large_buffer_where_that_is_possible)
{
    for (const auto &row : begun) {
        TMiniLidar lidar;
        Serial1 = SerialPort();
        if (row.isOpen) {
#if defined(ESP32)
            Serial1.begin(9600, SERIAL_8N1, 26, 27);
#else
            Serial1.begin(9600);
#endif
        }
        TEST_ASSERT_TRUE_MESSAGE(row.pin == NONE ? lidar.begin(Serial1)
                                                 : lidar.begin(Serial1, row.pin, row.pin + 1),
                                 row.port);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(row.size, Serial1.size_at_begin, row.port);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(230400, Serial1.baud_rate, row.port);
        TEST_ASSERT_EQUAL_INT_MESSAGE(row.expectedPin, Serial1.rx_pin, row.port);
        TEST_ASSERT_EQUAL_INT_MESSAGE(row.expectedPin + (row.expectedPin == NONE ? 0 : 1),
                                      Serial1.tx_pin, row.port);
#if defined(ESP32)
        TEST_ASSERT_TRUE_MESSAGE(row.expectedPin == NONE || Serial1.line == SERIAL_8N1, row.port);
        TEST_ASSERT_EQUAL_INT_MESSAGE(64, Serial1.fifo_full, row.port);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, Serial1.vain_ends, row.port);
#endif
    }
}
#endif

#if defined(ESP32)
TEST(a_port_that_cannot_be_opened_is_reported)
{
    TMiniLidar lidar;
    Serial1.refuses = true;
    TEST_ASSERT_FALSE(lidar.begin(Serial1));
    TEST_ASSERT_FALSE(lidar.begin(Serial1, 16, 17));
    TEST_ASSERT_FALSE(lidar.start());
    Serial1.refuses = false;
    TEST_ASSERT_TRUE(lidar.begin(Serial1, 16, 17));
}
#endif

#if defined(CORE_TEENSY)
TEST(begin_gives_the_port_more_memory_as_long_as_the_lidar_lives)
{
    {
        TMiniLidar lidar;
        TEST_ASSERT_TRUE(lidar.begin(Serial1));
        TEST_ASSERT_EQUAL_UINT(1023, Serial1.size_at_begin);
        TEST_ASSERT_NOT_NULL(Serial1.more);
    }
    TEST_ASSERT_NULL(Serial1.more);
    TEST_ASSERT_FALSE(Serial1.more_while_open);
    {
        TMiniLidar lidar;
    }
}

TEST(a_port_that_another_lidar_has_taken_over_keeps_its_memory)
{
    TMiniLidarStreaming second;
    {
        TMiniLidarStreaming first;
        TEST_ASSERT_TRUE(first.begin(Serial1));
        TEST_ASSERT_TRUE(first.begin(Serial2));
        TEST_ASSERT_NULL(Serial1.more);
        TEST_ASSERT_TRUE(second.begin(Serial1));
    }
    TEST_ASSERT_NULL(Serial2.more);
    TEST_ASSERT_NOT_NULL(Serial1.more);
}
#endif

/* Runs for `ms`, with a sketch that calls loop() every `pause` ms. */
static void run_with_pauses(TMiniLidarBase &lidar, unsigned ms, unsigned pause)
{
    for (unsigned i = 1; i <= ms; i++) {
        unit->pass();
        while (i % pause == 0 && lidar.loop() != TMINI_EVENT_NONE) {
        }
    }
}

#if !defined(SERIAL_RX_BUFFER_SIZE)
/* In 50 ms 660 bytes arrive: too many for the lidar's own buffer, but not for the core's. */
TEST(bytes_that_do_not_fit_in_the_lidars_buffer_stay_in_the_cores)
{
    static TMiniLidarWith<256, 0> lidar;
    tmini_counters_t counters;
    lidar.begin(Serial1);
    lidar.start();
    run_with_pauses(lidar, 4000, 50);
    tmini_counters(lidar.driver(), &counters);
    TEST_ASSERT_EQUAL_UINT(0, Serial1.lost);
    TEST_ASSERT_EQUAL_UINT(0, counters.bytes_overrun);
    TEST_ASSERT_TRUE(counters.packets > 200);
}
#else
/* 260 bytes arrive in 20 ms, but the core's buffer has room for 63. */
TEST(an_overflow_of_the_cores_buffer_is_counted_and_no_scan_is_complete)
{
    static TMiniLidar lidar;
    lidar.begin(Serial1);
    lidar.start();
    run_with_pauses(lidar, 2000, 1);
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000) && lidar.scan().complete);
    TEST_ASSERT_EQUAL_UINT(0, lidar.overruns());
    run_with_pauses(lidar, 20, 20);
    TEST_ASSERT_EQUAL_UINT(1, lidar.overruns());
    for (unsigned i = 0; i < 2; i++) { /* The parts before and after the gap. */
        TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000) && !lidar.scan().complete);
    }
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000) && lidar.scan().complete);
}

/* Every 20 points take a millisecond. If the iteration did not receive, the core's buffer of 63
 * bytes would overflow. */
TEST(iterating_over_the_points_also_receives)
{
    static TMiniLidar lidar;
    size_t points = 0;
    scan(lidar);
    for (TMiniPoint point : lidar.points()) {
        points += point.isValid() ? 1 : 0;
        if (points % 20 == 0) {
            unit->pass();
        }
    }
    TEST_ASSERT_EQUAL_UINT(0, Serial1.lost);
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000) && lidar.scan().complete);
}
#endif

TEST(any_other_stream_is_left_as_the_sketch_has_opened_it)
{
    TMiniLidar lidar;
    Stream &stream = Serial1;
    TEST_ASSERT_TRUE(lidar.begin(stream));
    TEST_ASSERT_EQUAL_UINT(0, Serial1.baud_rate);
}

/* Behaves as an adapter that has been unplugged. */
class StuckStream : public HardwareSerial
{
  public:
    int available() override
    {
        return 5;
    }
};

TEST(a_stream_that_promises_bytes_but_gives_none_does_not_block)
{
    TMiniLidar lidar;
    StuckStream stuck;
    Stream &stream = stuck;
    TEST_ASSERT_TRUE(lidar.begin(stream));
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, lidar.loop());
}

TEST(before_begin_nothing_happens_and_buffers_of_a_wrong_size_are_refused)
{
    TMiniLidarWith<300, 10> lidar;
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, lidar.loop());
    TEST_ASSERT_EQUAL_UINT(0, lidar.available());
    TEST_ASSERT_FALSE(lidar.start());
    TEST_ASSERT_FALSE(lidar.begin(Serial1));
}

TEST(every_point_of_every_scan_is_there)
{
    static TMiniLidarWith<1024, 2000> lidar; /* Revolutions during spin-up have more points. */
    lidar.begin(Serial1);
    TEST_ASSERT_TRUE(lidar.start());
    for (uint32_t revolution = 1; revolution <= 5; revolution++) {
        TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000));
        assert_same_points(unit->revolution(revolution), lidar);
        TEST_ASSERT_EQUAL_UINT(unit->revolution(revolution).size(), lidar.available());
    }
    TEST_ASSERT_TRUE(lidar.isScanning());
}

TEST(every_point_of_every_packet_is_there_when_streaming)
{
    static TMiniLidarStreaming lidar;
    lidar.begin(Serial1);
    TEST_ASSERT_TRUE(lidar.start());
    size_t place = 0;
    for (size_t packet = 0; packet < 50; packet++) {
        TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_PACKET, 2000));
        TEST_ASSERT_GREATER_THAN_UINT(0, lidar.available());
        assert_same_points(unit->points(place, lidar.available()), lidar);
        place += lidar.available();
    }
}

TEST(with_a_spare_buffer_a_scan_stays_until_the_next)
{
    static TMiniLidarWith<1024, 2000, true> lidar;
    scan(lidar);
    TEST_ASSERT_FALSE(happens(lidar, TMINI_EVENT_SCAN, 100));
    TEST_ASSERT_EQUAL_UINT(0, lidar.available());
    assert_same_points(unit->revolution(1), lidar);
}

/* Upside down, the angles run the other way; the robot's angles 80 to 100 degrees are masked. */
static void assert_mounted(std::vector<reference_point_t> points, TMiniLidarBase &lidar)
{
    for (reference_point_t &point : points) {
        point.angle_q6 = (23040u - point.angle_q6) % 23040u;
        point.distance_mm *= point.angle_q6 >= 5120 && point.angle_q6 <= 6400 ? 0 : 1;
    }
    assert_same_points(points, lidar);
}

TEST(points_have_the_angles_and_the_mask_of_the_robot)
{
    static const tmini_arc_t masts[] = {{80, 100}};
    tmini_mount_t mount = tmini_mount_t();
    static TMiniLidarWith<1024, 2000> lidar;
    static TMiniLidarStreaming streaming;
    mount.upside_down = true;
    mount.masked = masts;
    mount.masked_count = 1;
    lidar.setMount(mount);
    TEST_ASSERT_TRUE(lidar.begin(Serial1));
    lidar.start();
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000));
    TEST_ASSERT_TRUE(lidar.scan().upside_down);
    assert_mounted(unit->revolution(1), lidar);
    streaming.setMount(mount);
    TEST_ASSERT_TRUE(streaming.begin(Serial1));
    streaming.start(); /* The lidar still scans: start() first stops it. */
    TEST_ASSERT_TRUE(happens(streaming, TMINI_EVENT_PACKET, 2000));
    assert_mounted(unit->points(unit->judge.sent - streaming.available(), streaming.available()),
                   streaming);
}

static void leave(const void *data, tmini_scan_t *scan)
{
    (void)data, (void)scan;
}

/* The driver calls only one step. */
TEST(a_mount_and_the_users_own_step_exclude_each_other)
{
    static const tmini_mount_t mount = tmini_mount_t();
    static TMiniLidarWith<1024, 2000> lidar;
    lidar.config().step = leave;
    TEST_ASSERT_TRUE(lidar.begin(Serial1));
    lidar.setMount(mount);
    TEST_ASSERT_FALSE(lidar.begin(Serial1));
    lidar.config().step = NULL;
    TEST_ASSERT_TRUE(lidar.begin(Serial1));
    TEST_ASSERT_TRUE(lidar.begin(Serial1));
}

TEST(points_are_gone_with_the_next_loop_and_when_it_begins_again)
{
    for (bool begins : {false, true}) {
        static TMiniLidar lidar;
        scan(lidar);
        begins ? (void)lidar.begin(Serial1) : (void)lidar.loop();
        TEST_ASSERT_EQUAL_UINT(0, lidar.available());
        TEST_ASSERT_EQUAL_UINT(0, lidar.points().size());
    }
}

/* A single byte, and one more than the lidar's buffer holds. */
TEST(one_loop_takes_all_waiting_bytes)
{
    static TMiniLidarWith<256, 0> lidar;
    lidar.begin(Serial1);
    for (size_t count : {1, 257}) {
        Serial1.received.assign(count, 0x11);
        TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, lidar.loop());
        TEST_ASSERT_EQUAL_UINT(0, Serial1.received.size());
    }
}

TEST(information_and_health_are_read)
{
    TMiniLidar lidar;
    lidar.begin(Serial1);
    TEST_ASSERT_TRUE(lidar.requestInfo());
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_INFO, 1000));
    TEST_ASSERT_EQUAL_UINT(151, lidar.info().model);
    TEST_ASSERT_TRUE(lidar.requestHealth());
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_HEALTH, 1000));
    TEST_ASSERT_EQUAL_UINT(0, lidar.health().faults);
}

TEST(a_frequency_in_begin_is_set_before_the_start)
{
    static TMiniLidar lidar;
    TEST_ASSERT_TRUE(lidar.begin(Serial1, 10));
    lidar.start();
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 5000));
    TEST_ASSERT_EQUAL_UINT(1000, tmini_frequency_chz(lidar.driver()));
    TEST_ASSERT_FALSE(lidar.begin(Serial1, 13));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, lidar.status());
}

/* Another library may close the port. On an ESP32, the pins must then be set again. */
TEST(a_port_that_something_has_closed_is_opened_again)
{
    static TMiniLidar lidar;
#if defined(ESP32)
    lidar.begin(Serial1, 16, 17);
#else
    lidar.begin(Serial1);
#endif
    const int pin = Serial1.rx_pin;
    lidar.start();
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_SCAN, 2000));
    Serial1.is_open = false;
    Serial1.rx_pin = -1;
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_RECOVERED, 10000));
    TEST_ASSERT_EQUAL_INT(pin, Serial1.rx_pin);
}

/* Returns the reported frequency in 0.01 Hz; 0 if the request was refused. */
static unsigned frequency_set_to(float hertz)
{
    TMiniLidar lidar;
    lidar.begin(Serial1);
    if (!lidar.setFrequency(hertz) || !happens(lidar, TMINI_EVENT_FREQUENCY, 30000)) {
        return 0;
    }
    return tmini_frequency_chz(lidar.driver());
}

/* Rounding must not make 5.99 and 12.01 valid. */
TEST(a_frequency_between_the_slowest_and_the_fastest_is_set_and_others_are_refused)
{
    TEST_ASSERT_EQUAL_UINT(1200, frequency_set_to(12.0f));
    TEST_ASSERT_EQUAL_UINT(730, frequency_set_to(7.3f));
    TEST_ASSERT_EQUAL_UINT(600, frequency_set_to(6.0f));
    for (float hertz : {5.99f, 12.01f, 0.0f, -1.0f, -7.0f, 1000.0f, INFINITY, NAN}) {
        TEST_ASSERT_EQUAL_UINT(0, frequency_set_to(hertz));
    }
}

TEST(while_scanning_only_stop_is_possible)
{
    static TMiniLidar lidar;
    scan(lidar);
    TEST_ASSERT_FALSE(lidar.requestInfo());
    (void)lidar.loop();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, lidar.status());
    TEST_ASSERT_FALSE(lidar.reboot());
    TEST_ASSERT_TRUE(lidar.stop());
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_STOPPED, 1000));
    TEST_ASSERT_FALSE(lidar.isScanning());
}

TEST(without_a_lidar_a_command_fails_and_says_why)
{
    TMiniLidar lidar;
    unit->isPlugged = false;
    lidar.begin(Serial1);
    TEST_ASSERT_TRUE(lidar.requestInfo());
    TEST_ASSERT_TRUE(happens(lidar, TMINI_EVENT_COMMAND_FAILED, 10000));
    TEST_ASSERT_EQUAL_STRING("timeout", lidar.error());
}

TEST(a_degree_is_64_units_and_distance_zero_is_invalid)
{
    TMiniPoint point;
    point.angle_q6 = 5776; /* 90.25 * 64 */
    point.distance_mm = 0;
    TEST_ASSERT_EQUAL_FLOAT(90.25f, point.angleDegrees());
    TEST_ASSERT_FALSE(point.isValid());
    point.distance_mm = 1;
    TEST_ASSERT_TRUE(point.isValid());
}
