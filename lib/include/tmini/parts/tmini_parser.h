/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Finds scan packets and replies in a ring of received bytes (sections 4 and 5 of the protocol).
 *
 * The parser works in place: the ring's oldest bytes are the candidate, and stay there until it is
 * clear whether they are a frame. A candidate that fails costs exactly one byte; parsing resumes at
 * the byte after its first. Hence damage to one packet never costs an intact neighbour, and the
 * result does not depend on the sizes of the blocks in which the bytes came:
 *
 *   If a valid packet begins here, it is delivered; else if the awaited reply begins here, it is
 *   delivered; else one byte is skipped.
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

/** The work that one call of tmini_parser_next() may do, in bytes looked at. Each byte is looked at
 * once, and once more for every false header before it whose packet would include it. */
#if defined(ARDUINO_ARCH_AVR) /* So that a poll is over before the core's 64-byte buffer is full. */
#define TMINI_PARSER_EFFORT 256u
#else
#define TMINI_PARSER_EFFORT 1536u
#endif

/** Rejecting a candidate costs as much time as looking at this many bytes. */
#define TMINI_CANDIDATE_EFFORT 14u

/** What tmini_parser_next() has found. */
typedef enum {
    TMINI_FRAME_NONE,   /**< No frame is complete in the bytes received so far. */
    TMINI_FRAME_MORE,   /**< No frame yet, but some bytes have not been looked at: call again. */
    TMINI_FRAME_PACKET, /**< A valid scan packet. */
    TMINI_FRAME_REPLY,  /**< The awaited reply. */
} tmini_frame_type_t;

/** What follows a reply's header (section 4). */
typedef enum {
    TMINI_REPLY_MODE_SINGLE = 0,     /**< Content, of the length in the header. */
    TMINI_REPLY_MODE_CONTINUOUS = 1, /**< Packets without end; the length is meaningless. */
} tmini_reply_mode_t;

/** The header by which an awaited reply is recognised (section 4). */
typedef struct {
    uint8_t type;   /**< The type code: 04, 06 or 81. */
    uint8_t mode;   /**< A tmini_reply_mode_t. */
    uint8_t length; /**< Bytes of content; 0 for a continuous reply, where it is not compared. */
} tmini_reply_header_t;

/** Running totals, modulo 2^32. Every received byte is counted in exactly one of them:
 * bytes in = in packets + in replies + skipped + overrun + tmini_parser_pending(). */
typedef struct {
    uint32_t packets;          /**< Valid packets. */
    uint32_t checksum_errors;  /**< Complete, plausible candidates whose checksum did not match. */
    uint32_t bytes_in_packets; /**< Bytes of valid packets. */
    uint32_t bytes_in_replies; /**< Bytes of awaited replies. */
    uint32_t bytes_skipped;    /**< Bytes of neither; they include LastCRC bytes. */
    uint32_t bytes_overrun;    /**< Bytes refused by a full ring, or overwritten by DMA before they
                             * were read. */
} tmini_parser_counters_t;

/** A parser over one ring. Treat the members as private. */
typedef struct {
    tmini_frame_t frame; /**< The frame delivered last; size 0 while the parser looks for the next
                          * one. */
    uint16_t need;       /**< Bytes needed before the candidate can be judged further. */
    uint16_t kind;       /**< What the candidate's header announces: a tmini_frame_type_t. */
    uint16_t effort;     /**< Work done by the end of the last call that looked for a frame
                          * (TMINI_PARSER_EFFORT). */
    uint8_t max_samples; /**< Packets with more are not valid. */
    bool awaiting;       /**< A reply is awaited. */
    tmini_reply_header_t awaited;     /**< Its header. */
    tmini_parser_counters_t counters; /**< bytes_overrun excludes bytes that the ring refused. */
} tmini_parser_t;

/** Sets up a parser of the bytes in `ring`, which must outlive it. `max_samples`: 1 to 255, or 0
 * for the default. Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a ring whose window
 * is smaller than the largest packet or reply. */
tmini_status_t tmini_parser_init(tmini_parser_t *parser, tmini_ring_t *ring, uint8_t max_samples);

/** Finds the next frame; tmini_parser_frame() then returns it. It stays at the ring's tail until
 * the next call gives its bytes back. `effort` is the work that the caller has already done: this
 * call does at most the rest of TMINI_PARSER_EFFORT, and one frame. */
tmini_frame_type_t tmini_parser_next_after(tmini_parser_t *parser, size_t effort);

/** The same, with no work done yet. */
static inline tmini_frame_type_t tmini_parser_next(tmini_parser_t *parser)
{
    return tmini_parser_next_after(parser, 0);
}

/** The frame delivered last, valid until the next call of tmini_parser_next(). */
static inline const tmini_frame_t *tmini_parser_frame(const tmini_parser_t *parser)
{
    return &parser->frame;
}

/** Awaits a reply with this header, which is copied; null: awaits none. When the reply has been
 * delivered, none is awaited any more.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: the reply would be longer than the ring's window; none
 * is awaited. */
tmini_status_t tmini_parser_await(tmini_parser_t *parser, const tmini_reply_header_t *header);

/** Awaits the reply that was delivered last once more. Call it before the next
 * tmini_parser_next(). */
static inline void tmini_parser_await_again(tmini_parser_t *parser)
{
    parser->awaiting = true;
}

/** How many bytes wait in the ring for more to come. */
size_t tmini_parser_pending(const tmini_parser_t *parser);

/** After tmini_parser_next() has returned TMINI_FRAME_NONE: true if another call has something to
 * do, because the bytes that the candidate needs have come, or cannot come because bytes were
 * lost. */
static inline bool tmini_parser_has_work(const tmini_parser_t *parser)
{
    return tmini_ring_ahead(parser->frame.ring) >= parser->need;
}

/** Copies the counters. */
void tmini_parser_counters(const tmini_parser_t *parser, tmini_parser_counters_t *counters);

/** Gives the frame delivered last back to the ring, and skips all received bytes without looking at
 * them. */
void tmini_parser_skip_all(tmini_parser_t *parser);

/** Gives up an incomplete candidate because no more bytes will come (silence, or the end of a
 * recording). It skips the candidate's first byte, and the bytes after it that cannot begin a
 * frame. Then call tmini_parser_next() again; repeat both until nothing is pending. Returns false,
 * and does nothing, if there is no incomplete candidate. */
bool tmini_parser_abandon(tmini_parser_t *parser);

#ifdef __cplusplus
}
#endif

#endif
