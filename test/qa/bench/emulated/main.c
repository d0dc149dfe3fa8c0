/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The program whose functions the emulator calls: one lidar on a board whose clock and UART are
 * variables. Only the library's instructions are counted; of this file, only its inline function in
 * the interrupt. */

#include "tmini/tmini.h"

#define RX_SIZE 4096

tmini_t bench_lidar;
uint8_t bench_rx[RX_SIZE];
uint8_t bench_block[RX_SIZE];
uint32_t bench_now_ms;
uint8_t bench_sent;

tmini_counters_t bench_counters;

static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_point_t packet_points[TMINI_MAX_SAMPLES_DEFAULT];

static int bench_write(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    bench_sent = bytes[count - 1];
    return (int)count;
}

static uint32_t bench_clock(void *context)
{
    (void)context;
    return bench_now_ms;
}

static const tmini_port_t port = {.write = bench_write, .now_ms = bench_clock};

void bench_begin(bool dma, bool streaming, size_t rx_size, unsigned filter)
{
    const tmini_config_t config = {.port = &port,
                                   .rx_buffer = bench_rx,
                                   .rx_size = rx_size,
                                   .rx_dma = dma,
                                   .points = streaming ? NULL : points,
                                   .max_points = streaming ? 0 : TMINI_SCAN_POINTS_TYPICAL,
                                   .filter = (uint8_t)filter};
    if (tmini_init(&bench_lidar, &config) != TMINI_OK) {
        for (;;) {
        }
    }
}

/* This function's cost is subtracted from that of interrupt_feed_byte(): every receive interrupt
 * must load the lidar's address and return. */
const tmini_t *interrupt_nothing(void)
{
    return &bench_lidar;
}

void interrupt_feed_byte(uint8_t byte)
{
    tmini_feed_byte(&bench_lidar, byte);
}

void bench_feed(size_t count)
{
    (void)tmini_feed(&bench_lidar, bench_block, count);
}

void bench_feed_dma(size_t position)
{
    tmini_feed_dma(&bench_lidar, position);
}

/* Does what a streaming user does after TMINI_EVENT_PACKET. */
void bench_decode(void)
{
    (void)tmini_packet_points(tmini_packet(&bench_lidar), TMINI_FILTER_NONE, packet_points,
                              TMINI_MAX_SAMPLES_DEFAULT);
}
