/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "obstacle.h"

#define SECTOR_Q6 (TMINI_TURN_Q6 / OBSTACLE_SECTORS)
#define AHEAD 0u

/* The nearest point in each sector; the first sector is centred on straight ahead. */
static void find_nearest(const tmini_scan_t *scan, uint16_t nearest_mm[OBSTACLE_SECTORS])
{
    for (unsigned i = 0; i < OBSTACLE_SECTORS; i++) {
        nearest_mm[i] = 0;
    }
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        const unsigned sector = (point->angle_q6 + SECTOR_Q6 / 2) / SECTOR_Q6 % OBSTACLE_SECTORS;
        if (point->distance_mm != 0 &&
            (nearest_mm[sector] == 0 || point->distance_mm < nearest_mm[sector])) {
            nearest_mm[sector] = point->distance_mm;
        }
    }
}

void obstacle_see(obstacle_t *obstacle, const tmini_scan_t *scan, uint32_t now_ms)
{
    find_nearest(scan, obstacle->nearest_mm);
    const uint16_t ahead_mm = obstacle->nearest_mm[AHEAD];
    if (ahead_mm != 0 && ahead_mm < OBSTACLE_STOP_MM) {
        obstacle->clear = false;
    } else if (scan->complete && (ahead_mm == 0 || ahead_mm >= OBSTACLE_GO_MM)) {
        obstacle->clear = true;
    }
    if (scan->complete) {
        obstacle->seeing = true;
        obstacle->seen_ms = now_ms;
    }
}

void obstacle_blind(obstacle_t *obstacle)
{
    obstacle->clear = false;
    obstacle->seeing = false;
}

bool obstacle_may_move(const obstacle_t *obstacle, uint32_t now_ms)
{
    return obstacle->clear && obstacle->seeing && now_ms - obstacle->seen_ms < OBSTACLE_BLIND_MS;
}
