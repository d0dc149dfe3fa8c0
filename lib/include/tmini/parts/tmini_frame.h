/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A frame: a scan packet or a reply that the parser has found (sections 4 and 5). What reads frames
 * (packet, ct, scan) knows this and nothing below it.
 *
 * The frame's bytes lie in the ring until the parser goes on to the next one. With DMA they may be
 * overwritten there meanwhile: after reading them, ask tmini_frame_intact(). All functions: the
 * ring's consumer context; no waiting. */

#ifndef TMINI_FRAME_H
#define TMINI_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_ring.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Packets and replies begin with a start sign of two bytes, which is part of the header. */
#define TMINI_START_SIGN_SIZE 2u
/** Bytes of a packet before its samples (section 5). */
#define TMINI_PACKET_HEADER_SIZE 10u
/** Bytes of a reply before its content (section 4). */
#define TMINI_REPLY_HEADER_SIZE 7u
/** Bytes of a sample (section 5). */
#define TMINI_SAMPLE_SIZE 3u

/** Where sample `index`, from 0, lies in a packet: bytes from its beginning. */
#define TMINI_SAMPLE_OFFSET(index) (TMINI_PACKET_HEADER_SIZE + TMINI_SAMPLE_SIZE * (index))
/** The bytes of a packet with this many samples. */
#define TMINI_PACKET_SIZE(samples) TMINI_SAMPLE_OFFSET(samples)

/** A packet or reply that the parser has found. Members may be read. */
typedef struct tmini_frame {
    tmini_ring_t *ring;       /**< Holds the bytes, the frame's first one being the oldest. */
    uint16_t size;            /**< Bytes. */
    uint16_t gap;             /**< Bytes skipped since the last one, or TMINI_GAP_UNKNOWN: lost. */
    uint16_t checksum_errors; /**< The parser's so far, modulo 2^16. */
    uint8_t last_skipped;     /**< The last of the skipped bytes. */
    uint8_t header[TMINI_PACKET_HEADER_SIZE - TMINI_START_SIGN_SIZE]; /**< A reply's is shorter. */
} tmini_frame_t;

/** True while the frame is certainly as it was found. Only DMA can make it false; then nothing that
 * was read of it may be used. */
static inline bool tmini_frame_intact(const tmini_frame_t *frame)
{
    return tmini_ring_intact(frame->ring);
}

/** The frame's byte at `offset`, which is below its size: 0 is the start sign's first byte. DMA may
 * have overwritten it. */
static inline uint8_t tmini_frame_peek(const tmini_frame_t *frame, size_t offset)
{
    return tmini_ring_peek(frame->ring, offset);
}

/** Copies the first `count` bytes, at most as many as the reply has, of a reply's content to
 * `content`. Returns false if DMA has overwritten them. */
static inline bool tmini_frame_content(const tmini_frame_t *frame, uint8_t *content, size_t count)
{
    tmini_ring_copy(frame->ring, TMINI_REPLY_HEADER_SIZE, content, count);
    return tmini_frame_intact(frame);
}

/** The packet's samples from `index` on that lie in one piece, so that the loops over samples, the
 * hottest there are, run without wrapping: at most *count, which becomes how many there are, at
 * least one. One that straddles the end of the ring's memory is put together in `joined`. The
 * result points into the ring's memory, or to `joined`, and is valid as long as the frame is. */
const uint8_t *tmini_frame_samples(const tmini_frame_t *frame, size_t index, size_t *count,
                                   uint8_t joined[TMINI_SAMPLE_SIZE]);

#ifdef __cplusplus
}
#endif

#endif
