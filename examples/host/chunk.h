/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The chunks of a timed recording (FILE.tmini): tmini_timed.h describes version 2, which is
 * written. Version 1, which is read as well, has neither A7 C3 nor the CRC, and no chunk without
 * bytes. In both versions chunks are found again after damage: by the CRC, or by a chain of
 * plausible heads. A file may end anywhere in its last chunk, because the program that wrote it may
 * have been ended there: this is no damage. */

#ifndef CHUNK_H
#define CHUNK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_timed.h"

#define CHUNK_MAGIC_SIZE TMINI_TIMED_MAGIC_SIZE
#define CHUNK_VERSION 2u
#define CHUNK_MAX TMINI_TIMED_MAX
#define CHUNK_HEAD_SIZE TMINI_TIMED_HEAD_SIZE

/* Reads one chunk after the other; begins as {.version = ...}. */
typedef struct {
    unsigned version;
    uint64_t time_us; /* When the next bytes came. */
    uint32_t left;    /* How many of them are left; the reader of the bytes counts down. */
    unsigned damages; /* Damaged places. */
    bool is_lost;     /* Looking for the next chunk. */
} chunks_t;

/* The version of a file with this beginning; 0: it has no chunks. */
unsigned chunk_version(const uint8_t *bytes, size_t count);

/* Examines the `bytes` after a chunk: sets `left` and *head, the size of the head before the
 * lidar's bytes. If no chunk begins there, the next byte is passed on as one of the lidar's,
 * because packets have their own checksums. Returns false if more bytes are needed to decide;
 * `is_end`: there are no more. */
bool chunks_begin(chunks_t *chunks, const uint8_t *bytes, size_t count, bool is_end, size_t *head);

#endif
