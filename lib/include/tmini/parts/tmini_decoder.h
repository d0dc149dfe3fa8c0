/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * From bytes to packets, replies and scans: joins parser, CT information and scan builder. The
 * driver is built on it, and so is a program that decodes a recording:
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
    tmini_packet_t packet;   /**< The latest packet; valid until the next tmini_decoder_next(). */
    bool is_whole;           /**< Nothing has been lost since the last start packet. */
    bool was_whole;          /**< The latest packet ends a revolution that came whole. */
    uint8_t verdict;         /**< What the latest packet shows about the revolution that it ends: a
                              * tmini_ct_verdict_t. */
    tmini_builder_t builder; /**< Holds the `scan`; if it was not set up, no scans are built. */
    tmini_parser_t parser;   /**< Finds packets and replies. */
    tmini_ct_t ct;           /**< The unit's reports about itself in the stream. */
} tmini_decoder_t;

/** Sets up a decoder of the bytes in `ring`, which must outlive it. `max_samples`: packets with
 * more samples are not valid; 0: the default. The decoder finds packets; to get scans, set up its
 * builder next. Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a ring too small (see
 * tmini_parser_init()). */
tmini_status_t tmini_decoder_init(tmini_decoder_t *decoder, tmini_ring_t *ring,
                                  uint8_t max_samples);

/** Finds the next frame, as tmini_parser_next_after() does. The scan delivered last is no longer
 * valid. */
static inline tmini_frame_type_t tmini_decoder_next(tmini_decoder_t *decoder, size_t effort)
{
    tmini_builder_t *const builder = &decoder->builder;
    if (builder->ended) { /* The packet that ended the scan begins the next one. */
        (void)tmini_builder_add(builder, &decoder->packet, builder->scan.end_ms);
    }
    return tmini_parser_next_after(&decoder->parser, effort);
}

/** Takes the packet that tmini_decoder_next() has found. It came at `now_ms`, or up to `late_ms`
 * earlier. `is_doubtful`: packets may be missing before it. Returns true if it ends a scan, which
 * is then builder.scan. */
bool tmini_decoder_take(tmini_decoder_t *decoder, bool is_doubtful, uint32_t now_ms,
                        uint16_t late_ms);

/** Takes a packet that was found elsewhere, for example by a driver; its gap shows whether packets
 * may be missing before it. Such a decoder needs no ring and must be all zero at first. If the
 * function returns true, add `packet` to the builder again while it is valid. */
bool tmini_decoder_take_packet(tmini_decoder_t *decoder, const tmini_packet_t *packet,
                               uint32_t now_ms);

/** Forgets the scan and the revolution in progress: the next packet does not continue them. */
void tmini_decoder_restart(tmini_decoder_t *decoder);

#ifdef __cplusplus
}
#endif

#endif
