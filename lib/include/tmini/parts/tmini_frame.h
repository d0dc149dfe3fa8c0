/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A frame: a scan packet or a reply that the parser has found (sections 4 and 5). The modules that
 * read frames use only this header and nothing below it.
 *
 * The frame's bytes stay in the ring until the parser looks for the next frame. DMA may overwrite
 * them before that: check tmini_frame_intact() after reading them. All functions: the ring's
 * consumer context; no waiting. */

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

/** The offset of sample `index` (from 0) in a packet, in bytes. */
#define TMINI_SAMPLE_OFFSET(index) (TMINI_PACKET_HEADER_SIZE + TMINI_SAMPLE_SIZE * (index))
/** The size in bytes of a packet with this number of samples. */
#define TMINI_PACKET_SIZE(samples) TMINI_SAMPLE_OFFSET(samples)

/** A packet or reply that the parser has found. Members may be read. */
typedef struct tmini_frame {
    tmini_ring_t *ring; /**< Holds the frame; its first byte is the oldest in the ring. */
    uint8_t header[TMINI_PACKET_HEADER_SIZE - TMINI_START_SIGN_SIZE]; /**< Without the start sign; a
                                                                       * reply's header is
                                                                       * shorter. */
    uint16_t size;            /**< Size of the frame in bytes. */
    uint16_t gap;             /**< Bytes skipped since the previous frame; TMINI_GAP_UNKNOWN: bytes
                               * were lost. */
    uint16_t checksum_errors; /**< The parser's checksum errors so far, modulo 2^16. */
    uint8_t last_skipped;     /**< The last of the skipped bytes. */
} tmini_frame_t;

/** True if the frame's bytes are certainly still as they were found. Only DMA can make it false:
 * then do not use anything that was read from the frame. */
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

/** Copies the first `count` bytes of a reply's content to `content`; `count` is not above the
 * reply's length. Returns false if DMA has overwritten them: then do not use them. */
static inline bool tmini_frame_content(const tmini_frame_t *frame, uint8_t *content, size_t count)
{
    tmini_ring_copy(frame->ring, TMINI_REPLY_HEADER_SIZE, content, count);
    return tmini_frame_intact(frame);
}

/** Returns the packet's samples from `index` on that are contiguous in memory, so that loops over
 * samples need not wrap. `*count` is how many are wanted (at least one), and becomes how many there
 * are (at least one). A sample that straddles the end of the ring's memory is copied to `joined`.
 * The result points into the ring's memory, or to `joined`, and is valid as long as the frame
 * is. */
const uint8_t *tmini_frame_samples(const tmini_frame_t *frame, size_t index, size_t *count,
                                   uint8_t joined[TMINI_SAMPLE_SIZE]);

#ifdef __cplusplus
}
#endif

#endif
