/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * What a parser must deliver, written as directly as possible from docs/protocol.md and
 * docs/design.md ("The parser"): over a whole byte array, with random access and no optimisation.
 * Slow and plain on purpose; the library's incremental parser is compared with it. */

#ifndef REFERENCE_DECODER_H
#define REFERENCE_DECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint8_t mode; /* 0 single, 1 continuous */
    uint8_t type;
    uint32_t length; /* of the content; ignored in mode 1, whose content is empty here */
} reference_reply_t;

typedef struct {
    unsigned max_samples;             /* the largest LSN accepted, 1..255 */
    const reference_reply_t *awaited; /* NULL: none. Once delivered it is no longer awaited */
} reference_options_t;

typedef struct {
    bool is_packet;       /* otherwise a reply */
    size_t offset;        /* in the array */
    size_t length;        /* header included */
    const uint8_t *bytes; /* of this item */
    uint8_t ct;           /* packets only, as all below */
    uint8_t lsn;
    uint16_t fsa; /* raw, check bit included */
    uint16_t lsa;
    bool starts_revolution;
} reference_item_t;

typedef struct {
    uint64_t packets;
    uint64_t start_packets;
    uint64_t points;
    uint64_t replies;
    uint64_t checksum_errors; /* complete candidates in which only the checksum is wrong */
    uint64_t bytes;
    uint64_t bytes_in_packets;
    uint64_t bytes_in_replies;
    uint64_t bytes_skipped;
} reference_counts_t;

typedef struct {
    uint16_t angle_q6; /* 1/64 degree, 0..23039 */
    uint16_t distance_mm;
    uint8_t intensity;
    uint8_t flag;
} reference_point_t;

/* Called for every packet and reply, in order. */
typedef void (*reference_callback_t)(void *context, const reference_item_t *item);

/* Decodes the whole array. An incomplete candidate at its end is skipped byte by byte, and the
 * bytes after it are examined. `callback` may be NULL. */
reference_counts_t reference_decode(const uint8_t *bytes, size_t size,
                                    const reference_options_t *options,
                                    reference_callback_t callback, void *context);

/* Sample `index` (from 0) of a valid packet. The angle is the exact rational value of section 5,
 * rounded to the nearest 1/64 degree, halves up; angles of 360 degrees and more are reduced. */
reference_point_t reference_point(const uint8_t *packet, unsigned index);

#endif
