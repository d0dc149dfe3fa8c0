/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program with only parser and decoding, from bytes to points. */

#include "tmini/parts/tmini_packet.h"
#include "tmini/parts/tmini_parser.h"

static uint8_t rx[512];
static tmini_ring_t ring;
static tmini_parser_t parser;
static tmini_packet_t packet;
static tmini_point_t points[TMINI_MAX_SAMPLES_DEFAULT];

void bench_interrupt(uint8_t byte)
{
    tmini_ring_put(&ring, byte);
}

void bench_main(void)
{
    (void)tmini_ring_init(&ring, rx, sizeof rx, false);
    (void)tmini_parser_init(&parser, &ring, 0);
    for (;;) {
        if (tmini_parser_next(&parser) == TMINI_FRAME_PACKET) {
            tmini_packet_open(&packet, tmini_parser_frame(&parser));
            (void)tmini_packet_points(&packet, TMINI_FILTER_NONE, points,
                                      TMINI_MAX_SAMPLES_DEFAULT);
        }
    }
}
