/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * One valid scan packet (section 5): its header fields, and its samples as points.
 *
 * Pure integer arithmetic. Angles are in the protocol's own unit, 1/64 degree, clockwise seen from
 * above, 0 to 23039. Interpolated angles are the exact rational value, rounded to nearest, halves
 * up.
 *
 * A packet is a view of a frame's bytes: valid from tmini_packet_open() to the next
 * tmini_parser_next(), and only for the ring's consumer context. No function waits. */

#ifndef TMINI_PACKET_H
#define TMINI_PACKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "../tmini_types.h"
#include "tmini_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Opens the packet that the parser has delivered as `frame` (TMINI_FRAME_PACKET). The packet
 * refers to `frame` from then on. One division. */
void tmini_packet_open(tmini_packet_t *packet, const tmini_frame_t *frame);

/** True if packets may be missing when `bytes` were skipped before the packet. One byte before a
 * start packet is LastCRC, or noise (section 7). */
static inline bool tmini_packet_misses(const tmini_packet_t *packet, uint16_t bytes)
{
    const unsigned may_be_last_crc = packet->ct & 1u; /* Of a start packet. */
    return bytes > may_be_last_crc;
}

#ifdef __cplusplus
}
#endif

#endif
