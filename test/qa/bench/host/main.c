/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Feeds a recording to the emulated program's lidar (emulated/main.c) on this computer, for an
 * instruction counter to watch:
 *
 *   host bytes|blocks FILE BYTES   feeds BYTES at a time, then polls until there is no event
 *   host decode FILE BYTES         feeds blocks to only ring, parser, packet and scan
 *
 * Prints the number of scan packets found. Everything in counted_run() is counted: the library, the
 * C library's copy functions, the clock, and the program's loop around them. */

#include "tmini/tmini.h"

#include <stdio.h>
#include <stdlib.h>

#define BYTES_PER_MS 13u /* The lidar's data rate. */
#define CAPACITY (1u << 20)

extern tmini_t bench_lidar;
extern uint32_t bench_now_ms;
extern uint8_t bench_sent;
void bench_begin(bool dma, bool streaming, size_t rx_size, unsigned filter);

static uint8_t recording[CAPACITY];
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_parser_t parser;

static void poll_all(void)
{
    while (tmini_poll(&bench_lidar) != TMINI_EVENT_NONE) {
    }
}

static void start(void)
{
    static const uint8_t reply[] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
    (void)tmini_start(&bench_lidar);
    while (bench_sent != TMINI_COMMAND_START) {
        bench_now_ms += 10;
        poll_all();
    }
    tmini_feed(&bench_lidar, reply, sizeof reply);
    poll_all();
}

static void feed_bytes(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        tmini_feed_byte(&bench_lidar, bytes[i]);
    }
}

static void drive_all(size_t size, size_t block, bool by_bytes)
{
    const uint32_t begin_ms = bench_now_ms;
    for (size_t at = 0; at < size; at += block) {
        const size_t count = size - at < block ? size - at : block;
        if (by_bytes) {
            feed_bytes(&recording[at], count);
        } else {
            tmini_feed(&bench_lidar, &recording[at], count);
        }
        bench_now_ms = begin_ms + (uint32_t)((at + count) / BYTES_PER_MS);
        poll_all();
    }
}

/* Decodes bytes to scans without the driver. */
static void decode_all(size_t size, size_t block)
{
    static tmini_ring_t ring;
    static tmini_builder_t builder;
    (void)tmini_ring_init(&ring, rx, sizeof rx, false);
    (void)tmini_parser_init(&parser, &ring, 0);
    (void)tmini_builder_init(&builder, points, TMINI_SCAN_POINTS_TYPICAL, TMINI_FILTER_NONE);
    for (size_t at = 0; at < size; at += block) {
        tmini_ring_write(&ring, &recording[at], size - at < block ? size - at : block);
        while (tmini_parser_next(&parser) == TMINI_FRAME_PACKET) {
            tmini_packet_t packet;
            tmini_packet_open(&packet, tmini_parser_frame(&parser));
            if (tmini_builder_add(&builder, &packet, 0)) {
                (void)tmini_builder_add(&builder, &packet, 0);
            }
        }
    }
}

/* Only instructions in this function are counted. */
TMINI_NOINLINE static void counted_run(const char *way, size_t size, size_t block)
{
    if (way[0] == 'd') {
        decode_all(size, block);
    } else {
        drive_all(size, block, way[1] == 'y');
    }
}

static size_t read_file(const char *name)
{
    FILE *const file = fopen(name, "rb");
    if (file == NULL) {
        return 0;
    }
    const size_t size = fread(recording, 1, sizeof recording, file);
    (void)fclose(file);
    return size;
}

int main(int argc, char **argv)
{
    const size_t size = argc == 4 ? read_file(argv[2]) : 0;
    const size_t block = argc == 4 ? (size_t)strtoul(argv[3], NULL, 10) : 0;
    tmini_counters_t counters;
    if (size == 0 || block == 0) {
        fputs("usage: host bytes|blocks|decode FILE BYTES\n", stderr);
        return 2;
    }
    bench_begin(false, false, sizeof rx, TMINI_FILTER_NONE);
    start();
    counted_run(argv[1], size, block);
    tmini_counters(&bench_lidar, &counters);
    printf("%lu\n", (unsigned long)(counters.packets + parser.counters.packets));
    return 0;
}
