/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_sectors.h"

tmini_status_t tmini_sectors_init(tmini_sectors_t *sectors, uint16_t *nearest_mm, size_t count,
                                  uint16_t front_q6, unsigned filter)
{
    if (sectors == NULL || nearest_mm == NULL || count == 0 || count > UINT16_MAX ||
        front_q6 >= TMINI_FULL_CIRCLE_Q6 || (filter & ~(unsigned)TMINI_FILTER_BOTH) != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    *sectors = (tmini_sectors_t){
        .nearest_mm = nearest_mm,
        .count = (uint16_t)count,
        .front_q6 = front_q6,
        .filter = (uint8_t)filter,
    };
    tmini_sectors_clear(sectors);
    return TMINI_OK;
}

void tmini_sectors_clear(tmini_sectors_t *sectors)
{
    for (size_t i = 0; i < sectors->count; i++) {
        sectors->nearest_mm[i] = 0;
    }
}

/* The angle from the front, in sectors, rounded to nearest: so sector 0 reaches as far to the left
 * as to the right. 2 * 23039 * 65535 + 23040 is below 2^32. */
size_t tmini_sectors_at(const tmini_sectors_t *sectors, uint16_t angle_q6)
{
    const uint32_t circle = TMINI_FULL_CIRCLE_Q6;
    const uint32_t from_front = tmini_clockwise(sectors->front_q6, angle_q6);
    const uint32_t sector = (2 * from_front * sectors->count + circle) / (2 * circle);
    return (size_t)(sector < sectors->count ? sector : 0);
}

void tmini_sectors_add(tmini_sectors_t *sectors, const tmini_point_t *point)
{
    if (point->distance_mm == 0 || ((unsigned)sectors->filter >> (point->flag & 3u) & 1u) != 0) {
        return;
    }
    uint16_t *const nearest_mm = &sectors->nearest_mm[tmini_sectors_at(sectors, point->angle_q6)];
    if (*nearest_mm == 0 || point->distance_mm < *nearest_mm) {
        *nearest_mm = point->distance_mm;
    }
}

void tmini_sectors_add_scan(tmini_sectors_t *sectors, const tmini_scan_t *scan)
{
    for (size_t i = 0; i < scan->count; i++) {
        tmini_sectors_add(sectors, &scan->points[i]);
    }
}

bool tmini_sectors_add_packet(tmini_sectors_t *sectors, const tmini_packet_t *packet)
{
    for (size_t i = 0; i < packet->count; i++) {
        tmini_point_t point;
        if (!tmini_packet_point(packet, i, &point)) {
            return false;
        }
        tmini_sectors_add(sectors, &point);
    }
    return true;
}
