/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * The room around the simulated lidar: 5 m x 4 m, with boxes, a pillar, a doorway into a corridor
 * and a window that gives no range, as a table of distances by angle. Integer arithmetic only, so
 * that every machine computes the same distances.
 */

#ifndef SCENE_H
#define SCENE_H

#include <stdint.h>

/* One entry per 1/16 degree: samples are at least 0.5 degrees apart, and the table stays small
 * enough for a microcontroller and for a processor's first cache. */
#define SIM_SCENE_STEP_Q6 4u
#define SIM_SCENE_ENTRIES 5760u

typedef struct {
    uint16_t distance_mm[SIM_SCENE_ENTRIES]; /* 0: no range */
} sim_scene_t;

/* The room, without obstacles. */
void sim_scene_build(sim_scene_t *scene);

/* Places an obstacle: `width_q6` wide, centred on `angle_q6` (0..23039, 1/64 degree), at
 * `distance_mm`. Nearer objects hide it. */
void sim_scene_place(sim_scene_t *scene, uint16_t angle_q6, uint16_t width_q6,
                     uint16_t distance_mm);

#endif
