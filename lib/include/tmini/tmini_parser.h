/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Finds scan packets and replies in a ring of received bytes (sections 4 and 5 of the protocol).
 *
 * The parser works in place: the ring's oldest bytes are the candidate, and stay there until they
 * have proved to be a frame or not. A candidate that fails costs exactly one byte; parsing resumes
 * at the byte behind its first. Hence no intact packet is ever lost to a neighbour's corruption,
 * and what is delivered does not depend on how the bytes were chunked:
 *
 *   If a valid packet begins here, it is delivered; else if the awaited reply begins here, that is;
 *   else one byte is skipped.
 *
 * A valid packet begins with AA 55, has 1 to max_samples samples (exactly 1 in a start packet), the
 * check bits of both angles set, and a matching checksum. Replies carry no checksum, so one is
 * taken only while it is awaited, and only with the awaited mode, type and length.
 *
 * All functions: the ring's consumer context only; no waiting. */

#ifndef TMINI_PARSER_H
#define TMINI_PARSER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_ring.h"
#include "tmini_status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define TMINI_PACKET_HEADER_SIZE 10u
#define TMINI_REPLY_HEADER_SIZE 7u
#define TMINI_SAMPLE_SIZE 3u

/* Samples accepted in a packet unless configured otherwise: the vendor's limit (section 9.6). */
#define TMINI_MAX_SAMPLES_DEFAULT 80u

/* Bytes of the largest packet with that many samples: the ring's window must hold one. */
#define TMINI_PACKET_SIZE_MAX(max_samples) \
    (TMINI_PACKET_HEADER_SIZE + TMINI_SAMPLE_SIZE * (max_samples))

/* The longest reply, device information. */
#define TMINI_REPLY_SIZE_MAX (TMINI_REPLY_HEADER_SIZE + 20u)

typedef enum {
    TMINI_FRAME_NONE, /* Nothing more can be told from the bytes received so far. */
    TMINI_FRAME_PACKET,
    TMINI_FRAME_REPLY,
} tmini_frame_t;

typedef enum {
    TMINI_REPLY_MODE_SINGLE = 0,
    TMINI_REPLY_MODE_CONTINUOUS = 1, /* Its length field is meaningless; the content follows on. */
} tmini_reply_mode_t;

/* The header by which an awaited reply is recognised (section 4). */
typedef struct {
    uint8_t type;
    uint8_t mode;   /* A tmini_reply_mode_t. */
    uint8_t length; /* Bytes of content; 0 and not compared when continuous. */
} tmini_reply_shape_t;

/* Running totals, modulo 2^32. Whatever arrives, every byte is in exactly one place:
 * bytes in = in packets + in replies + skipped + overrun + tmini_parser_pending(). */
typedef struct {
    uint32_t packets;
    uint32_t checksum_errors; /* Complete, plausible candidates whose checksum did not match. */
    uint32_t bytes_in_packets;
    uint32_t bytes_in_replies;
    uint32_t bytes_skipped; /* In no packet or reply; LastCRC bytes are among them. */
    uint32_t bytes_overrun; /* Refused by a full ring, or overwritten by DMA before being read. */
} tmini_parser_counters_t;

/* Treat the members as private. */
typedef struct {
    uint8_t max_samples;
    bool awaiting;
    bool hole_ahead; /* No frame from behind the hole has been delivered yet. */
    tmini_reply_shape_t awaited;
    uint8_t stray;                            /* The byte skipped last. */
    uint8_t header[TMINI_PACKET_HEADER_SIZE]; /* The candidate's, once it has come. */
    uint16_t need;  /* Bytes without which the candidate cannot be judged further. */
    uint16_t frame; /* Size of the frame delivered last, still at the ring's tail. */
    uint16_t gap;   /* Bytes lost or skipped since the last frame, at most UINT16_MAX. */
    tmini_ring_t *ring;
    size_t refused; /* How many of the ring's refused bytes have been counted. */
    size_t hole;    /* Where in the stream the last of them are missing. */
    tmini_parser_counters_t counters;
} tmini_parser_t;

/* Parses what arrives in `ring`, which must outlive the parser. `max_samples`: 1 to 255, or 0 for
 * the default. Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, or a ring whose window is
 * smaller than the largest packet or reply. */
tmini_status_t tmini_parser_init(tmini_parser_t *parser, tmini_ring_t *ring, uint8_t max_samples);

/* The next frame, or TMINI_FRAME_NONE. The frame lies at the ring's tail, where packet and reply
 * functions read it, until the next call gives it back. Bounded by the bytes in the ring: each is
 * looked at once, or once more for every false header before it whose packet would reach it. */
tmini_frame_t tmini_parser_next(tmini_parser_t *parser);

/* True while the frame delivered last is certainly as it was: call after reading its bytes. Only
 * DMA can make it false; then nothing that was read may be used. */
bool tmini_parser_frame_intact(const tmini_parser_t *parser);

/* From now on takes a reply of this shape; none when `shape` is null. It is copied. A delivered
 * reply ends the waiting. */
void tmini_parser_await(tmini_parser_t *parser, const tmini_reply_shape_t *shape);

/* Copies `count` bytes of the content of the reply delivered last. */
void tmini_parser_reply_content(const tmini_parser_t *parser, uint8_t *content, size_t count);

/* The bytes that wait in the ring for more to come. */
size_t tmini_parser_pending(const tmini_parser_t *parser);

/* No more bytes will come (silence, end of a recording): gives up the incomplete candidate by
 * skipping its first byte. Call tmini_parser_next() again, and both until nothing is pending.
 * Without a pending candidate it does nothing. */
void tmini_parser_abandon(tmini_parser_t *parser);

#ifdef __cplusplus
}
#endif

#endif
