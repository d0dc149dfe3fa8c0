/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "obstacle.h"

#define AHEAD 0u

void obstacle_init(obstacle_t *obstacle)
{
    *obstacle = (obstacle_t){0};
    (void)tmini_sectors_init(&obstacle->sectors, obstacle->nearest_mm, OBSTACLE_SECTORS, 0,
                             TMINI_FILTER_NONE);
}

void obstacle_see(obstacle_t *obstacle, const tmini_scan_t *scan, uint32_t now_ms)
{
    tmini_sectors_clear(&obstacle->sectors);
    tmini_sectors_add_scan(&obstacle->sectors, scan);
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
