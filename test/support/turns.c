/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "turns.h"

#include "unity.h"

#include <string.h>

turns_t turns;
turns_scans_t turns_scans;

/* ---- The port ---- */

static int note_write(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    turns.written[turns.writes++ % sizeof turns.written] = bytes[count - 1];
    return (int)count;
}

static uint32_t read_clock(void *context)
{
    (void)context;
    return turns.now_ms;
}

static const tmini_port_t port = {.write = note_write, .now_ms = read_clock};

/* ---- The lidar ---- */

void turns_feed(const uint8_t *bytes, size_t count)
{
    if (!turns.config.rx_dma) {
        tmini_feed(&turns.lidar, bytes, count);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        turns.rx[turns.dma_position] = bytes[i];
        turns.dma_position = (turns.dma_position + 1) % turns.config.rx_size;
    }
    tmini_feed_dma(&turns.lidar, turns.dma_position);
}

static unsigned samples_of(unsigned index)
{
    switch (index) {
    case 0:
        return 1;
    case TURNS_PACKETS - 2:
        return 11;
    case TURNS_PACKETS - 1:
        return 6;
    default:
        return 40;
    }
}

static uint8_t ct_of(unsigned index)
{
    static const encode_turn_t turn = {
        .frequency_dhz = 61, .user_major = 1, .hardware = 1, .firmware_major = 1, .year = 2026};

    return index == 0 || turns.ct_information ? encode_ct(&turn, index) : 0;
}

size_t turns_packet(uint8_t *out, unsigned index, uint16_t distance_mm)
{
    const unsigned count = samples_of(index);
    const unsigned before = index == 0                   ? 0
                            : index == TURNS_PACKETS - 1 ? TURNS_POINTS - 6
                                                         : 1 + 40 * (index - 1);
    encode_sample_t samples[40];
    const encode_packet_t packet = {.ct = ct_of(index),
                                    .lsn = (uint8_t)count,
                                    .first_q6 = (uint16_t)(before * TURNS_STEP_Q6),
                                    .last_q6 = (uint16_t)((before + count - 1) * TURNS_STEP_Q6),
                                    .samples = samples};
    const size_t guard = index == 0 && turns.ct_information ? 1 : 0;
    out[0] = turns.crc;
    turns.crc = encode_crc8(index == 0 ? 0 : turns.crc, packet.ct);
    for (unsigned i = 0; i < count; i++) {
        samples[i] = (encode_sample_t){distance_mm, (uint8_t)(before + i), 0};
    }
    return guard + encode_packet(out + guard, &packet);
}

void turns_feed_packets(unsigned first, unsigned last, uint16_t distance_mm)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];
    for (unsigned index = first; index <= last; index++) {
        turns.now_ms += (samples_of(index) + 3) / 4;
        turns_feed(bytes, turns_packet(bytes, index, distance_mm));
    }
}

unsigned turns_pass(unsigned first, unsigned last, uint16_t distance_mm)
{
    unsigned events = 0;
    for (unsigned index = first; index <= last; index++) {
        turns_feed_packets(index, index, distance_mm);
        events |= turns_poll();
    }
    return events;
}

/* ---- The driver ---- */

void turns_open(size_t rx_size, bool dma)
{
    memset(&turns, 0, sizeof turns);
    memset(&turns_scans, 0, sizeof turns_scans);
    turns.now_ms = 1000;
    turns.config.port = &port;
    turns.config.rx_buffer = turns.rx;
    turns.config.rx_size = rx_size;
    turns.config.rx_dma = dma;
    turns.config.points = turns.points;
    turns.config.max_points = 800;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&turns.lidar, &turns.config));
}

void turns_open_scanning(size_t rx_size, bool dma)
{
    uint8_t reply[ENCODE_REPLY_MAX];
    turns_open(rx_size, dma);
    (void)tmini_start(&turns.lidar);
    (void)turns_poll();
    turns.now_ms += 100;
    (void)turns_poll(); /* The line is quiet: the lidar is asked for its frequency. */
    turns.now_ms += 3;
    turns_feed(reply, encode_frequency_reply(reply, 600));
    (void)turns_poll(); /* It is started. */
    turns.now_ms += 3;
    turns_feed(reply, encode_scan_reply(reply));
    (void)turns_pass(TURNS_PACKETS - 1, TURNS_PACKETS - 1, 999);
}

static void look_at_scan(const tmini_scan_t *scan)
{
    bool mixed = false;
    for (unsigned i = 1; i < scan->count; i++) {
        mixed = mixed || scan->points[i].distance_mm != scan->points[0].distance_mm;
    }
    turns_scans.count++;
    turns_scans.mixed += mixed ? 1 : 0;
    turns_scans.complete += scan->complete ? 1 : 0;
    turns_scans.last = *scan;
}

unsigned turns_poll(void)
{
    unsigned events = 0;
    tmini_event_t event;
    while ((event = tmini_poll(&turns.lidar)) != TMINI_EVENT_NONE) {
        events |= 1u << event;
        if (event == TMINI_EVENT_SCAN) {
            look_at_scan(tmini_scan(&turns.lidar));
        }
    }
    return events;
}
