/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A recording's bytes, as they are in the file, to packets and scans: what the viewer and the
 * Python package decode with, where files are read by others. No reply is awaited, so replies count
 * as skipped bytes. */

#ifndef TAPE_H
#define TAPE_H

#include "chunk.h"
#include "tmini/parts/tmini_decoder.h"

typedef enum {
    TAPE_NEEDS_BYTES,
    TAPE_PACKET, /* decoder.packet */
    TAPE_SCAN,   /* The same, and it ends a scan: decoder.builder.scan, valid until the next. */
    TAPE_REST,   /* What the end cuts off of a scan. */
    TAPE_END,
} tape_next_t;

/* Members down to `decoder` may be read. */
typedef struct {
    uint64_t time_us; /* When the latest packet came; untimed: by 4000 samples per second. */
    uint64_t bytes;   /* Of the lidar's. */
    uint64_t samples;
    uint32_t packets;
    uint32_t start_packets;
    uint32_t guard_bytes; /* LastCRC (section 7): skipped, but no damage. */
    uint32_t scan_number; /* Start packets up to and including that of the scan delivered last. */
    chunks_t chunks;
    tmini_decoder_t decoder;

    bool is_begun; /* It is known whether there are chunks. */
    bool is_at_end;
    size_t at, count; /* In `buffer`: what has been fed and not yet decoded. */
    tmini_ring_t ring;
    uint8_t memory[4096];
    uint8_t buffer[32768];
} tape_t;

/* From the beginning; scans are built in `points`. */
void tape_begin(tape_t *tape, tmini_point_t *points, size_t max_points);

/* The file's next bytes, when they are needed; 0: there are no more. Returns how many it took. */
size_t tape_feed(tape_t *tape, const uint8_t *bytes, size_t count);

tape_next_t tape_next(tape_t *tape);

#endif
