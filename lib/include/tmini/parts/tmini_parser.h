/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Finds scan packets and replies in a ring of received bytes (sections 4 and 5 of the protocol).
 *
 * The parser works in place: the ring's oldest bytes are the candidate, and stay there until they
 * have proved to be a frame or not. A candidate that fails costs exactly one byte; parsing resumes
 * at the byte after its first. Hence no intact packet is ever lost to a neighbour's corruption,
 * and what is delivered does not depend on how the bytes were chunked:
 *
 *   If a valid packet begins here, it is delivered; else if the awaited reply begins here, that is;
 *   else one byte is skipped.
 *
 * A valid packet begins with AA 55, has 1 to max_samples samples (exactly 1 in a start packet), the
 * check bits of both angles set, and a matching checksum. Replies carry no checksum, so one is
 * taken only while it is awaited, and only with the awaited mode, type and length. A frame never
 * spans a place where the ring has lost bytes.
 *
 * All functions: the ring's consumer context only; no waiting. */

#ifndef TMINI_PARSER_H
#define TMINI_PARSER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_frame.h"
#include "tmini_ring.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Samples accepted in a packet unless configured otherwise: the vendor's limit (section 9.6). */
#define TMINI_MAX_SAMPLES_DEFAULT 80u

/** The longest reply, device information. */
#define TMINI_REPLY_SIZE_MAX (TMINI_REPLY_HEADER_SIZE + 20u)

/** The work that one call of tmini_parser_next() may do, in bytes looked at. A candidate's bytes
 * are looked at once, and again for every false header before it whose packet would reach it. */
#if defined(ARDUINO_ARCH_AVR) /* So that a poll takes less time than the core's 64 bytes last. */
#define TMINI_PARSER_EFFORT 256u
#else
#define TMINI_PARSER_EFFORT 1536u
#endif

/** To find that a candidate is no frame costs as much as looking at this many bytes. */
#define TMINI_CANDIDATE_EFFORT 14u

/** What tmini_parser_next() has found. */
typedef enum {
    TMINI_FRAME_NONE,   /**< Nothing more is known from the bytes received so far. */
    TMINI_FRAME_MORE,   /**< Nothing yet, but not all bytes have been looked at: call again. */
    TMINI_FRAME_PACKET, /**< A valid scan packet. */
    TMINI_FRAME_REPLY,  /**< The awaited reply. */
} tmini_frame_type_t;

/** How a reply goes on after its header (section 4). */
typedef enum {
    TMINI_REPLY_MODE_SINGLE = 0,     /**< With content of the length in its header. */
    TMINI_REPLY_MODE_CONTINUOUS = 1, /**< Without end: packets follow, its length is meaningless. */
} tmini_reply_mode_t;

/** The header by which an awaited reply is recognised (section 4). */
typedef struct {
    uint8_t type;   /**< The type code: 04, 06 or 81. */
    uint8_t mode;   /**< A tmini_reply_mode_t. */
    uint8_t length; /**< Bytes of content; 0 and not compared when continuous. */
} tmini_reply_header_t;

/** Running totals, modulo 2^32. Whatever arrives, every byte is in exactly one place:
 * bytes in = in packets + in replies + skipped + overrun + tmini_parser_pending(). */
typedef struct {
    uint32_t packets;          /**< Valid packets. */
    uint32_t checksum_errors;  /**< Complete, plausible candidates whose checksum did not match. */
    uint32_t bytes_in_packets; /**< Of valid packets. */
    uint32_t bytes_in_replies; /**< Of replies that were awaited. */
    uint32_t bytes_skipped;    /**< In no packet or reply; LastCRC bytes are among them. */
    uint32_t bytes_overrun; /**< Refused by a full ring, or overwritten by DMA before being read. */
} tmini_parser_counters_t;

/** A parser over one ring. Treat the members as private. */
typedef struct {
    tmini_frame_t frame; /**< Delivered last; its size is 0 while the next one is sought. */
    uint16_t need;       /**< Bytes without which the candidate cannot be judged further. */
    uint16_t effort;     /**< Done up to the end of the last call that sought a frame, as above. */
    uint8_t max_samples; /**< Packets with more are not valid. */
    uint8_t kind;        /**< What the candidate is by its plausible header: tmini_frame_type_t. */
    bool awaiting;       /**< A reply is awaited, */
    tmini_reply_header_t awaited;     /**< with this header. */
    tmini_parser_counters_t counters; /**< bytes_overrun: without those that the ring refused. */
} tmini_parser_t;

/** Parses what arrives in `ring`, which must outlive the parser. `max_samples`: 1 to 255, or 0 for
 * the default. Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a ring whose window is
 * smaller than the largest packet or reply. */
tmini_status_t tmini_parser_init(tmini_parser_t *parser, tmini_ring_t *ring, uint8_t max_samples);

/** Goes on to the next frame, which tmini_parser_frame() then returns. The frame lies at the ring's
 * tail until the next call gives it back. `effort` has been done already, less than
 * TMINI_PARSER_EFFORT: the call is bounded by what is left of that, and one frame. */
tmini_frame_type_t tmini_parser_next_after(tmini_parser_t *parser, size_t effort);

/** The same, when nothing has been done yet. */
static inline tmini_frame_type_t tmini_parser_next(tmini_parser_t *parser)
{
    return tmini_parser_next_after(parser, 0);
}

/** The frame delivered last, valid until the next call of tmini_parser_next(). */
static inline const tmini_frame_t *tmini_parser_frame(const tmini_parser_t *parser)
{
    return &parser->frame;
}

/** From now on takes a reply with this header; none when `header` is null. It is copied. A
 * delivered reply ends the waiting.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: such a reply is longer than the ring's window, and is
 * not awaited. */
tmini_status_t tmini_parser_await(tmini_parser_t *parser, const tmini_reply_header_t *header);

/** The bytes that wait in the ring for more to come. */
size_t tmini_parser_pending(const tmini_parser_t *parser);

/** After tmini_parser_next() has returned TMINI_FRAME_NONE: true if it has bytes to look at again.
 * Those that the candidate needs next have come, or will not come because some were lost. */
static inline bool tmini_parser_has_work(const tmini_parser_t *parser)
{
    return tmini_ring_ahead(parser->frame.ring) >= parser->need;
}

/** The place in the stream of the byte after the frame delivered last, to be compared by
 * tmini_ring_distance(): where parsing goes on. */
static inline size_t tmini_parser_position(const tmini_parser_t *parser)
{
    return tmini_ring_tail(parser->frame.ring) + parser->frame.size;
}

/** Copies the counters. */
void tmini_parser_counters(const tmini_parser_t *parser, tmini_parser_counters_t *counters);

/** Gives back the frame delivered last, and skips all bytes that have come, without looking at
 * them. */
void tmini_parser_skip_all(tmini_parser_t *parser);

/** No more bytes will come (silence, end of a recording): gives up the incomplete candidate by
 * skipping its first byte, and those after it that can begin no frame. Call tmini_parser_next()
 * again, and both until nothing is pending. Returns false, and does nothing, without a pending
 * candidate. */
bool tmini_parser_abandon(tmini_parser_t *parser);

#ifdef __cplusplus
}
#endif

#endif
