/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: the nearest obstacle in each of a few sectors around the robot. Integers only; nothing
 * else in the library needs it.
 *
 *            0                 Sectors are equally wide and numbered clockwise, seen from above, as
 *        7   ^   1             the lidar's angles are. Sector 0 is centred on the front. With 8 of
 *          \ | /               them: 0 front, 1 front right, 2 right, 3 back right, 4 back,
 *      6 <-- L --> 2           5 back left, 6 left, 7 front left.
 *          / | \
 *        5   v   3             The front is angle 0 of the lidar unless init says otherwise: that
 *            4                 is for a lidar that is mounted turned.
 *
 * From a whole scan:
 *
 *     tmini_sectors_clear(&sectors);
 *     tmini_sectors_add_scan(&sectors, tmini_scan(&lidar));
 *     if (sectors.nearest_mm[0] != 0 && sectors.nearest_mm[0] < 300) { stop(); }
 *
 * Without a scan buffer, packet by packet (TMINI_EVENT_PACKET):
 *
 *     if (tmini_packet_is_start(packet)) {
 *         decide(&sectors);               a revolution is complete
 *         tmini_sectors_clear(&sectors);
 *     }
 *     tmini_sectors_add_packet(&sectors, packet);
 *
 * All functions: one context, the one that polls; no waiting. */

#ifndef TMINI_SECTORS_H
#define TMINI_SECTORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The nearest obstacle in each of some sectors. Members may be read. */
typedef struct {
    uint16_t *nearest_mm; /**< A distance for each sector; 0: nothing seen there. */
    uint16_t count;       /**< Sectors. */
    uint16_t front_q6;    /**< The lidar's angle that is the robot's front. */
    uint8_t filter;       /**< A combination of tmini_filter_t. */
} tmini_sectors_t;

/** Sets up `count` sectors, 1 to 65535, all clear. `nearest_mm` has room for so many, stays the
 * caller's and must outlive the sectors. `front_q6`: the lidar's angle that looks to the robot's
 * front, below TMINI_FULL_CIRCLE_Q6, in 1/64 degree; usually 0. `filter`: a combination of
 * tmini_filter_t, points to leave out; a scan may have been filtered already.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, count or front out of range, undefined
 * filter bits. */
tmini_status_t tmini_sectors_init(tmini_sectors_t *sectors, uint16_t *nearest_mm, size_t count,
                                  uint16_t front_q6, unsigned filter);

/** Forgets all obstacles: every sector becomes 0. */
void tmini_sectors_clear(tmini_sectors_t *sectors);

/** Takes a point. One whose distance is 0 is no obstacle. One division. */
void tmini_sectors_add(tmini_sectors_t *sectors, const tmini_point_t *point);

/** Takes all points of a scan. */
void tmini_sectors_add_scan(tmini_sectors_t *sectors, const tmini_scan_t *scan);

/** Takes all points of a packet. Returns false if DMA has overwritten some of them: those were not
 * taken. */
bool tmini_sectors_add_packet(tmini_sectors_t *sectors, const tmini_packet_t *packet);

/** The sector, 0 to count - 1, of an angle of the lidar in 1/64 degree, below
 * TMINI_FULL_CIRCLE_Q6. */
size_t tmini_sectors_at(const tmini_sectors_t *sectors, uint16_t angle_q6);

#ifdef __cplusplus
}
#endif

#endif
