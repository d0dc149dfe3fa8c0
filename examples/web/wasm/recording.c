/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A recording, packet by packet: the library without its driver. No reply is awaited, so replies in
 * the recording count as skipped bytes. */

#include "web.h"

#include <stdbool.h>

#include "tmini/parts/tmini_packet.h"
#include "tmini/parts/tmini_parser.h"

/* With a packet waiting for its last byte, a block of JavaScript's fits in: see
 * recording_feed(). */
#define RING_SIZE 32768u

/* After so long without a packet any number of turns may be missing, whatever the angles say. */
#define PAUSE_MS 150u

static struct {
    tmini_ring_t ring;
    tmini_parser_t parser;
    tmini_packet_t packet;
    tmini_builder_t builder;
    tmini_ct_t ct;
    tmini_point_t points[UINT8_MAX];
    uint32_t packets;
    uint32_t start_packets;
    uint32_t samples;
    uint32_t bytes;
    uint32_t chunk_ms;  /* When the bytes came that were fed last, if they are timed. */
    uint32_t packet_ms; /* When the latest packet came. */
    uint32_t frequency_chz;
    bool is_timed;
    bool is_shown;
    bool ended;
    uint8_t memory[RING_SIZE];
    tmini_point_t scan[WEB_SCAN_POINTS];
} tape;

/* From the beginning. Whether its bytes have times, and whether its scans are to be the ones
 * shown. */
EXPORTED void recording_rewind(uint32_t is_timed, uint32_t is_shown)
{
    (void)tmini_ring_init(&tape.ring, tape.memory, RING_SIZE, false);
    (void)tmini_parser_init(&tape.parser, &tape.ring, 0);
    (void)tmini_builder_init(&tape.builder, tape.scan, WEB_SCAN_POINTS, TMINI_FILTER_NONE);
    tmini_ct_init(&tape.ct);
    tape.packets = 0;
    tape.start_packets = 0;
    tape.samples = 0;
    tape.bytes = 0;
    tape.chunk_ms = 0;
    tape.packet_ms = 0;
    tape.frequency_chz = 0;
    tape.is_timed = is_timed != 0;
    tape.is_shown = is_shown != 0;
    tape.ended = false;
    if (tape.is_shown) {
        shown_clear();
    }
}

/* `count` bytes in `transfer` are next, and came at that time; 0: there are no more. To be called
 * when bytes are needed. */
EXPORTED void recording_feed(uint32_t count, uint32_t chunk_ms)
{
    tape.bytes += count;
    tape.chunk_ms = chunk_ms;
    tape.ended = count == 0;
    tmini_ring_write(&tape.ring, web_transfer, count);
}

/* Bytes without times: the lidar takes 4000 samples a second. */
static uint32_t now_ms(void)
{
    return tape.is_timed ? tape.chunk_ms : tape.samples / 4u;
}

static void count_packet(void)
{
    tape.packets++;
    tape.samples += tape.packet.count;
    if (tmini_packet_is_start(&tape.packet)) {
        tape.start_packets++;
        tape.frequency_chz = tape.packet.ct / 2u * 10u; /* Section 7. */
    }
}

static void open_packet(uint32_t at_ms)
{
    tmini_packet_open(&tape.packet, tmini_parser_frame(&tape.parser));
    if (tape.packets > 0 && at_ms - tape.packet_ms > PAUSE_MS) {
        tape.packet.gap = TMINI_GAP_UNKNOWN;
    }
    tape.packet_ms = at_ms;
}

static next_t take_packet(void)
{
    const uint32_t at_ms = now_ms();
    open_packet(at_ms);
    if (tmini_ct_add(&tape.ct, &tape.packet) == TMINI_CT_REFUTED) {
        tmini_builder_refute(&tape.builder);
    }
    const bool is_scan = tmini_builder_add(&tape.builder, &tape.packet, at_ms);
    if (is_scan) {
        if (tape.is_shown) {
            shown_take(&tape.builder.scan);
        }
        (void)tmini_builder_add(&tape.builder, &tape.packet, at_ms);
    }
    (void)tmini_packet_points(&tape.packet, TMINI_FILTER_NONE, tape.points, UINT8_MAX);
    count_packet();
    return is_scan ? NEXT_SCAN : NEXT_PACKET;
}

EXPORTED uint32_t recording_next(void)
{
    for (;;) {
        const tmini_frame_type_t frame = tmini_parser_next(&tape.parser);
        if (frame == TMINI_FRAME_PACKET) {
            return take_packet();
        }
        if (frame == TMINI_FRAME_MORE) {
            continue;
        }
        if (!tape.ended) {
            return NEXT_NEEDS_BYTES;
        }
        if (tmini_parser_pending(&tape.parser) == 0) {
            return NEXT_END;
        }
        tmini_parser_abandon(&tape.parser);
    }
}

/* The latest packet's points. */
EXPORTED const void *recording_points(void)
{
    return tape.points;
}

/* How far it has been played. */
EXPORTED uint32_t recording_time_ms(void)
{
    return now_ms();
}

/* What is told of each point of the latest packet. */
EXPORTED uint32_t recording_packet_numbers(void)
{
    numbers_clear();
    numbers_put("count", tape.packet.count);
    numbers_put("packet", tape.packets - 1u);
    numbers_put("scan", tape.start_packets);
    numbers_put("timeMs", tape.packet_ms);
    numbers_put("frequencyChz", tape.frequency_chz);
    return numbers_count();
}

/* What CT information tells, or unknown: TMINI_FAULTS_UNKNOWN. */
EXPORTED uint32_t recording_faults(void)
{
    return tmini_ct_faults(&tape.ct);
}

EXPORTED uint32_t recording_numbers(void)
{
    tmini_parser_counters_t counters;
    tmini_ct_info_t ct;
    tmini_parser_counters(&tape.parser, &counters);
    tmini_ct_read(&tape.ct, &ct);
    numbers_clear();
    numbers_put("bytes", tape.bytes);
    numbers_put("packets", counters.packets);
    numbers_put("startPackets", tape.start_packets);
    numbers_put("samples", tape.samples);
    numbers_put("checksumErrors", counters.checksum_errors);
    numbers_put("bytesInPackets", counters.bytes_in_packets);
    numbers_put("bytesSkipped", counters.bytes_skipped);
    numbers_put("bytesOverrun", counters.bytes_overrun);
    numbers_put("scans", tape.start_packets);
    numbers_put_ct(&ct);
    return numbers_count();
}
