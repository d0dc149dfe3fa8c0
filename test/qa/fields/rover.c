/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rover.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define HALL_MM 4000.0
#define RADIANS (3.14159265358979323846 / 180.0)

/* The step before the fields. */
static void disturb(const void *data, tmini_scan_t *scan)
{
    rover_t *const rover = *(rover_t *const *)data;
    for (size_t i = 0; i < scan->count; i++) {
        if (random_below(&rover->random, 100) < rover->config.random_percent) {
            scan->points[i].distance_mm = (uint16_t)random_between(&rover->random, 50, 12000);
        }
    }
}

static void need(bool is_so, const char *what)
{
    if (!is_so) {
        (void)fprintf(stderr, "rover: %s\n", what);
        abort();
    }
}

void rover_init(rover_t *rover, const rover_config_t *config, const tmini_fields_t *fields)
{
    static rover_t *self; /* One rover at a time: a step's data is constant. */
    bed_t *const bed = &rover->bed;
    sim_config_t sim = sim_default_config();
    self = rover;
    sim.seed = config->seed;
    rover->config = *config;
    rover->fields = fields;
    rover->list[0] = (tmini_one_step_t){disturb, &self};
    rover->list[1] = (tmini_one_step_t){tmini_fields_step, fields};
    rover->steps = (tmini_steps_t){rover->list, 2};
    random_seed(&rover->random, config->seed + 1);
    bed_prepare(bed);
    bed->config.frequency_chz = config->frequency_chz;
    bed->config.step = tmini_steps_step;
    bed->config.step_data = &rover->steps;
    need(tmini_fields_init(fields) == TMINI_OK, "these fields are refused");
    need(bed_init(bed, &sim), "the driver refuses its configuration");
    need(bed_start(bed) == TMINI_OK, "the driver does not start");
}

static double cosines[SIM_SCENE_ENTRIES]; /* Of the entries' angles: the scene is often made. */

static double nearer(double one, double other)
{
    return one < other ? one : other;
}

static double hall_at(const rover_hall_t *hall, unsigned entry)
{
    const double degrees = entry * SIM_SCENE_STEP_Q6 / 64.0;
    const double ahead = cosines[entry];
    const double aside = cosines[(entry + SIM_SCENE_ENTRIES / 4) % SIM_SCENE_ENTRIES];
    double distance = nearer(HALL_MM / fabs(ahead), HALL_MM / fabs(aside));
    if (hall->wall_mm > 0 && ahead > 0) {
        distance = nearer(distance, hall->wall_mm / ahead);
    }
    if (hall->pillar_mm > 0) {
        const double from_pillar = remainder(degrees - hall->pillar_deg, 360) * RADIANS;
        const double half = asin(hall->pillar_wide_mm / 2 / hall->pillar_mm);
        distance = fabs(from_pillar) <= half ? nearer(distance, hall->pillar_mm) : distance;
    }
    return distance;
}

void rover_furnish(rover_t *rover, const rover_hall_t *hall)
{
    if (cosines[0] == 0) {
        for (unsigned i = 0; i < SIM_SCENE_ENTRIES; i++) {
            cosines[i] = cos(i * SIM_SCENE_STEP_Q6 / 64.0 * RADIANS);
        }
    }
    for (unsigned i = 0; i < SIM_SCENE_ENTRIES; i++) {
        const double distance = hall_at(hall, i);
        rover->bed.sim.scene.distance_mm[i] = (uint16_t)(distance < 50 ? 0 : lround(distance));
    }
}

uint32_t rover_now_ms(rover_t *rover)
{
    return rover->bed.port.now_ms(&rover->bed);
}

bool rover_pass(rover_t *rover)
{
    const uint32_t scans = rover->bed.events[TMINI_EVENT_SCAN];
    bed_step(&rover->bed);
    if (tmini_faults(&rover->bed.lidar) != 0) {
        tmini_fields_clear(rover->fields);
    }
    return rover->bed.events[TMINI_EVENT_SCAN] != scans;
}
