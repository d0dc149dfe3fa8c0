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
 *     static tmini_sector_t memory[8];
 *     static tmini_sectors_t sectors;
 *
 *     (void)tmini_sectors_init(&sectors, memory, 8, TMINI_FILTER_NONE);      once
 *     ...
 *     tmini_sectors_add_scan(&sectors, tmini_scan(&lidar));
 *     if (!tmini_sector_is_free(&sectors.sectors[0], 300)) { stop(); }
 *     else if (tmini_scan(&lidar)->complete) { go(); }
 *
 * Any scan may stop the robot, but only a complete one may let it go on: in a damaged one the
 * obstacle may be missing.
 *
 * Without a scan buffer, packet by packet (TMINI_EVENT_PACKET):
 *
 *     if (tmini_sectors_add_packet(&sectors, tmini_packet(&lidar))) {
 *         if (!tmini_sector_is_free(&sectors.sectors[0], 300)) { stop(); }
 *     }
 *
 * Sectors do not age, and a lost lidar delivers no scans. So, in each round of the loop, also stop
 * if tmini_scan_age_ms() is above 300 (three turns at 10 Hz) or tmini_faults() is not 0. Clear the
 * sectors when the lidar is lost and before each start. Fields (tmini_fields.h) do all this, and
 * have the robot's shape.
 *
 * A sector without a valid range is blind, not free: the lidar may be covered, a packet lost, or
 * the space open for more than 12 m. Its nearest_mm is 0, which is below any limit. All functions:
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
    uint16_t nearest_mm; /**< The nearest range; 0: there is none (blind). */
    uint16_t angle_q6;   /**< The angle of that range, in 1/64 degree. */
    uint16_t points;     /**< All points in the sector, at most 65535. */
    uint16_t ranges;     /**< Those of them that have a range, at most 65535. */
} tmini_sector_t;

/** Sectors around the robot. Members may be read. */
typedef struct {
    tmini_sector_t *sectors; /**< The caller's array. */
    uint16_t count;          /**< How many sectors it has. */
    uint8_t filter;          /**< A combination of tmini_filter_t. */
    bool has_begun;          /**< A start packet has come: points belong to a revolution. */
    bool has_ended;          /**< That revolution has ended: the next packet belongs to another. */
    tmini_point_t first;     /**< The point of the start packet: it belongs to the next
                              * revolution. */
} tmini_sectors_t;

/** Sets up `count` sectors, 1 to 65535, all blind. `array` has room for them, stays the caller's
 * and must outlive the sectors. `filter`: a combination of tmini_filter_t; the range of such points
 * does not count. A scan may have been filtered already.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, count out of range, undefined filter
 * bits. */
tmini_status_t tmini_sectors_init(tmini_sectors_t *sectors, tmini_sector_t *array, size_t count,
                                  unsigned filter);

/** Forgets all points: every sector becomes blind. */
void tmini_sectors_clear(tmini_sectors_t *sectors);

/** Adds a point. One division. */
void tmini_sectors_add(tmini_sectors_t *sectors, const tmini_point_t *point);

/** Clears the sectors and adds all points of a scan. */
void tmini_sectors_add_scan(tmini_sectors_t *sectors, const tmini_scan_t *scan);

/** Adds all points of a packet, except those that DMA has overwritten. Returns true if the packet
 * is a start packet that ends a revolution; the sectors hold this revolution until the next packet
 * is added. Lost parts of it are blind; but if a start packet is lost, the revolutions before and
 * after it are held together, and a lost part of the later one may show ranges of the earlier one.
 * Packets before the first start packet belong to no revolution. */
bool tmini_sectors_add_packet(tmini_sectors_t *sectors, const tmini_packet_t *packet);

/** The sector, 0 to count - 1, of an angle in 1/64 degree, below TMINI_FULL_CIRCLE_Q6. */
size_t tmini_sectors_at(const tmini_sectors_t *sectors, uint16_t angle_q6);

/** True if the sector has no range: whether it is free is unknown. */
static inline bool tmini_sector_is_blind(const tmini_sector_t *sector)
{
    return sector->ranges == 0;
}

/** True if the sector is not blind, and nothing in it is nearer than `distance_mm`. If the scan is
 * not complete, the obstacle may be in the missing part: trust the answer "not free", but not
 * "free". */
static inline bool tmini_sector_is_free(const tmini_sector_t *sector, uint16_t distance_mm)
{
    return sector->ranges > 0 && sector->nearest_mm >= distance_mm;
}

#ifdef __cplusplus
}
#endif

#endif
