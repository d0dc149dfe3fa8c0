/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A recording, packet by packet: the library without its driver. */

#include "web.h"

#include <stdbool.h>

#include "tape.h"

static struct {
    tape_t tape;
    tmini_point_t points[UINT8_MAX];
    bool is_shown;
} played;

/* Goes to the beginning. `is_shown`: the recording's scans are shown. */
EXPORTED void recording_rewind(uint32_t is_shown)
{
    tape_begin(&played.tape, NULL, 0);
    played.is_shown = is_shown != 0;
    if (played.is_shown) {
        shown_clear();
    }
}

/* Takes the file's next `count` bytes, from `transfer`; 0: there are no more. Call it when bytes
 * are needed. Returns how many were taken. */
EXPORTED uint32_t recording_feed(uint32_t count)
{
    return (uint32_t)tape_feed(&played.tape, web_transfer, count);
}

EXPORTED uint32_t recording_next(void)
{
    const stream_t *const stream = &played.tape.stream;
    const tape_next_t next = tape_next(&played.tape);
    if (next == TAPE_SCAN && played.is_shown) {
        shown_take(&stream->scan);
    }
    if (next == TAPE_PACKET || next == TAPE_SCAN) {
        (void)tmini_packet_points(&stream->decoder.packet, TMINI_FILTER_NONE, played.points,
                                  UINT8_MAX);
    }
    return next;
}

/* The latest packet's points. */
EXPORTED const void *recording_points(void)
{
    return played.points;
}

/* How far it has been played. */
EXPORTED uint32_t recording_time_ms(void)
{
    const tape_t *const tape = &played.tape;
    return (uint32_t)(tape->chunks.version > 0 ? tape->time_us / 1000u : tape->stream.points / 4u);
}

/* The values that are the same in each row of the latest packet's points. */
EXPORTED uint32_t recording_packet_numbers(void)
{
    const stream_t *const stream = &played.tape.stream;
    numbers_clear();
    numbers_put("count", stream->decoder.packet.count);
    numbers_put("packet", (uint32_t)stream->packets - 1u);
    numbers_put("scan", (uint32_t)stream->start_packets);
    numbers_put("timeMs", stream->packet_ms);
    numbers_put("frequencyChz", stream->frequency_chz);
    return numbers_count();
}

/* The faults in CT information, or TMINI_FAULTS_UNKNOWN. */
EXPORTED uint32_t recording_faults(void)
{
    return stream_faults(&played.tape.stream);
}

EXPORTED uint32_t recording_numbers(void)
{
    const tape_t *const tape = &played.tape;
    const stream_t *const stream = &tape->stream;
    tmini_parser_counters_t counters;
    tmini_ct_info_t ct;
    tmini_parser_counters(&stream->decoder.parser, &counters);
    tmini_ct_read(&stream->decoder.ct, &ct);
    numbers_clear();
    numbers_put("bytes", (uint32_t)tape->bytes);
    numbers_put("version", tape->chunks.version);
    numbers_put("damages", tape->chunks.damages);
    numbers_put("packets", counters.packets);
    numbers_put("checksumErrors", counters.checksum_errors);
    numbers_put("bytesSkipped", counters.bytes_skipped - (uint32_t)stream->last_crc_bytes);
    numbers_put("lastCrcBytes", (uint32_t)stream->last_crc_bytes);
    numbers_put("bytesOverrun", counters.bytes_overrun);
    numbers_put("scans", (uint32_t)stream->start_packets);
    numbers_put_ct(&ct);
    return numbers_count();
}

/* The first bytes of a recording that the page saves. */
EXPORTED const void *recording_magic(void)
{
    return tmini_timed_magic;
}

/* The head of a chunk of that recording: the chunk holds the `count` bytes in `transfer`. */
EXPORTED const void *recording_head(uint32_t delta_us, uint32_t count)
{
    static uint8_t head[CHUNK_HEAD_SIZE];
    tmini_timed_write_head(head, delta_us, web_transfer, count);
    return head;
}
