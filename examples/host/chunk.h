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
 * Version 1 has neither the first two nor the CRC. Whatever the version, chunks are found again
 * after damage: by the CRC, or by a chain of plausible heads. */

#ifndef CHUNK_H
#define CHUNK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CHUNK_VERSION_AT 6 /* In the magic bytes. */
#define CHUNK_MAX 4096u
#define CHUNK_HEAD_SIZE 10u

extern const uint8_t chunk_magic[8];

typedef struct {
    size_t head_size;
    uint32_t delta_us;
    uint32_t size; /* Of the bytes after the head. */
    bool is_plausible;
} chunk_t;

typedef enum {
    CHUNK_NONE,  /* No chunk begins here, or it is damaged. */
    CHUNK_SHORT, /* There may be one: that depends on what follows. */
    CHUNK_WHOLE,
} chunk_state_t;

/* What begins at `bytes`. `is_end`: nothing follows them. After damage (`is_lost`) the proof must
 * be stronger. */
chunk_state_t chunk_read(unsigned version, const uint8_t *bytes, size_t count, bool is_end,
                         bool is_lost, chunk_t *chunk);

/* Fills in the head of a chunk of version 2. */
void chunk_write_head(uint8_t head[CHUNK_HEAD_SIZE], uint32_t delta_us, const uint8_t *bytes,
                      size_t count);

#endif
