/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rover.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define HALL_MM 4000.0
#define RADIANS (3.14159265358979323846 / 180.0)

static int write_port(void *context, const uint8_t *bytes, size_t count)
{
    rover_t *const rover = context;
    sim_receive(&rover->sim, bytes, count, rover->now_us);
    return (int)count;
}

uint32_t rover_now_ms(const rover_t *rover)
{
    return (uint32_t)(rover->now_us / 1000u);
}

static uint32_t now_ms(void *context)
{
    return rover_now_ms(context);
}

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
    sim_config_t sim = sim_default_config();
    self = rover;
    sim.seed = config->seed;
    rover->config = *config;
    rover->fields = fields;
    rover->now_us = 0;
    rover->scans = 0;
    rover->port = (tmini_port_t){.write = write_port, .now_ms = now_ms};
    rover->list[0] = (tmini_one_step_t){disturb, &self};
    rover->list[1] = (tmini_one_step_t){tmini_fields_step, fields};
    rover->steps = (tmini_steps_t){rover->list, 2};
    random_seed(&rover->random, config->seed + 1);
    sim_init(&rover->sim, &sim);
    need(tmini_fields_init(fields) == TMINI_OK, "these fields are refused");
    const tmini_config_t driver = {.port = &rover->port,
                                   .port_context = rover,
                                   .rx_buffer = rover->rx,
                                   .rx_size = sizeof rover->rx,
                                   .points = rover->points,
                                   .max_points = TMINI_SCAN_POINTS_TYPICAL,
                                   .frequency_chz = config->frequency_chz,
                                   .step = tmini_steps_step,
                                   .step_data = &rover->steps};
    need(tmini_init(&rover->lidar, &driver) == TMINI_OK, "the driver refuses its configuration");
    need(tmini_start(&rover->lidar) == TMINI_OK, "the driver does not start");
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
        rover->sim.scene.distance_mm[i] = (uint16_t)(distance < 50 ? 0 : lround(distance));
    }
}

bool rover_pass(rover_t *rover)
{
    uint8_t bytes[256];
    const uint32_t before = rover->scans;
    rover->now_us += 1000;
    const size_t count = sim_transmit(&rover->sim, rover->now_us, bytes, sizeof bytes);
    need(tmini_feed(&rover->lidar, bytes, count) == count, "the ring is full");
    for (tmini_event_t event; (event = tmini_poll(&rover->lidar)) != TMINI_EVENT_NONE;) {
        rover->scans += event == TMINI_EVENT_SCAN;
    }
    if (tmini_faults(&rover->lidar) != 0) {
        tmini_fields_clear(rover->fields);
    }
    return rover->scans != before;
}
