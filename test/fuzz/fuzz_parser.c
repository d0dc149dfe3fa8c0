/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fuzz target: any bytes, in any chunks, through parser, packets and scans. They must come to the
 * same frames and points as the reference decoder finds, and every byte must be accounted for. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "invariants.h"
#include "reference_decoder.h"
#include "tmini/tmini_parser.h"
#include "tmini/tmini_scan.h"

#define FRAMES_MAX 4096
#define SCAN_POINTS 200 /* Fewer than a scan has: overflow is part of the game. */

static const uint8_t *stream;
static reference_item_t expected[FRAMES_MAX];
static size_t expected_count;
static size_t seen;

static void demand(int condition)
{
    if (!condition) {
        abort();
    }
}

static void expect(void *context, const reference_item_t *item)
{
    (void)context;
    if (expected_count < FRAMES_MAX) {
        expected[expected_count++] = *item;
    }
}

static void compare_packet(const tmini_packet_t *packet)
{
    demand(seen < expected_count);
    const reference_item_t *const item = &expected[seen++];
    demand(item->is_packet && item->ct == packet->ct && item->lsn == packet->count);
    for (unsigned i = 0; i < packet->count; i++) {
        const reference_point_t wanted = reference_point(item->bytes, i);
        tmini_point_t point;
        demand(tmini_packet_point(packet, i, &point));
        demand(point.angle_q6 == wanted.angle_q6 && point.distance_mm == wanted.distance_mm);
        demand(point.intensity == wanted.intensity && point.flag == wanted.flag);
    }
}

static void gather(tmini_scan_builder_t *builder, const tmini_packet_t *packet)
{
    if (tmini_scan_add(builder, packet, 0)) {
        const tmini_scan_t *const scan = &builder->scan;
        demand(scan->count <= SCAN_POINTS && scan->packets > 0);
        demand(!scan->complete || (scan->gaps == 0 && scan->dropped == 0));
        for (size_t i = 0; i < scan->count; i++) {
            demand(scan->points[i].angle_q6 < TMINI_FULL_CIRCLE_Q6);
        }
        demand(!tmini_scan_add(builder, packet, 0));
    }
}

static void drain(tmini_parser_t *parser, tmini_scan_builder_t *builder)
{
    for (;;) {
        const tmini_frame_type_t type = tmini_parser_next(parser);
        demand(parser_is_sound(parser) && builder_is_sound(builder));
        switch (type) {
        case TMINI_FRAME_NONE:
            return;
        case TMINI_FRAME_MORE:
            break;
        case TMINI_FRAME_PACKET: {
            tmini_packet_t packet;
            tmini_packet_open(&packet, tmini_parser_frame(parser));
            compare_packet(&packet);
            gather(builder, &packet);
            break;
        }
        case TMINI_FRAME_REPLY:
            demand(seen < expected_count && !expected[seen].is_packet);
            seen++;
            break;
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The first four bytes choose the set-up; the rest is the stream. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t memory[1024];
    static tmini_point_t points[SCAN_POINTS];
    if (size < 4) {
        return 0;
    }
    const uint8_t max_samples = data[0] == 0 ? 80 : data[0];
    const size_t chunk = 1u + data[1] % 200u;
    const bool waits = data[2] % 2 != 0;
    const tmini_reply_header_t header = {.type = 0x04, .mode = 0, .length = data[3] % 21u};
    const reference_reply_t reply = {.mode = 0, .type = 0x04, .length = header.length};
    const reference_options_t options = {.max_samples = max_samples,
                                         .awaited = waits ? &reply : NULL};
    stream = data + 4;
    size -= 4;

    expected_count = 0;
    seen = 0;
    const reference_counts_t counts = reference_decode(stream, size, &options, expect, NULL);

    tmini_ring_t ring;
    tmini_parser_t parser;
    tmini_scan_builder_t builder;
    demand(tmini_ring_init(&ring, memory, sizeof memory, false) == TMINI_OK);
    demand(tmini_parser_init(&parser, &ring, max_samples) == TMINI_OK);
    demand(tmini_scan_init(&builder, points, SCAN_POINTS, TMINI_FILTER_BOTH) == TMINI_OK);
    demand(tmini_parser_await(&parser, waits ? &header : NULL) == TMINI_OK);
    for (size_t at = 0; at < size; at += chunk) {
        tmini_ring_write(&ring, stream + at, size - at < chunk ? size - at : chunk);
        drain(&parser, &builder);
    }
    while (tmini_parser_pending(&parser) > 0) {
        tmini_parser_abandon(&parser);
        drain(&parser, &builder);
    }
    demand(seen == expected_count || expected_count == FRAMES_MAX);
    tmini_parser_counters_t counters;
    tmini_parser_counters(&parser, &counters);
    demand(counters.packets == counts.packets);
    demand(counters.checksum_errors == counts.checksum_errors);
    demand(counters.bytes_in_packets == counts.bytes_in_packets);
    demand(counters.bytes_in_replies == counts.bytes_in_replies);
    demand(counters.bytes_skipped == counts.bytes_skipped);
    demand(counters.bytes_overrun == 0);
    return 0;
}
