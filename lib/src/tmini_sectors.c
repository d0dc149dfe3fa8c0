/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_sectors.h"

#include "tmini_bins.h"

tmini_status_t tmini_sectors_init(tmini_sectors_t *sectors, tmini_sector_t *array, size_t count,
                                  unsigned filter)
{
    if (sectors == NULL || array == NULL || count == 0 || count > UINT16_MAX ||
        (filter & ~(unsigned)TMINI_FILTER_BOTH) != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    *sectors =
        (tmini_sectors_t){.sectors = array, .count = (uint16_t)count, .filter = (uint8_t)filter};
    tmini_sectors_clear(sectors);
    return TMINI_OK;
}

void tmini_sectors_clear(tmini_sectors_t *sectors)
{
    sectors->has_ended = false;
    for (size_t i = 0; i < sectors->count; i++) {
        sectors->sectors[i] = (tmini_sector_t){0};
    }
}

size_t tmini_sectors_at(const tmini_sectors_t *sectors, uint16_t angle_q6)
{
    return tmini_bin(angle_q6, sectors->count);
}

static void count_point(uint16_t *count)
{
    *count = (uint16_t)(*count + (*count < UINT16_MAX ? 1 : 0));
}

void tmini_sectors_add(tmini_sectors_t *sectors, const tmini_point_t *point)
{
    tmini_sector_t *const sector = &sectors->sectors[tmini_sectors_at(sectors, point->angle_q6)];
    const bool is_filtered = ((unsigned)sectors->filter >> (point->flag & 3u) & 1u) != 0;
    count_point(&sector->points);
    if (point->distance_mm == 0 || is_filtered) {
        return;
    }
    count_point(&sector->ranges);
    if (tmini_is_nearer(point, sector->nearest_mm)) {
        sector->nearest_mm = point->distance_mm;
        sector->angle_q6 = point->angle_q6;
    }
}

void tmini_sectors_add_scan(tmini_sectors_t *sectors, const tmini_scan_t *scan)
{
    tmini_sectors_clear(sectors);
    for (size_t i = 0; i < scan->count; i++) {
        tmini_sectors_add(sectors, &scan->points[i]);
    }
}

/* The start packet that ended the last revolution holds the first point of this one. */
static void begin_sweep(tmini_sectors_t *sectors)
{
    const tmini_point_t first = sectors->first;
    tmini_sectors_clear(sectors);
    tmini_sectors_add(sectors, &first);
}

bool tmini_sectors_add_packet(tmini_sectors_t *sectors, const tmini_packet_t *packet)
{
    tmini_point_t point;
    if (sectors->has_ended) {
        begin_sweep(sectors);
    }
    if (tmini_packet_is_start(packet)) {
        const bool is_whole = sectors->has_begun;
        if (!tmini_packet_point(packet, 0, &sectors->first)) {
            sectors->first = (tmini_point_t){0}; /* DMA has overwritten it: no range. */
        }
        sectors->has_begun = true;
        sectors->has_ended = true;
        return is_whole;
    }
    for (size_t i = 0; tmini_packet_point(packet, i, &point); i++) {
        tmini_sectors_add(sectors, &point);
    }
    return false;
}
