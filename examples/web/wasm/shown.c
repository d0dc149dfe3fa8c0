/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The scan that is shown: as received, and after the mounting is applied. */

#include "web.h"

#include <stdbool.h>
#include <string.h>

#include "tmini/tmini_mount.h"
#include "tmini/tmini_sectors.h"

#define SECTORS 8u
#define MASKED_MAX 8u

/* JavaScript reads points directly from memory. */
typedef char point_is_six_bytes[sizeof(tmini_point_t) == 6 ? 1 : -1];
typedef char angle_is_first[offsetof(tmini_point_t, angle_q6) == 0 ? 1 : -1];
typedef char distance_follows[offsetof(tmini_point_t, distance_mm) == 2 ? 1 : -1];
typedef char then_intensity[offsetof(tmini_point_t, intensity) == 4 ? 1 : -1];
typedef char then_flag[offsetof(tmini_point_t, flag) == 5 ? 1 : -1];

static struct {
    tmini_scan_t scan;
    tmini_point_t raw[WEB_SCAN_POINTS];
    tmini_point_t mounted[WEB_SCAN_POINTS];
    uint16_t nearest_mm[SECTORS];
    tmini_sectors_t sectors;
    tmini_sector_t held[SECTORS];
    const tmini_point_t *nearest;
    uint32_t valid;
    uint32_t flags[4]; /* Points with a distance, by their flags. */
    uint32_t farthest_mm;
    uint8_t darkest;
    uint8_t brightest;
    tmini_mount_t mount;
    tmini_arc_t masked[MASKED_MAX];
} shown;

static void look_at(const tmini_point_t *point)
{
    if (point->distance_mm == 0) {
        return;
    }
    shown.valid++;
    shown.flags[point->flag & 3u]++;
    if (shown.nearest == NULL || point->distance_mm < shown.nearest->distance_mm) {
        shown.nearest = point;
    }
    shown.farthest_mm =
        point->distance_mm > shown.farthest_mm ? point->distance_mm : shown.farthest_mm;
    shown.darkest = point->intensity < shown.darkest ? point->intensity : shown.darkest;
    shown.brightest = point->intensity > shown.brightest ? point->intensity : shown.brightest;
}

static void mount(void)
{
    shown.nearest = NULL;
    shown.valid = 0;
    memset(shown.flags, 0, sizeof shown.flags);
    shown.farthest_mm = 0;
    shown.darkest = UINT8_MAX;
    shown.brightest = 0;
    memcpy(shown.mounted, shown.raw, shown.scan.count * sizeof *shown.raw);
    shown.scan.points = shown.mounted;
    tmini_mount_step(&shown.mount, &shown.scan);
    for (size_t i = 0; i < shown.scan.count; i++) {
        look_at(&shown.mounted[i]);
    }
    (void)tmini_sectors_init(&shown.sectors, shown.held, SECTORS, TMINI_FILTER_NONE);
    tmini_sectors_add_scan(&shown.sectors, &shown.scan);
    for (size_t i = 0; i < SECTORS; i++) {
        shown.nearest_mm[i] = shown.held[i].nearest_mm;
    }
}

void shown_take(const tmini_scan_t *scan)
{
    shown.scan = *scan;
    memcpy(shown.raw, scan->points, scan->count * sizeof *scan->points);
    mount();
}

void shown_clear(void)
{
    memset(&shown.scan, 0, sizeof shown.scan);
    mount();
}

EXPORTED void shown_forget(void)
{
    shown_clear();
}

/* Sets how the lidar is mounted on the robot, and applies it at once to the scan that is shown. */
EXPORTED void shown_mount(int front_q6, uint32_t upside_down)
{
    shown.mount.front_q6 = (int16_t)front_q6;
    shown.mount.upside_down = upside_down != 0;
    mount();
}

/* Sets where the lidar sees the robot itself: `count` arcs in `transfer`. */
EXPORTED void shown_mask(uint32_t count)
{
    shown.mount.masked = shown.masked;
    shown.mount.masked_count = count < MASKED_MAX ? count : MASKED_MAX;
    memcpy(shown.masked, web_transfer, shown.mount.masked_count * sizeof *shown.masked);
}

EXPORTED const void *shown_points(void)
{
    return shown.mounted;
}

EXPORTED const void *shown_sectors(void)
{
    return shown.nearest_mm;
}

EXPORTED uint32_t shown_numbers(void)
{
    const tmini_point_t nobody = {0};
    const tmini_point_t *nearest = shown.nearest != NULL ? shown.nearest : &nobody;
    numbers_clear();
    numbers_put("points", shown.scan.count);
    numbers_put("valid", shown.valid);
    numbers_put("specular", shown.flags[TMINI_FLAG_SPECULAR]);
    numbers_put("ambient", shown.flags[TMINI_FLAG_AMBIENT]);
    numbers_put("flagged", shown.flags[TMINI_FLAG_SPECULAR] + shown.flags[TMINI_FLAG_AMBIENT]);
    numbers_put("dropped", shown.scan.dropped);
    numbers_put("packets", shown.scan.packets);
    numbers_put("gaps", shown.scan.gaps);
    numbers_put("checksumErrors", shown.scan.checksum_errors);
    numbers_put("frequencyChz", shown.scan.frequency_chz);
    numbers_put("complete", shown.scan.complete ? 1u : 0u);
    numbers_put("nearestMm", nearest->distance_mm);
    numbers_put("nearestQ6", nearest->angle_q6);
    numbers_put("nearestSector", (uint32_t)tmini_sectors_at(&shown.sectors, nearest->angle_q6));
    numbers_put("farthestMm", shown.farthest_mm);
    numbers_put("darkest", shown.darkest);
    numbers_put("brightest", shown.brightest);
    return numbers_count();
}
