/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "obstacle.h"

#define AHEAD 0

/* True if nothing is seen in any direction: the window is covered or the rotor blocked. */
static bool is_dark(const obstacle_t *obstacle)
{
    for (unsigned i = 0; i < OBSTACLE_SECTORS; i++) {
        if (!tmini_sector_is_blind(&obstacle->sectors[i])) {
            return false;
        }
    }
    return true;
}

void obstacle_see(obstacle_t *obstacle, const tmini_scan_t *scan)
{
    const tmini_sector_t *const ahead = &obstacle->sectors[AHEAD];
    tmini_sectors_t sectors;
    (void)tmini_sectors_init(&sectors, obstacle->sectors, OBSTACLE_SECTORS, TMINI_FILTER_NONE);
    tmini_sectors_add_scan(&sectors, scan);
    if (is_dark(obstacle)) {
        obstacle_blind(obstacle);
        return;
    }
    if (!tmini_sector_is_free(ahead, OBSTACLE_STOP_MM)) {
        obstacle->clear = false;
    } else if (scan->complete && tmini_sector_is_free(ahead, OBSTACLE_GO_MM)) {
        obstacle->clear = true;
    }
    if (scan->complete) {
        obstacle->seeing = true;
        obstacle->seen_ms = scan->end_ms;
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
