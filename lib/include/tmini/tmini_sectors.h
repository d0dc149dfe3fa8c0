/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: the nearest obstacle in each of a few sectors around the robot. Integers only; nothing
 * else in the library needs it.
 *
 *            0                 Sectors are equally wide and numbered clockwise, seen from above, as
 *        7   ^   1             the lidar's angles are. Sector 0 is centred on the front: angle 0 of
 *          \ | /               the lidar, or what tmini_mount.h says. With 8 of them: 0 front,
 *      6 <-- L --> 2           1 front right, 2 right, 3 back right, 4 back, 5 back left,
 *          / | \               6 left, 7 front left.
 *        5   v   3
 *            4
 *
 * From whole scans:
 *
 *     tmini_sectors_add_scan(&sectors, tmini_scan(&lidar));
 *     if (!tmini_sector_is_free(&sectors.sectors[0], 300)) { stop(); }
 *
 * Without a scan buffer, packet by packet (TMINI_EVENT_PACKET):
 *
 *     if (tmini_sectors_add_packet(&sectors, tmini_packet(&lidar))) {
 *         if (!tmini_sector_is_free(&sectors.sectors[0], 300)) { stop(); }
 *     }
 *
 * A lidar that is lost brings no scans, and the sectors keep what they had. TMINI_EVENT_LOST comes
 * after a second only, and the state is TMINI_STATE_SCANNING again before the first new scan. So,
 * each time round the loop, also stop unless that is the state, tmini_faults() is 0 and the last
 * complete scan is younger than half a second; and clear the sectors when the lidar is lost and
 * before each start.
 *
 * A sector without a single valid range is blind, not free: a covered lidar, a lost packet, but
 * also open space beyond 12 m. Its nearest_mm is 0, which is less than any limit. All functions:
 * one context, the one that polls; no waiting. */

#ifndef TMINI_SECTORS_H
#define TMINI_SECTORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One sector. */
typedef struct {
    uint16_t nearest_mm; /**< The nearest range; 0: blind, there is none. */
    uint16_t angle_q6;   /**< Where it is, in 1/64 degree. */
    uint16_t points;     /**< All points in the sector, */
    uint16_t ranges;     /**< and those of them that have a range. */
} tmini_sector_t;

/** Sectors around the robot. Members may be read. */
typedef struct {
    tmini_sector_t *sectors; /**< The caller's, */
    uint16_t count;          /**< of which there are this many. */
    uint8_t filter;          /**< A combination of tmini_filter_t. */
    bool has_begun;          /**< A start packet has come: what is added belongs to a revolution. */
    bool has_ended;          /**< It has ended: the next packet belongs to another, */
    tmini_point_t first;     /**< as does this point, of the start packet. */
} tmini_sectors_t;

/** Sets up `count` sectors, 1 to 65535, all blind. `array` has room for them, stays the caller's
 * and must outlive the sectors. `filter`: a combination of tmini_filter_t, points whose range is
 * not to count; a scan may have been filtered already.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, count out of range, undefined filter
 * bits. */
tmini_status_t tmini_sectors_init(tmini_sectors_t *sectors, tmini_sector_t *array, size_t count,
                                  unsigned filter);

/** Forgets all points: every sector becomes blind. */
void tmini_sectors_clear(tmini_sectors_t *sectors);

/** Adds a point. One division. */
void tmini_sectors_add(tmini_sectors_t *sectors, const tmini_point_t *point);

/** Takes all points of a scan, in the place of what was there. */
void tmini_sectors_add_scan(tmini_sectors_t *sectors, const tmini_scan_t *scan);

/** Takes all points of a packet, but those that DMA has overwritten. Returns true if it is the
 * start packet that ends a revolution: the sectors hold that one until the next packet is added.
 * What was lost of it is blind; what precedes the first start packet is no revolution. */
bool tmini_sectors_add_packet(tmini_sectors_t *sectors, const tmini_packet_t *packet);

/** The sector, 0 to count - 1, of an angle in 1/64 degree, below TMINI_FULL_CIRCLE_Q6. */
size_t tmini_sectors_at(const tmini_sectors_t *sectors, uint16_t angle_q6);

/** True if there is no range at all in the sector: what is there is unknown. */
static inline bool tmini_sector_is_blind(const tmini_sector_t *sector)
{
    return sector->ranges == 0;
}

/** True if the sector is seen, and nothing in it is nearer than `distance_mm`. What is missing of a
 * scan that is not complete may be the obstacle: then it is a reason to stop, not to go on. */
static inline bool tmini_sector_is_free(const tmini_sector_t *sector, uint16_t distance_mm)
{
    return sector->ranges > 0 && sector->nearest_mm >= distance_mm;
}

#ifdef __cplusplus
}
#endif

#endif
