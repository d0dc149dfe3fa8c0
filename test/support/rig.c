/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rig.h"

#include <string.h>

rig_t rig;

/* ---- The port ---- */

static int record(void *context, const uint8_t *bytes, size_t count)
{
    const int taken = rig.takes < (int)count ? rig.takes : (int)count;
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    for (int i = 0; i < taken; i++) {
        TEST_ASSERT_TRUE(rig.sent_count < RIG_SENT_MAX);
        rig.sent[rig.sent_count++] = bytes[i];
    }
    return taken;
}

static uint32_t read_clock(void *context)
{
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    return rig.now_ms;
}

static void count_restart(void *context)
{
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    rig.port_restarts++;
}

void rig_open(void)
{
    memset(&rig, 0, sizeof rig);
    rig.port = (tmini_port_t){.write = record, .now_ms = read_clock, .restart = count_restart};
    rig.takes = 2;
    rig.now_ms = 1000;
    rig.config.port = &rig.port;
    rig.config.port_context = &rig.port;
    rig.config.rx_buffer = rig.rx;
    rig.config.rx_size = sizeof rig.rx;
    rig.config.points = rig.points;
    rig.config.max_points = RIG_POINTS;
    rig.timing = tmini_timing_default;
    rig.timing.max_pause_ms = 0; /* The rig's turns are short, and its clock jumps. */
    rig.config.timing = &rig.timing;
    rig_init();
}

void rig_init(void)
{
    rig.in_turn = false;
    rig.position = 0;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&rig.lidar, &rig.config));
}

/* ---- Bytes from the lidar ---- */

void rig_feed(const uint8_t *bytes, size_t count)
{
    if (!rig.config.rx_dma && count == 1) {
        tmini_feed_byte(&rig.lidar, bytes[0]);
    } else if (!rig.config.rx_dma) {
        tmini_feed(&rig.lidar, bytes, count);
    } else {
        for (size_t i = 0; i < count; i++) {
            rig.config.rx_buffer[rig.position++ % rig.config.rx_size] = bytes[i];
        }
        tmini_feed_dma(&rig.lidar, rig.position % rig.config.rx_size);
    }
}

void rig_feed_byte(uint8_t byte)
{
    rig_feed(&byte, 1);
}

void rig_feed_scan_reply(void)
{
    uint8_t reply[ENCODE_REPLY_MAX];
    rig_feed(reply, encode_scan_reply(reply));
}

void rig_feed_info(void)
{
    static const encode_information_t information = {
        151, 1, 2, 1, {2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4}};
    uint8_t reply[ENCODE_REPLY_MAX];
    rig_feed(reply, encode_information_reply(reply, &information));
}

void rig_feed_health(uint8_t status, uint16_t error_code)
{
    uint8_t reply[ENCODE_REPLY_MAX];
    rig_feed(reply, encode_health_reply(reply, status, error_code));
}

void rig_feed_frequency(uint32_t frequency_chz)
{
    uint8_t reply[ENCODE_REPLY_MAX];
    rig_feed(reply, encode_frequency_reply(reply, frequency_chz));
}

void rig_feed_packet(uint8_t ct, uint8_t lsn, uint16_t distance_mm)
{
    encode_sample_t samples[40];
    uint8_t bytes[ENCODE_PACKET_HEADER + 40 * ENCODE_SAMPLE_SIZE];
    const encode_packet_t packet = {ct, lsn, 640, (uint16_t)(640 + 32 * (lsn - 1)), samples};
    for (unsigned i = 0; i < lsn; i++) {
        samples[i].distance_mm = distance_mm;
        samples[i].intensity = 50;
        samples[i].flag = 0;
    }
    rig_feed(bytes, encode_packet(bytes, &packet));
}

void rig_feed_start_packet(uint16_t distance_mm)
{
    rig_feed_packet(0x79, 1, distance_mm);
}

void rig_feed_point_packet(uint16_t distance_mm)
{
    rig_feed_packet(0, 4, distance_mm);
}

void rig_feed_plain_turn(uint16_t distance_mm)
{
    rig_feed_start_packet(distance_mm);
    for (unsigned index = 1; index < 5; index++) {
        rig_feed_point_packet(distance_mm);
    }
}

void rig_feed_turn(uint8_t health, uint16_t distance_mm)
{
    const encode_turn_t turn = {.frequency_dhz = 60, .user_major = 1, .health = health};
    if (rig.in_turn) {
        rig_feed_byte(rig.crc);
    }
    rig.in_turn = true;
    rig.crc = 0;
    for (unsigned index = 0; index < 5; index++) {
        const uint8_t ct = encode_ct(&turn, index);
        rig_feed_packet(ct, index == 0 ? 1 : 4, distance_mm);
        rig.crc = encode_crc8(rig.crc, ct);
    }
}
