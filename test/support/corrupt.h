/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * Seeded damage to a byte array, as on a bad serial line: lost, flipped and extra bytes,
 * overwritten stretches, cuts; also garbage that looks like the protocol.
 */

#ifndef CORRUPT_H
#define CORRUPT_H

#include "random.h"

#include <stddef.h>
#include <stdint.h>

typedef enum {
    CORRUPT_DROP,    /* one byte lost */
    CORRUPT_FLIP,    /* one bit flipped */
    CORRUPT_INSERT,  /* one byte added */
    CORRUPT_BURST,   /* up to 32 bytes overwritten */
    CORRUPT_CUT,     /* up to 200 bytes lost */
    CORRUPT_GARBAGE, /* up to 32 bytes of look-alike garbage added */
    CORRUPT_KINDS
} corrupt_kind_t;

/* A random byte, in more than half of the cases AA, 55, A5, 5A or another byte of headers, so that
 * a parser meets many false headers. */
uint8_t corrupt_lookalike(random_t *random);

/* Fills a whole array with look-alike garbage. */
void corrupt_fill(random_t *random, uint8_t *bytes, size_t size);

/* Applies one fault of the kind at a random place. `bytes` holds `size` bytes and has room for
 * `capacity`; bytes that an insertion pushes beyond that are lost. Returns the new size. */
size_t corrupt_once(random_t *random, corrupt_kind_t kind, uint8_t *bytes, size_t size,
                    size_t capacity);

/* Applies `faults` faults of random kinds. Returns the new size. */
size_t corrupt_some(random_t *random, unsigned faults, uint8_t *bytes, size_t size,
                    size_t capacity);

#endif
