/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The chunks of a timed recording (FILE.tmini): bytes of the lidar, and when they came. A file
 * begins with 89 74 6D 69 6E 69 VV 0A ("tmini", version VV). Numbers have their least significant
 * byte first. Version 2, which is written:
 *
 *     A7 C3   begins a chunk
 *     4       microseconds since the chunk before, or since the recording's beginning
 *     2       how many bytes follow the head: 1 to 4096
 *     2       CRC-16 (polynomial 0x1021, initial value 0xFFFF) of these six and of the bytes
 *     ...     the bytes
 *
 * Version 1 has neither A7 C3 nor the CRC. In both versions chunks are found again after damage: by
 * the CRC, or by a chain of plausible heads. */

#ifndef CHUNK_H
#define CHUNK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CHUNK_MAGIC_SIZE 8u
#define CHUNK_VERSION 2u
#define CHUNK_MAX 4096u
#define CHUNK_HEAD_SIZE 10u

extern const uint8_t chunk_magic[CHUNK_MAGIC_SIZE];

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

/* Fills in the head of a chunk of version 2. */
void chunk_write_head(uint8_t head[CHUNK_HEAD_SIZE], uint32_t delta_us, const uint8_t *bytes,
                      size_t count);

#endif
