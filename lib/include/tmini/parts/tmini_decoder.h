/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Bytes to packets, replies and scans: parser, CT information and scan builder joined. The driver
 * is built on it, and so is a program that decodes a recording:
 *
 *     tmini_decoder_init(&decoder, &ring, 0);
 *     tmini_builder_init(&decoder.builder, points, max_points, TMINI_FILTER_NONE);
 *     ...
 *     while (tmini_decoder_next(&decoder, 0) == TMINI_FRAME_PACKET) {
 *         if (tmini_decoder_take(&decoder, false, now_ms, 0)) { use(&decoder.builder.scan); }
 *     }
 *
 * All functions: the ring's consumer context; no waiting. */

#ifndef TMINI_DECODER_H
#define TMINI_DECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_builder.h"
#include "tmini_ct.h"
#include "tmini_packet.h"
#include "tmini_parser.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A decoder over one ring. Members may be read; `parser` and `builder` may be used by their own
 * functions. */
typedef struct {
    tmini_packet_t packet;   /**< The latest; valid until the next tmini_decoder_next(). */
    tmini_builder_t builder; /**< Its `scan`; without a capacity no scans are built. */
    tmini_parser_t parser;   /**< Finds the frames. */
    tmini_ct_t ct;           /**< What the unit reports of itself within the stream. */
    uint8_t verdict;         /**< What the latest packet shows of the revolution that it ends: a
                                * tmini_ct_verdict_t. */
} tmini_decoder_t;

/** Decodes what arrives in `ring`, which must outlive the decoder. `max_samples`: packets with more
 * are not valid; 0: the default. It finds packets; for scans set up its builder next. Returns what
 * tmini_parser_init() does, and TMINI_ERROR_ARGUMENT for a null pointer. */
tmini_status_t tmini_decoder_init(tmini_decoder_t *decoder, tmini_ring_t *ring,
                                  uint8_t max_samples);

/** Goes on to the next frame, as tmini_parser_next_after() does. The scan delivered last ends to be
 * valid. */
tmini_frame_type_t tmini_decoder_next(tmini_decoder_t *decoder, size_t effort);

/** Takes the packet that tmini_decoder_next() has found, which came at `now_ms`, or up to `late_ms`
 * earlier. `is_doubtful`: others may be missing before it. Returns true if it ends a scan, which is
 * then builder.scan. */
bool tmini_decoder_take(tmini_decoder_t *decoder, bool is_doubtful, uint32_t now_ms,
                        uint16_t late_ms);

/** Forgets scan and revolution under way: what comes next continues nothing. */
void tmini_decoder_restart(tmini_decoder_t *decoder);

#ifdef __cplusplus
}
#endif

#endif
