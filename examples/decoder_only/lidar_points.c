/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "lidar_points.h"

#include "tmini/parts/tmini_parser.h"

#define SILENCE_MS 100u /* After this, the rest of a packet does not come any more. */

static uint8_t rx[1024];           /* A power of two; lasts 78 ms. */
static tmini_point_t points[1000]; /* 667 at 6 Hz; more while the motor starts. */
static tmini_ring_t ring;
static tmini_parser_t parser;
static tmini_packet_t packet;
static tmini_builder_t builder;
static size_t heard; /* Where the newest byte was, and when it came. */
static uint32_t heard_ms;

void lidar_points_init(void)
{
    (void)tmini_ring_init(&ring, rx, sizeof rx, false);
    (void)tmini_parser_init(&parser, &ring, 0);
    (void)tmini_builder_init(&builder, points, sizeof points / sizeof points[0], TMINI_FILTER_NONE);
}

void lidar_points_byte(uint8_t byte)
{
    tmini_ring_put(&ring, byte);
}

/* The line is silent: an incomplete packet is given up, so that it does not hide the next one. */
static bool give_up(uint32_t now_ms)
{
    const size_t head = tmini_ring_head(&ring);
    if (head != heard) {
        heard = head;
        heard_ms = now_ms;
    }
    return now_ms - heard_ms >= SILENCE_MS && tmini_parser_abandon(&parser);
}

const tmini_scan_t *lidar_points_next(uint32_t now_ms)
{
    if (builder.ended) { /* The packet that ended the scan before begins this one. */
        (void)tmini_builder_add(&builder, &packet, builder.scan.end_ms);
    }
    for (;;) {
        const tmini_frame_type_t type = tmini_parser_next(&parser);
        if (type == TMINI_FRAME_PACKET) {
            tmini_packet_open(&packet, tmini_parser_frame(&parser));
            if (tmini_builder_add(&builder, &packet, now_ms)) {
                return &builder.scan;
            }
        } else if (type == TMINI_FRAME_NONE && !give_up(now_ms)) {
            return NULL;
        }
    }
}
