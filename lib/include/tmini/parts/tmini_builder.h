/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Scans: collects the points of one revolution in the caller's buffer (section 6).
 *
 * A scan runs from a start packet to the next one. Packets before the first start packet belong to
 * no scan; after it each packet is in exactly one. A scan never joins packets that are known to be
 * of different revolutions. Two things end a scan early:
 *
 *   - A lost start packet. The angle swept since the last one shows the loss: the scan ends after a
 *     full circle. (The start angle is not 0 on every unit, section 9.8.)
 *   - A gap that may hold half a turn or more, because any number of turns may then be missing. The
 *     number of skipped bytes shows it, or the angle; or the caller reports it: after a pause of
 *     the line or an overflow, the packet's gap is TMINI_GAP_UNKNOWN.
 *
 * The next scan then has no start packet and is never complete. It ends at the next start packet
 * or, if that is lost too, at the angle of the last one that came.
 *
 * A scan that took more than one and a half turns, at the frequency that the lidar reports, has a
 * gap: if its angles join, at least one whole turn is missing.
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

/** A scan in progress. Treat the members as private, except `scan` and `late_scans`. */
typedef struct {
    bool open;                  /**< A scan is in progress. */
    bool ended;                 /**< A scan has ended: the packet that ended it has to be added
                                 * again. */
    uint8_t filter;             /**< A combination of tmini_filter_t. */
    uint16_t capacity;          /**< Size of the buffer in points. */
    uint16_t previous_angle_q6; /**< Where the last packet ended. */
    uint16_t origin_q6;         /**< The angle of the last start packet; UINT16_MAX: none has
                                 * come. */
    uint16_t late_ms;           /**< By how much the scan's start_ms may be late. */
    uint16_t next_late_ms;      /**< By how much the next packet's time may be late. */
    int16_t swept_q6;           /**< Angle swept since the origin; jitter may make it negative, by 4
                                 * degrees at most. */
    uint32_t late_scans;        /**< Scans that ended early or are incomplete because of time
                                 * alone. */
    tmini_scan_t scan; /**< The scan so far; its `checksum_errors` count when it has ended. */
} tmini_builder_t;

/** Sets up a builder that collects points in `buffer`, which has room for `capacity` points, stays
 * the caller's and must outlive the builder. It applies `filter`, a combination of tmini_filter_t.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, capacity 0 or above 65535, undefined
 * filter bits. */
tmini_status_t tmini_builder_init(tmini_builder_t *builder, tmini_point_t *buffer, size_t capacity,
                                  unsigned filter);

/** The next scan is collected in `points`, a buffer of the same capacity. Call it only when a scan
 * has just ended. */
static inline void tmini_builder_use(tmini_builder_t *builder, tmini_point_t *points)
{
    builder->scan.points = points;
}

/** Forgets the scan in progress and the angle at which revolutions begin. The next scan begins with
 * the next start packet. */
void tmini_builder_discard(tmini_builder_t *builder);

/** The times of packets added from now on may be up to `late_ms` late, because their bytes may have
 * waited. So a scan that begins with such a packet may have taken that much longer. This decides
 * whether it is complete; its stamps stay as they are. */
static inline void tmini_builder_backdate(tmini_builder_t *builder, uint16_t late_ms)
{
    builder->next_late_ms = late_ms;
}

/** Adds `packet`, which came at `now_ms`, to the scan in progress, or begins a scan with it. If the
 * packet does not belong to the scan in progress, that scan ends and the function returns true:
 * builder->scan is then valid until you add the same packet again. If the times are unknown, pass
 * the same `now_ms` at each call. A packet that DMA has overwritten meanwhile leaves a gap, never a
 * wrong point. */
bool tmini_builder_add(tmini_builder_t *builder, const tmini_packet_t *packet, uint32_t now_ms);

/** Notes that a packet of the scan in progress was lost, as a wrong LastCRC proves (section 7): the
 * scan has a gap and is not complete. Call it before you add the start packet that ends the
 * scan. */
void tmini_builder_refute(tmini_builder_t *builder);

#ifdef __cplusplus
}
#endif

#endif
