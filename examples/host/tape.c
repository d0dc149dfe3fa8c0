/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tape.h"

#include <string.h>

/* With the largest packet waiting for its last byte (775), this much still fits in the ring. */
#define BLOCK_SIZE 2048u

#define US_A_SAMPLE 250u /* Section 1. */

/* After this long without a packet any number of turns may be missing, whatever the angles say: no
 * computer holds that many bytes back. */
#define PAUSE_US 1000000u

void tape_begin(tape_t *tape, tmini_point_t *points, size_t max_points)
{
    memset(tape, 0, sizeof *tape);
    (void)tmini_ring_init(&tape->ring, tape->memory, sizeof tape->memory, false);
    (void)tmini_decoder_init(&tape->decoder, &tape->ring, 0);
    (void)tmini_builder_init(&tape->decoder.builder, points, max_points, TMINI_FILTER_NONE);
}

size_t tape_feed(tape_t *tape, const uint8_t *bytes, size_t count)
{
    const size_t left = tape->count - tape->at;
    const size_t room = sizeof tape->buffer - left;
    const size_t taken = count < room ? count : room;
    memmove(tape->buffer, tape->buffer + tape->at, left);
    memcpy(tape->buffer + left, bytes, taken);
    tape->at = 0;
    tape->count = left + taken;
    tape->is_at_end = count == 0;
    return taken;
}

static bool begin(tape_t *tape)
{
    if (tape->count < CHUNK_MAGIC_SIZE && !tape->is_at_end) {
        return false;
    }
    tape->is_begun = true;
    tape->chunks.version = chunk_version(tape->buffer, tape->count);
    tape->at = tape->chunks.version > 0 ? CHUNK_MAGIC_SIZE : 0;
    return true;
}

/* Bytes of a chunk are next; false if there are not enough to tell. */
static bool find_chunk(tape_t *tape)
{
    size_t head = 0;
    while (tape->chunks.left == 0) {
        const size_t count = tape->count - tape->at;
        const bool is_all = tape->is_at_end || count == sizeof tape->buffer;
        if (!chunks_begin(&tape->chunks, tape->buffer + tape->at, count, is_all, &head)) {
            return false;
        }
        tape->at += head;
    }
    return true;
}

/* More bytes of the lidar's into the ring; false if there are none. */
static bool refill(tape_t *tape)
{
    if (!tape->is_begun && !begin(tape)) {
        return false;
    }
    const bool is_timed = tape->chunks.version > 0;
    if (is_timed && !find_chunk(tape)) {
        return false;
    }
    size_t count = tape->count - tape->at;
    count = count < BLOCK_SIZE ? count : BLOCK_SIZE;
    if (is_timed) {
        count = count < tape->chunks.left ? count : tape->chunks.left;
        tape->chunks.left -= (uint32_t)count;
    }
    (void)tmini_ring_write(&tape->ring, tape->buffer + tape->at, count);
    tape->at += count;
    tape->bytes += count;
    return count > 0;
}

static void count_packet(tape_t *tape)
{
    const tmini_packet_t *const packet = &tape->decoder.packet;
    tape->packets++;
    tape->samples += packet->count;
    if (tmini_packet_is_start(packet)) {
        tape->start_packets++;
        tape->guard_bytes += tape->decoder.parser.frame.gap == 1 ? 1 : 0;
    }
}

static tape_next_t take(tape_t *tape)
{
    const uint64_t before_us = tape->time_us;
    tape->time_us = tape->chunks.version > 0 ? tape->chunks.time_us : tape->samples * US_A_SAMPLE;
    const bool is_doubtful = tape->packets > 0 && tape->time_us - before_us > PAUSE_US;
    const bool is_scan =
        tmini_decoder_take(&tape->decoder, is_doubtful, (uint32_t)(tape->time_us / 1000), 0);
    tape->scan_number = tape->start_packets;
    count_packet(tape);
    const bool is_stub = is_doubtful && tape->decoder.builder.scan.packets == 1;
    return is_scan && !is_stub ? TAPE_SCAN : TAPE_PACKET; /* A start packet and a pause: no scan. */
}

static tape_next_t finish(tape_t *tape)
{
    tmini_builder_t *const builder = &tape->decoder.builder;
    if (!builder->open) {
        return TAPE_END;
    }
    builder->open = false;
    tape->scan_number = tape->start_packets;
    return TAPE_REST;
}

tape_next_t tape_next(tape_t *tape)
{
    for (;;) {
        const tmini_frame_type_t frame = tmini_decoder_next(&tape->decoder, 0);
        if (frame == TMINI_FRAME_PACKET) {
            return take(tape);
        }
        if (frame == TMINI_FRAME_NONE && !refill(tape)) {
            if (!tape->is_at_end) {
                return TAPE_NEEDS_BYTES;
            }
            if (tmini_parser_pending(&tape->decoder.parser) == 0) {
                return finish(tape);
            }
            tmini_parser_abandon(&tape->decoder.parser);
        }
    }
}
