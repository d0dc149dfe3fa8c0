/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Fractions are in units of 2^-30. */
#define ONE_Q30 (INT64_C(1) << 30)
#define QUARTER_Q6 5760u
#define NOTHING INT64_MAX

/* Section 1: the range ends at 12 m and begins at 0.05 m. */
#define FARTHEST_MM 12000
#define NEAREST_MM 50

/* A piece of wall parallel to an axis. Millimetres from the lidar, x to the right, y ahead. */
typedef struct {
    bool across; /* along x, at y = `at`; otherwise along y, at x = `at` */
    int16_t at;
    int16_t from;
    int16_t to;
} wall_t;

static const wall_t walls[] = {
    {true, -1700, -2200, 2800}, {false, -2200, -1700, 2300}, /* behind; left */
    {false, 2800, -1700, 200},  {false, 2800, 600, 2300},    /* right, with a window */
    {true, 2300, -2200, 1200},  {true, 2300, 2100, 2800},    /* ahead, with a doorway */
    {true, 4300, -1000, 5000},                               /* the corridor's far side */
    {true, 900, -1500, -1000},  {false, -1000, 900, 1400},   /* a box */
    {true, 1400, -1500, -1000}, {false, -1500, 900, 1400},
    {true, -800, 600, 1300},    {false, 600, -1200, -800}, /* another */
    {true, -1200, 600, 1300},   {false, 1300, -1200, -800},
    {true, -820, -700, -620},   {false, -620, -900, -820}, /* a table's leg */
    {true, -900, -700, -620},   {false, -700, -900, -820},
};

static const int64_t pillar_x = -300;
static const int64_t pillar_y = 1500;
static const int64_t pillar_radius = 150;

/* The sine of 0..90 degrees, by its power series in x = angle / 90 degrees: the coefficients are
 * (pi/2)^n / n!. */
static int64_t sine_of_quarter(uint32_t angle_q6)
{
    static const int64_t terms[] = {172272, 5026995, 85569307, 693598668, 1686629713};
    const int64_t x = (int64_t)angle_q6 * ONE_Q30 / QUARTER_Q6;
    const int64_t square = x * x / ONE_Q30;
    int64_t sum = 0;
    for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++) {
        sum = terms[i] - sum * square / ONE_Q30;
    }
    return sum * x / ONE_Q30;
}

static int64_t sine(uint32_t angle_q6)
{
    const uint32_t quarter = angle_q6 / QUARTER_Q6 % 4u;
    const uint32_t rest = angle_q6 % QUARTER_Q6;
    const int64_t value = sine_of_quarter(quarter % 2u == 0u ? rest : QUARTER_Q6 - rest);
    return quarter < 2u ? value : -value;
}

/* The distance at which the ray in direction (x, y) hits the wall, or NOTHING. */
static int64_t distance_to_wall(const wall_t *wall, int64_t x, int64_t y)
{
    const int64_t towards = wall->across ? y : x;
    const int64_t along = wall->across ? x : y;
    if (towards == 0 || (towards > 0) != (wall->at > 0)) {
        return NOTHING;
    }
    const int64_t distance = wall->at * ONE_Q30 / towards;
    const int64_t place = distance * along / ONE_Q30;
    return place >= wall->from && place <= wall->to ? distance : NOTHING;
}

static int64_t square_root(int64_t value)
{
    int64_t root = 0;
    while ((root + 1) * (root + 1) <= value) {
        root++;
    }
    return root;
}

static int64_t distance_to_pillar(int64_t x, int64_t y)
{
    const int64_t ahead = (pillar_x * x + pillar_y * y) / ONE_Q30;
    const int64_t aside = (pillar_x * y - pillar_y * x) / ONE_Q30;
    const int64_t depth = pillar_radius * pillar_radius - aside * aside;
    return ahead > 0 && depth > 0 ? ahead - square_root(depth) : NOTHING;
}

static uint16_t look(uint32_t angle_q6)
{
    const int64_t x = sine(angle_q6); /* clockwise from straight ahead, seen from above */
    const int64_t y = sine(angle_q6 + QUARTER_Q6);
    int64_t nearest = distance_to_pillar(x, y);
    for (size_t i = 0; i < sizeof walls / sizeof walls[0]; i++) {
        const int64_t distance = distance_to_wall(&walls[i], x, y);
        nearest = distance < nearest ? distance : nearest;
    }
    return nearest >= NEAREST_MM && nearest <= FARTHEST_MM ? (uint16_t)nearest : 0u;
}

void sim_scene_build(sim_scene_t *scene)
{
    for (uint16_t i = 0; i < SIM_SCENE_ENTRIES; i++) {
        scene->distance_mm[i] = look((uint32_t)i * SIM_SCENE_STEP_Q6);
    }
}

static void put(uint16_t *distance, uint16_t distance_mm)
{
    if (*distance == 0u || *distance > distance_mm) {
        *distance = distance_mm;
    }
}

void sim_scene_place(sim_scene_t *scene, uint16_t angle_q6, uint16_t width_q6, uint16_t distance_mm)
{
    const uint32_t centre = angle_q6 / SIM_SCENE_STEP_Q6 + SIM_SCENE_ENTRIES;
    const uint32_t half = width_q6 / (2u * SIM_SCENE_STEP_Q6);
    for (uint32_t i = centre - half; i <= centre + half; i++) {
        put(&scene->distance_mm[i % SIM_SCENE_ENTRIES], distance_mm);
    }
}
