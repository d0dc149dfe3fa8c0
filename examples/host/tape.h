/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Plays a recording: decodes the bytes of a file of any length to packets and scans, in constant
 * memory. Used by the tool, the viewer and the Python package. No reply is awaited, so replies
 * count as skipped bytes. */

#ifndef TAPE_H
#define TAPE_H

#include "chunk.h"
#include "stream.h"

typedef enum {
    TAPE_NEEDS_BYTES,
    TAPE_LATER,  /* The next bytes came after `until_us`. */
    TAPE_PACKET, /* stream.decoder.packet */
    TAPE_SCAN,   /* The same, and it ends a scan: stream.scan. */
    TAPE_END,    /* stream_end() delivers the unfinished scan. */
} tape_next_t;

/* Members down to `stream` may be read. */
typedef struct {
    uint64_t time_us;  /* When the latest packet came; without time stamps, computed from 4000
                        * samples per second. */
    uint64_t until_us; /* May be set: in a timed recording, bytes after this time are not read
                        * yet. */
    count_t bytes;     /* The lidar's bytes so far. */
    bool is_begun;     /* It is known whether the file has chunks: chunks.version. */
    chunks_t chunks;
    stream_t stream;

    void (*tap)(void *context, const uint8_t *bytes, size_t count); /* May be set: gets all of the
                                                                     * lidar's bytes. */
    void *tap_context;
    bool is_at_end;
    size_t at, count; /* In `buffer`: what has been fed and not yet decoded. */
    tmini_ring_t ring;
    uint8_t memory[4096];
    uint8_t buffer[32768];
} tape_t;

/* Begins a recording. `mount` as in stream_init(); packets of more than `max_samples` samples are
 * not valid, 0: the library's default. */
void tape_begin(tape_t *tape, const tmini_mount_t *mount, uint8_t max_samples);

/* Takes the file's next bytes, after tape_next() has asked for them; a `count` of 0: there are no
 * more. Returns how many it took. */
size_t tape_feed(tape_t *tape, const uint8_t *bytes, size_t count);

/* Returns what comes next. At the end, an incomplete candidate is re-examined byte by byte. */
tape_next_t tape_next(tape_t *tape);

/* Bytes that belonged to no packet, of those decoded so far; and wrong checksums. */
count_t tape_skipped(const tape_t *tape);
count_t tape_checksum_errors(const tape_t *tape);

#endif
