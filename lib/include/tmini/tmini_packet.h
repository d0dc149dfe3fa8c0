/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * One valid scan packet (section 5): its header fields, and its samples as points.
 *
 * Pure integer arithmetic. Angles are in the protocol's own unit, 1/64 degree, clockwise seen from
 * above, 0 to 23039. Interpolated ones are the exact rational value rounded to nearest, halves up.
 *
 * A packet is a view of a frame's bytes: valid from tmini_packet_open() to the next
 * tmini_parser_next(), and only for the ring's consumer context. No function waits. */

#ifndef TMINI_PACKET_H
#define TMINI_PACKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A full circle in 1/64 degree. */
#define TMINI_FULL_CIRCLE_Q6 23040u

/** The angle from one direction clockwise to another; all in 1/64 degree, below a full circle. Any
 * context; no waiting. */
static inline uint16_t tmini_clockwise(uint16_t from_q6, uint16_t to_q6)
{
    return (uint16_t)(to_q6 + (to_q6 < from_q6 ? TMINI_FULL_CIRCLE_Q6 : 0) - from_q6);
}

/** What the lidar notes of a sample (section 5). Not trustworthy on every unit (section 9.9). */
typedef enum {
    TMINI_FLAG_SPECULAR = 2, /**< Interference by specular reflection. */
    TMINI_FLAG_AMBIENT = 3,  /**< Interference by ambient light. */
} tmini_flag_t;

/** Which flagged points lose their distance; they keep their place, intensity and flag. Combine
 * with |. */
typedef enum {
    TMINI_FILTER_NONE = 0,                            /**< None: all are kept as sent. */
    TMINI_FILTER_SPECULAR = 1 << TMINI_FLAG_SPECULAR, /**< Those with TMINI_FLAG_SPECULAR. */
    TMINI_FILTER_AMBIENT = 1 << TMINI_FLAG_AMBIENT,   /**< Those with TMINI_FLAG_AMBIENT. */
    TMINI_FILTER_BOTH = TMINI_FILTER_SPECULAR | TMINI_FILTER_AMBIENT, /**< Either. */
} tmini_filter_t;

/** One measurement; six bytes. */
typedef struct {
    uint16_t angle_q6;    /**< 1/64 degree, 0 to 23039, clockwise. */
    uint16_t distance_mm; /**< 1 to 16383; 0: no valid range, or filtered. */
    uint8_t intensity;    /**< 0 to 255. */
    uint8_t flag;         /**< 0 to 3, as sent: a tmini_flag_t or neither. */
} tmini_point_t;

/** The nearest that the lidar is made for, in millimetres (section 1). What lies outside may be
 * sent all the same. A distance of 0 is none of them: not "near" nor "free", but unknown. */
#define TMINI_RANGE_MIN_MM 50u
/** The farthest that the lidar is made for, in millimetres (section 1). */
#define TMINI_RANGE_MAX_MM 12000u

/** One valid packet, as a view of its frame. Members down to `gap` may be read. */
typedef struct {
    uint16_t first_angle_q6; /**< FSA, below 23040. */
    uint16_t last_angle_q6; /**< LSA, below 23040. Without meaning when count is 1 (section 9.6). */
    uint8_t ct;             /**< As sent: bit 0 start packet, bits 1 to 7 CT information. */
    uint8_t count;          /**< Samples: 1 to 255. */
    uint16_t gap;           /**< Bytes skipped before it, or TMINI_GAP_UNKNOWN: packets may be
                               * missing (bytes were lost, the line has paused, it came late). */
    uint32_t step;          /**< From sample to sample, in 1/64 degree / 2^17, rounded up. */
    const tmini_frame_t *frame; /**< Where its bytes lie. */
} tmini_packet_t;

/** Opens the packet that the parser has delivered as `frame` (TMINI_FRAME_PACKET), which it goes on
 * using. One division. */
void tmini_packet_open(tmini_packet_t *packet, const tmini_frame_t *frame);

/** True for the packet with which a revolution begins. */
static inline bool tmini_packet_is_start(const tmini_packet_t *packet)
{
    return (packet->ct & 1u) != 0;
}

/** Reads point `index`, from 0, unfiltered. Returns false, and then the point may not be used, if
 * `index` is not below count or DMA has overwritten the packet. */
bool tmini_packet_point(const tmini_packet_t *packet, size_t index, tmini_point_t *point);

/** Reads the first points, as many as the packet has and at most `max_points`, applying `filter` (a
 * combination of tmini_filter_t). Returns how many. tmini_frame_intact() then tells whether they
 * may be used. About 12 instructions a point on a Cortex-M4. */
size_t tmini_packet_points(const tmini_packet_t *packet, unsigned filter, tmini_point_t *points,
                           size_t max_points);

/** True if any sample has a distance other than 0. */
bool tmini_packet_has_range(const tmini_packet_t *packet);

#ifdef __cplusplus
}
#endif

#endif
