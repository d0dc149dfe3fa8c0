/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Scans: the packets of one revolution gathered in the caller's buffer (section 6).
 *
 * A scan runs from a start packet to the next one. What precedes the first start packet is no scan.
 * Packets that can be told to be of two revolutions never meet. If a start packet is lost, the
 * angle swept since the last one tells: the scan is closed when it has turned full circle, and what
 * follows waits for the next start packet. (The start angle is not 0 on every unit, section 9.8.) A
 * gap that may hold half a turn or more, by bytes, by angle, or because the caller says so (a pause
 * of the line, an overflow: the packet's gap is TMINI_GAP_UNKNOWN), closes it as well: any number
 * of turns may be missing.
 *
 * All functions: one context, the one that parses; no waiting. */

#ifndef TMINI_BUILDER_H
#define TMINI_BUILDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_packet.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A scan under way. Treat the members as private, but for `scan` as documented below. */
typedef struct {
    uint8_t filter;             /**< A combination of tmini_filter_t. */
    bool open;                  /**< A scan is under way. */
    uint16_t capacity;          /**< Points that the buffer has room for. */
    uint16_t previous_angle_q6; /**< Where the last packet ended. */
    uint16_t errors_before;     /**< The parser's checksum errors when it began, modulo 2^16. */
    int16_t swept_q6;           /**< Angle swept since the start packet: -4 to 360.25 degrees. */
    tmini_scan_t scan;          /**< What there is of it. */
} tmini_builder_t;

/** Gathers into `buffer`, which has room for `capacity` points and stays the caller's; applies
 * `filter`, a combination of tmini_filter_t. Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null
 * pointer, capacity 0 or above 65535, undefined filter bits. */
tmini_status_t tmini_builder_init(tmini_builder_t *builder, tmini_point_t *buffer, size_t capacity,
                                  unsigned filter);

/** The next scan is to be gathered in `points`, of the same capacity. For a builder whose scan has
 * just been finished. */
static inline void tmini_builder_use(tmini_builder_t *builder, tmini_point_t *points)
{
    builder->scan.points = points;
}

/** Forgets the scan under way: what comes next does not continue it. */
void tmini_builder_discard(tmini_builder_t *builder);

/** Adds `packet`, which came at `now_ms`, to the scan under way; a start packet begins one. If it
 * no longer belongs to the scan under way, finishes that instead and returns true: builder->scan is
 * then valid until the same packet is added again. A packet that DMA overwrote meanwhile leaves a
 * gap, never a wrong point. */
bool tmini_builder_add(tmini_builder_t *builder, const tmini_packet_t *packet, uint32_t now_ms);

/** Something outside the packets proves that one of the scan under way was lost (LastCRC, section
 * 7): it has a gap and is not complete. Call it before adding the packet that shows it. */
void tmini_builder_refute(tmini_builder_t *builder);

#ifdef __cplusplus
}
#endif

#endif
