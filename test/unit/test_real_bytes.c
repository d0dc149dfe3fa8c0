/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Bytes that real units have sent, and their meaning. Only values were taken, from public projects:
 *
 *   T-mini Pro   tier4/ydlidar_driver, the packets of its tests (model 150, firmware 1.0: 9.9 Hz,
 *                CT information in point packets, every sample flagged)
 *   T-mini Plus  Ar-Ray-code/tmini_plus_emulator, its example data (section 9.14)
 *
 * No capture of a unit that sends LastCRC was available. */

#include "tmini/tmini_names.h"
#include "turns.h"

#include "unity.h"

#define DEGREE 64u

void setUp(void)
{
    static const uint8_t frequency[] = {0xA5, 0x5A, 4, 0, 0, 0, 4, 0x58, 2, 0, 0}; /* 6.00 Hz */

    turns_open(1024, false);
    turns.config.points = NULL;
    turns.config.max_points = 0;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&turns.lidar, &turns.config));
    (void)tmini_start(&turns.lidar);
    (void)turns_poll();
    turns.now_ms += 100;
    (void)turns_poll();
    turns_feed(frequency, sizeof frequency);
    (void)turns_poll();
}

void tearDown(void) {}

static void feed_start_reply(void)
{
    static const uint8_t reply[] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};

    turns_feed(reply, sizeof reply);
}

/* Polls for the next packet. */
static const tmini_packet_t *polled_packet(void)
{
    tmini_event_t event = tmini_poll(&turns.lidar);

    if (event == TMINI_EVENT_STARTED) {
        event = tmini_poll(&turns.lidar);
    }
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_PACKET, event);
    return tmini_packet(&turns.lidar);
}

static void expect_point(const tmini_packet_t *packet, size_t index, uint16_t angle_q6,
                         uint16_t distance_mm, uint8_t intensity, uint8_t flag)
{
    tmini_point_t point;

    TEST_ASSERT_TRUE(tmini_packet_point(packet, index, &point));
    TEST_ASSERT_EQUAL_UINT16(angle_q6, point.angle_q6);
    TEST_ASSERT_EQUAL_UINT16(distance_mm, point.distance_mm);
    TEST_ASSERT_EQUAL_UINT8(intensity, point.intensity);
    TEST_ASSERT_EQUAL_UINT8(flag, point.flag);
}

void test_a_point_packet_of_a_t_mini_pro(void)
{
    static const uint8_t bytes[] = {
        0xAA, 0x55, 0xB0, 0x27, 0xE3, 0x28, 0xF3, 0x39, 0x0E, 0x61, 0x79, 0xB6, 0x05, 0x6F, 0x4E,
        0x06, 0x61, 0x06, 0x06, 0x7A, 0x9A, 0x02, 0x9E, 0x5E, 0x02, 0xA6, 0x0A, 0x02, 0xA7, 0xE6,
        0x01, 0xAE, 0xD6, 0x01, 0xBA, 0xD6, 0x01, 0xB8, 0xD2, 0x01, 0xB2, 0xD6, 0x01, 0xBD, 0xD2,
        0x01, 0xDF, 0xDA, 0x01, 0xE1, 0xDA, 0x01, 0xDF, 0xDA, 0x01, 0xDC, 0xDE, 0x01, 0xDE, 0xDE,
        0x01, 0xD8, 0xE2, 0x01, 0xD4, 0xDE, 0x01, 0xBA, 0xDE, 0x01, 0x84, 0xDF, 0x01, 0x2F, 0xAB,
        0x01, 0x17, 0xEE, 0x01, 0x0F, 0x22, 0x02, 0x0C, 0x7E, 0x02, 0x0A, 0x02, 0x00, 0x0C, 0x9E,
        0x02, 0x16, 0xA6, 0x02, 0x21, 0xA2, 0x02, 0x3A, 0x32, 0x03, 0x55, 0x4E, 0x0A, 0x87, 0x46,
        0x0A, 0x85, 0x5A, 0x0A, 0x8A, 0x6E, 0x0A, 0x84, 0x9A, 0x0A, 0x7E, 0xCE, 0x0A, 0x4E, 0x7E,
        0x04, 0x51, 0x6E, 0x03, 0x66, 0xA6, 0x02};

    feed_start_reply();
    turns_feed(bytes, sizeof bytes);
    const tmini_packet_t *const packet = polled_packet();

    TEST_ASSERT_EQUAL_UINT8(39, packet->count);
    TEST_ASSERT_FALSE(tmini_packet_is_start(packet));
    TEST_ASSERT_EQUAL_HEX8(0xB0, packet->ct);
    expect_point(packet, 0, 5233, 365, 0x79, 2);  /* 81.77 degrees */
    expect_point(packet, 25, 6670, 0, 0x0A, 2);   /* 5233 + 25 * 2184 / 38 = 6669.8: no range */
    expect_point(packet, 38, 7417, 169, 0x66, 2); /* 115.89 degrees */
}

/* The CT byte is that of an index from 2 to 13 in the revolution (section 7). */
void test_a_full_packet_of_a_t_mini_pro(void)
{
    static const uint8_t bytes[] = {
        0xAA, 0x55, 0x24, 0x28, 0xF5, 0x4C, 0x85, 0x5E, 0x9D, 0x70, 0xCE, 0xE2, 0x07, 0xBC, 0xFA,
        0x07, 0xCC, 0xB6, 0x07, 0xC8, 0xB6, 0x07, 0xC4, 0xBA, 0x07, 0xCB, 0xCA, 0x07, 0xC8, 0xAE,
        0x09, 0xC5, 0x9E, 0x09, 0xC7, 0x9E, 0x09, 0xC2, 0x9E, 0x09, 0xC1, 0x92, 0x09, 0xC0, 0x8A,
        0x09, 0xC1, 0x86, 0x09, 0xBE, 0x86, 0x09, 0xC5, 0x86, 0x09, 0xC3, 0x8A, 0x09, 0xBC, 0x8A,
        0x09, 0xC6, 0x8A, 0x09, 0xC6, 0x8A, 0x09, 0xC2, 0x8E, 0x09, 0xC5, 0x8E, 0x09, 0xC3, 0x92,
        0x09, 0xC4, 0xAA, 0x09, 0xC9, 0xB2, 0x09, 0xC9, 0xBA, 0x09, 0xC5, 0xC2, 0x09, 0xC9, 0xCE,
        0x09, 0xBF, 0xCE, 0x09, 0xBE, 0xCE, 0x09, 0xBA, 0xCE, 0x09, 0xBE, 0xD6, 0x09, 0xBB, 0xD6,
        0x09, 0xBF, 0xE2, 0x09, 0xBB, 0xF2, 0x09, 0xC1, 0x0A, 0x0A, 0xBF, 0x1A, 0x0A, 0xB9, 0x1E,
        0x0A, 0xAA, 0x22, 0x0A, 0x9E, 0x2A, 0x0A, 0xCB, 0x7A, 0x15};

    feed_start_reply();
    turns_feed(bytes, sizeof bytes);
    const tmini_packet_t *const packet = polled_packet();

    TEST_ASSERT_EQUAL_UINT8(40, packet->count);
    expect_point(packet, 0, 9850, 504, 0xCE, 2);    /* 153.91 degrees */
    expect_point(packet, 39, 12098, 1374, 0xCB, 2); /* 189.03 degrees */
}

/* 9.9 Hz, at 42 degrees; the flag means interference, as in every sample of that unit (section
 * 9.9). */
void test_a_start_packet_of_a_t_mini_pro(void)
{
    static const uint8_t bytes[] = {0xAA, 0x55, 0xC7, 0x01, 0x01, 0x15, 0x01,
                                    0x15, 0x1B, 0x56, 0x14, 0x62, 0x02};

    feed_start_reply();
    turns_feed(bytes, sizeof bytes);
    const tmini_packet_t *const packet = polled_packet();

    TEST_ASSERT_TRUE(tmini_packet_is_start(packet));
    TEST_ASSERT_EQUAL_UINT8(99, packet->ct >> 1);
    expect_point(packet, 0, 42 * DEGREE, 152, 20, 2);
}

/* ---- Replies ---- */

static void go_idle(void)
{
    (void)tmini_stop(&turns.lidar);
    (void)turns_poll();
    turns.now_ms += 100;
    (void)turns_poll();
}

/* The second is not a logged reply, but composed from the output of the vendor's program (issue 65
 * of YDLIDAR/YDLidar-SDK). */
static const struct {
    uint8_t content[20];
    tmini_info_t info; /* Without the serial number. */
    const char *serial;
} units[] = {
    {{0x97, 2, 1, 1, 2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4},
     {.model = 151, .firmware_major = 1, .firmware_minor = 2, .hardware = 1},
     "2025042400090194"},
    {{0x97, 3, 1, 1, 2, 0, 2, 4, 0, 4, 1, 3, 0, 0, 0, 9, 0, 0, 9, 0},
     {.model = 151, .firmware_major = 1, .firmware_minor = 3, .hardware = 1},
     "2024041300090090"},
    {{0x96, 0, 1, 2, 2, 0, 2, 2, 1, 1, 0, 3, 0, 1, 1, 1, 1, 1, 1, 1},
     {.model = 150, .firmware_major = 1, .firmware_minor = 0, .hardware = 2},
     "2022110301111111"},
};

void test_device_information_of_two_t_mini_plus_and_a_t_mini_pro(void)
{
    for (unsigned i = 0; i < sizeof units / sizeof units[0]; i++) {
        static const uint8_t header[] = {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04};
        char serial[TMINI_SERIAL_DIGITS + 1];

        go_idle();
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&turns.lidar));
        turns_feed(header, sizeof header);
        turns_feed(units[i].content, sizeof units[i].content);
        TEST_ASSERT_EQUAL_INT(TMINI_EVENT_INFO, tmini_poll(&turns.lidar));
        const tmini_info_t *const info = tmini_info(&turns.lidar);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.model, info->model);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.firmware_major, info->firmware_major);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.firmware_minor, info->firmware_minor);
        TEST_ASSERT_EQUAL_UINT8(units[i].info.hardware, info->hardware);
        tmini_serial_text(info, serial);
        TEST_ASSERT_EQUAL_STRING(units[i].serial, serial);
    }
}
