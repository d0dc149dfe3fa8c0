/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Feeds a recording to the library on this computer, for an instruction counter to watch:
 *
 *   host bytes|blocks FILE     about a packet at a time, then tmini_poll() until there is nothing
 *   host decode FILE           the same by blocks, with ring, parser, packet and scan alone
 *
 * Prints how many scan packets were found. */

#include "tmini/tmini.h"

#include <stdio.h>
#include <string.h>

#define BLOCK 131u /* 10 ms at the lidar's data rate. */
#define CAPACITY (1u << 20)

static uint8_t recording[CAPACITY];
static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static uint32_t now_ms;
static uint8_t sent;

static int note_command(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    sent = bytes[count - 1];
    return (int)count;
}

static uint32_t read_clock(void *context)
{
    (void)context;
    return now_ms;
}

static const tmini_port_t port = {.write = note_command, .now_ms = read_clock};

static void poll_all(void)
{
    now_ms += 10;
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
}

static void start(void)
{
    static const uint8_t reply[] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
    (void)tmini_start(&lidar);
    while (sent != TMINI_COMMAND_START) {
        poll_all();
    }
    tmini_feed(&lidar, reply, sizeof reply);
    poll_all();
}

static void feed_bytes(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        tmini_feed_byte(&lidar, bytes[i]);
    }
}

static void feed_all(size_t size, bool by_bytes)
{
    for (size_t at = 0; at < size; at += BLOCK) {
        const size_t count = size - at < BLOCK ? size - at : BLOCK;
        if (by_bytes) {
            feed_bytes(&recording[at], count);
        } else {
            tmini_feed(&lidar, &recording[at], count);
        }
        poll_all();
    }
}

/* What decoders without a driver do: from bytes to scans. Returns the number of packets. */
static unsigned long decode_all(size_t size)
{
    static tmini_ring_t ring;
    static tmini_parser_t parser;
    static tmini_builder_t builder;
    (void)tmini_ring_init(&ring, rx, sizeof rx, false);
    (void)tmini_parser_init(&parser, &ring, 0);
    (void)tmini_builder_init(&builder, points, TMINI_SCAN_POINTS_TYPICAL, TMINI_FILTER_NONE);
    for (size_t at = 0; at < size; at += BLOCK) {
        tmini_ring_write(&ring, &recording[at], size - at < BLOCK ? size - at : BLOCK);
        while (tmini_parser_next(&parser) == TMINI_FRAME_PACKET) {
            tmini_packet_t packet;
            tmini_packet_open(&packet, tmini_parser_frame(&parser));
            if (tmini_builder_add(&builder, &packet, 0)) {
                (void)tmini_builder_add(&builder, &packet, 0);
            }
        }
    }
    tmini_parser_counters_t counters;
    tmini_parser_counters(&parser, &counters);
    return (unsigned long)counters.packets;
}

static unsigned long drive_all(size_t size, bool by_bytes)
{
    tmini_counters_t counters;
    start();
    feed_all(size, by_bytes);
    tmini_counters(&lidar, &counters);
    return (unsigned long)counters.packets;
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
    const tmini_config_t config = {.port = &port,
                                   .rx_buffer = rx,
                                   .rx_size = sizeof rx,
                                   .points = points,
                                   .max_points = TMINI_SCAN_POINTS_TYPICAL};
    const size_t size = argc == 3 ? read_file(argv[2]) : 0;
    if (size == 0 || tmini_init(&lidar, &config) != TMINI_OK) {
        fputs("usage: host bytes|blocks|decode FILE\n", stderr);
        return 2;
    }
    printf("%lu\n", strcmp(argv[1], "decode") == 0
                        ? decode_all(size)
                        : drive_all(size, strcmp(argv[1], "bytes") == 0));
    return 0;
}
