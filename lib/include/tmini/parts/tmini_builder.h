/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Scans: the packets of one revolution gathered in the caller's buffer (section 6).
 *
 * A scan runs from a start packet to the next one. What precedes the first start packet is no scan;
 * after it each packet is in exactly one. Packets that can be known to be of two revolutions never
 * meet. If a start packet is lost, the angle swept since the last one shows it: the scan is closed
 * when it has turned full circle. (The start angle is not 0 on every unit, section 9.8.) A gap that
 * may hold half a turn or more, by bytes, by angle, or because the caller says so (a pause of the
 * line, an overflow: the packet's gap is TMINI_GAP_UNKNOWN), closes it as well: any number of turns
 * may be missing. What follows is a scan without a beginning, never complete: it ends with the next
 * start packet, or where that would be, by the angle of the last one that came.
 *
 * A scan that took more than one and a half turns, by the frequency that the lidar reports, has a
 * gap: two revolutions that join without a seam are whole turns apart.
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

/** A scan under way. Treat the members as private, but for `scan` and `late_scans`. */
typedef struct {
    uint8_t filter;             /**< A combination of tmini_filter_t. */
    bool open;                  /**< A scan is under way. */
    bool ended;                 /**< One was finished: the packet that ended it is to come again. */
    uint16_t capacity;          /**< Points that the buffer has room for. */
    uint16_t previous_angle_q6; /**< Where the last packet ended. */
    uint16_t origin_q6;         /**< Where the last start packet was; UINT16_MAX: none has come. */
    uint16_t late_ms;           /**< How much earlier the scan may have begun, */
    uint16_t next_late_ms;      /**< or the next packet may have come. */
    int16_t swept_q6;           /**< Angle swept since the origin: from -4 degrees on. */
    uint32_t late_scans;        /**< Ended, or not complete, because of time alone. */
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

/** Forgets the scan under way and where revolutions begin: nothing is a scan until the next start
 * packet. */
void tmini_builder_discard(tmini_builder_t *builder);

/** The packets added from now on may have come up to `late_ms` earlier than is said, because their
 * bytes may have waited: a scan that begins with one took so much longer at most, as far as it
 * matters for its being complete. */
static inline void tmini_builder_backdate(tmini_builder_t *builder, uint16_t late_ms)
{
    builder->next_late_ms = late_ms;
}

/** Adds `packet`, which came at `now_ms`, to the scan under way, or begins one. If it does not
 * belong to the scan under way, finishes that instead and returns true: builder->scan is then valid
 * until the same packet is added again. Where there is no time, `now_ms` is the same at each call.
 * A packet that DMA overwrote meanwhile leaves a gap, never a wrong point. */
bool tmini_builder_add(tmini_builder_t *builder, const tmini_packet_t *packet, uint32_t now_ms);

/** Something outside the packets proves that one of the scan under way was lost (LastCRC, section
 * 7): it has a gap and is not complete. Call it before adding the packet that shows it. */
void tmini_builder_refute(tmini_builder_t *builder);

#ifdef __cplusplus
}
#endif

#endif
