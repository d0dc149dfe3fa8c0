/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tape.h"

#include <string.h>

/* This much fits in the ring even when the largest packet (775) waits for its last byte. */
#define BLOCK_SIZE 2048u

#define SAMPLE_US 250u /* Section 1. */

void tape_begin(tape_t *tape, const tmini_mount_t *mount, uint8_t max_samples)
{
    memset(tape, 0, sizeof *tape);
    tape->until_us = UINT64_MAX;
    (void)tmini_ring_init(&tape->ring, tape->memory, sizeof tape->memory, false);
    stream_init(&tape->stream, mount);
    (void)tmini_parser_init(&tape->stream.decoder.parser, &tape->ring, max_samples);
}

static void begin_chunks(tape_t *tape)
{
    tape->is_begun = tape->count >= CHUNK_MAGIC_SIZE || tape->is_at_end;
    tape->chunks.version = chunk_version(tape->buffer, tape->count);
    tape->at = tape->chunks.version > 0 ? CHUNK_MAGIC_SIZE : 0;
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
    if (!tape->is_begun) {
        begin_chunks(tape);
    }
    return taken;
}

/* Goes on to the bytes of the next chunk; false if more bytes are needed. */
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

/* The next chunk is later than `until_us`. */
static bool is_early(const tape_t *tape)
{
    return tape->chunks.left > 0 && tape->chunks.time_us > tape->until_us;
}

/* Moves more of the lidar's bytes into the ring; false if there are none. */
static bool refill(tape_t *tape)
{
    const bool is_timed = tape->chunks.version > 0;
    if (!tape->is_begun || (is_timed && (!find_chunk(tape) || is_early(tape)))) {
        return false;
    }
    size_t count = tape->count - tape->at;
    count = count < BLOCK_SIZE ? count : BLOCK_SIZE;
    if (is_timed) {
        count = count < tape->chunks.left ? count : tape->chunks.left;
        tape->chunks.left -= (uint32_t)count;
    }
    (void)tmini_ring_write(&tape->ring, tape->buffer + tape->at, count);
    if (tape->tap != NULL) {
        tape->tap(tape->tap_context, tape->buffer + tape->at, count);
    }
    tape->at += count;
    tape->bytes += count;
    return count > 0;
}

static tape_next_t take(tape_t *tape)
{
    stream_t *const stream = &tape->stream;
    tmini_packet_t packet;
    tmini_packet_open(&packet, tmini_parser_frame(&stream->decoder.parser));
    tape->time_us = tape->chunks.version > 0 ? tape->chunks.time_us : stream->points * SAMPLE_US;
    return stream_take(stream, &packet, (uint32_t)(tape->time_us / 1000)) ? TAPE_SCAN : TAPE_PACKET;
}

tape_next_t tape_next(tape_t *tape)
{
    tmini_decoder_t *const decoder = &tape->stream.decoder;
    for (;;) {
        const tmini_frame_type_t frame = tmini_decoder_next(decoder, 0);
        if (frame == TMINI_FRAME_PACKET) {
            return take(tape);
        }
        if (frame == TMINI_FRAME_MORE || refill(tape)) {
            continue;
        }
        if (is_early(tape)) {
            return TAPE_LATER;
        }
        if (!tape->is_at_end) {
            return TAPE_NEEDS_BYTES;
        }
        if (!tmini_parser_abandon(&decoder->parser)) {
            return TAPE_END;
        }
    }
}

count_t tape_skipped(const tape_t *tape)
{
    const stream_t *const stream = &tape->stream;
    return tape->bytes - TMINI_PACKET_HEADER_SIZE * stream->packets -
           TMINI_SAMPLE_SIZE * stream->points - tmini_parser_pending(&stream->decoder.parser);
}

count_t tape_checksum_errors(const tape_t *tape)
{
    return tape->stream.decoder.parser.counters.checksum_errors;
}
