/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "obstacle.h"

static const tmini_xy_t boxes[2][2] = {
    {{0, -OBSTACLE_ASIDE_MM}, {OBSTACLE_STOP_MM, OBSTACLE_ASIDE_MM}},
    {{0, -OBSTACLE_ASIDE_MM}, {OBSTACLE_GO_MM, OBSTACLE_ASIDE_MM}},
};

static tmini_fields_t fields_of(obstacle_t *obstacle)
{
    return (tmini_fields_t){.list = obstacle->fields, .count = 2};
}

/* With the first scan. */
static void set_up(obstacle_t *obstacle)
{
    const tmini_fields_t fields = fields_of(obstacle);
    for (size_t i = 0; i < 2; i++) {
        obstacle->fields[i].corners = boxes[i];
        obstacle->fields[i].corner_count = 2;
        obstacle->fields[i].max_age_ms = OBSTACLE_BLIND_MS;
    }
    (void)tmini_fields_init(&fields); /* If they were refused, they would stay blind. */
}

void obstacle_see(obstacle_t *obstacle, const tmini_scan_t *scan)
{
    const tmini_fields_t fields = fields_of(obstacle);
    tmini_sectors_t sectors;
    if (obstacle->fields[0].corners == NULL) {
        set_up(obstacle);
    }
    tmini_fields_add_scan(&fields, scan);
    (void)tmini_sectors_init(&sectors, obstacle->sectors, OBSTACLE_SECTORS, TMINI_FILTER_NONE);
    tmini_sectors_add_scan(&sectors, scan);
}

void obstacle_blind(obstacle_t *obstacle)
{
    const tmini_fields_t fields = fields_of(obstacle);
    tmini_fields_clear(&fields);
}

bool obstacle_may_move(obstacle_t *obstacle, uint32_t now_ms)
{
    tmini_field_t *const needed = &obstacle->fields[obstacle->moves ? 0 : 1];
    obstacle->moves = tmini_field_state(needed, now_ms) == TMINI_FIELD_FREE;
    return obstacle->moves;
}
