/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rover.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define HALL_MM 4000.0
#define RADIANS (3.14159265358979323846 / 180.0)

static bed_t bed;
static const tmini_fields_t *all_fields;
random_t rover_random;

/* The step before the fields. */
static void disturb(const void *data, tmini_scan_t *scan)
{
    const rover_config_t *const config = data;
    for (size_t i = 0; i < scan->count; i++) {
        if (random_below(&rover_random, 100) < config->random_percent) {
            scan->points[i].distance_mm = (uint16_t)random_between(&rover_random, 50, 12000);
        }
    }
}

void rover_init(const rover_config_t *config, const tmini_fields_t *fields)
{
    static tmini_one_step_t list[2];
    static const tmini_steps_t steps = {list, 2};
    sim_config_t sim = sim_default_config();
    sim.seed = config->seed;
    all_fields = fields;
    list[0] = (tmini_one_step_t){disturb, config};
    list[1] = (tmini_one_step_t){tmini_fields_step, fields};
    random_seed(&rover_random, config->seed + 1);
    bed_prepare(&bed);
    bed.config.frequency_chz = config->frequency_chz;
    bed.config.step = tmini_steps_step;
    bed.config.step_data = &steps;
    if (tmini_fields_init(fields) != TMINI_OK || !bed_init(&bed, &sim) ||
        bed_start(&bed) != TMINI_OK) {
        (void)fprintf(stderr, "rover: these fields, or this configuration, are refused\n");
        abort();
    }
}

static double cosines[SIM_SCENE_ENTRIES]; /* Of the entries' angles: the scene is often made. */

static double hall_at(const rover_hall_t *hall, unsigned entry)
{
    const double degrees = entry * SIM_SCENE_STEP_Q6 / 64.0;
    const double ahead = cosines[entry];
    const double aside = cosines[(entry + SIM_SCENE_ENTRIES / 4) % SIM_SCENE_ENTRIES];
    double distance = fmin(HALL_MM / fabs(ahead), HALL_MM / fabs(aside));
    if (hall->wall_mm > 0 && ahead > 0) {
        distance = fmin(distance, hall->wall_mm / ahead);
    }
    if (hall->pillar_mm > 0) {
        const double from_pillar = remainder(degrees - hall->pillar_deg, 360) * RADIANS;
        const double half = asin(hall->pillar_wide_mm / 2 / hall->pillar_mm);
        distance = fabs(from_pillar) <= half ? fmin(distance, hall->pillar_mm) : distance;
    }
    return distance;
}

void rover_furnish(const rover_hall_t *hall)
{
    if (cosines[0] == 0) {
        for (unsigned i = 0; i < SIM_SCENE_ENTRIES; i++) {
            cosines[i] = cos(i * SIM_SCENE_STEP_Q6 / 64.0 * RADIANS);
        }
    }
    for (unsigned i = 0; i < SIM_SCENE_ENTRIES; i++) {
        const double distance = hall_at(hall, i);
        bed.sim.scene.distance_mm[i] = (uint16_t)(distance < 50 ? 0 : lround(distance));
    }
}

uint32_t rover_now_ms(void)
{
    return bed.port.now_ms(&bed);
}

bool rover_pass(void)
{
    const uint32_t scans = bed.events[TMINI_EVENT_SCAN];
    bed_step(&bed);
    if (tmini_faults(&bed.lidar) != 0) {
        tmini_fields_clear(all_fields);
    }
    return bed.events[TMINI_EVENT_SCAN] != scans;
}
