/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_laser.h"

#include <math.h>

#include "tmini/tmini_ranges.h"
#include "tmini/tmini_units.h"

#define ONE_DEGREE_Q6 64u

/* An angle this near to straight ahead counts as ahead, so that each start has the same
 * angle_min. */
#define AHEAD_Q6 (2u * ONE_DEGREE_Q6)

const tmini_laser_config_t tmini_laser_default = {
    .rays = 360,
    .min_mm = TMINI_RANGE_MIN_MM,
    .max_mm = TMINI_RANGE_MAX_MM,
    .seen = {-180.0f, 180.0f},
};

void tmini_laser_init(tmini_laser_t *laser, const tmini_laser_config_t *config)
{
    *laser = (tmini_laser_t){.config = *config};
    laser->first = (uint16_t)tmini_ranges_bin(0, config->rays);
}

/* ---------------------------------------------------------------------------------- directions */

static bool is_in(const tmini_laser_arc_t *arc, float degrees)
{
    return degrees >= arc->from_deg && degrees <= arc->to_deg;
}

bool tmini_laser_sees(const tmini_laser_config_t *config, float degrees)
{
    bool sees = is_in(&config->seen, degrees);
    for (size_t i = 0; i < config->masked_count; i++) {
        sees = sees && !is_in(&config->masked[i], degrees);
    }
    return sees;
}

static void learn_where_turns_begin(tmini_laser_t *laser, const tmini_scan_t *scan)
{
    if (laser->is_known || !scan->complete) {
        return;
    }
    /* Ray 0 is the end of the turn, about a degree before its first point; mirrored, its begin. */
    const uint16_t begin = scan->points[0].angle_q6;
    const uint16_t seam = laser->config.is_mirrored ? begin : tmini_clockwise(ONE_DEGREE_Q6, begin);
    const bool is_ahead = tmini_clockwise(TMINI_FULL_CIRCLE_Q6 - AHEAD_Q6, seam) <= 2u * AHEAD_Q6;
    laser->first = (uint16_t)tmini_ranges_bin(is_ahead ? 0 : seam, laser->config.rays);
    laser->is_known = true;
}

static size_t ray_of(const tmini_laser_t *laser, uint16_t angle_q6)
{
    const size_t rays = laser->config.rays;
    const size_t bin = tmini_ranges_bin(angle_q6, rays);
    return (laser->config.is_mirrored ? laser->first + rays - bin : bin + rays - laser->first) %
           rays;
}

/* Ray 0's angle in the message, in steps of a ray: minus a half turn to less than a half turn. */
static int first_step(const tmini_laser_t *laser)
{
    const int rays = laser->config.rays;
    const int bin = laser->config.is_mirrored ? rays - laser->first : laser->first;
    return (bin + (laser->config.is_turned ? rays / 2 : 0)) % rays - rays / 2;
}

/* ------------------------------------------------------------------------------------- ranges */

/* What is too near is neither free nor an obstacle. */
static void take(const tmini_laser_config_t *config, const tmini_point_t *point, float *range,
                 float *intensity)
{
    const float metres = tmini_metres(point->distance_mm);
    if (point->distance_mm == 0 || point->distance_mm > config->max_mm) {
        return;
    }
    if (point->distance_mm < config->min_mm) {
        *range = isinf(*range) ? NAN : *range;
    } else if (!(*range <= metres)) {
        *range = metres;
        *intensity = (float)point->intensity;
    }
}

/* Near ray 0, where a turn begins and ends, a ray may have points of both ends. */
static bool is_of_other_end(const tmini_laser_t *laser, const tmini_scan_t *scan, size_t index,
                            size_t ray)
{
    const size_t rays = laser->config.rays;
    const size_t seam = 1u + rays / 120u;
    const bool is_seam = ray < seam || ray >= rays - seam;
    const bool is_early_ray = (ray >= rays / 2u) != laser->config.is_mirrored;
    return is_seam && is_early_ray != (index < scan->count / 2u);
}

/* A ray takes points of the other end, which have another time, only if it has none of its own. */
static void take_all(const tmini_laser_t *laser, const tmini_scan_t *scan, float *ranges,
                     float *intensities)
{
    for (int is_rest = 0; is_rest < 2; is_rest++) {
        for (size_t i = 0; i < scan->count; i++) {
            const size_t ray = ray_of(laser, scan->points[i].angle_q6);
            const bool is_other = is_of_other_end(laser, scan, i, ray);
            if (is_rest == 0 ? !is_other : is_other && !isfinite(ranges[ray])) {
                take(&laser->config, &scan->points[i], &ranges[ray], &intensities[ray]);
            }
        }
    }
}

static void mask(const tmini_laser_t *laser, float *ranges, float *intensities)
{
    const int rays = laser->config.rays;
    const int half = rays / 2;
    for (int ray = 0; ray < rays; ray++) {
        const int step = (first_step(laser) + half + ray) % rays - half;
        if (!tmini_laser_sees(&laser->config, 360.0f * (float)step / (float)rays)) {
            ranges[ray] = NAN;
            intensities[ray] = 0.0f;
        }
    }
}

/* -------------------------------------------------------------------------------------- times */

/* When the turn began, after the scan's end. If the beginning or the end of a scan is missing, its
 * first point tells. */
static int32_t begin_us(const tmini_laser_t *laser, const tmini_scan_t *scan, int32_t turn_us)
{
    if (scan->complete) {
        return -turn_us;
    }
    const int32_t start_us = -(int32_t)(scan->end_ms - scan->start_ms) * 1000;
    const int32_t rays = laser->config.rays;
    const int32_t ray = (int32_t)ray_of(laser, scan->points[0].angle_q6);
    const int32_t turned = laser->config.is_mirrored ? ray : (rays - ray) % rays;
    return start_us - turn_us / rays * turned;
}

static void set_times(const tmini_laser_t *laser, const tmini_scan_t *scan,
                      tmini_laser_fields_t *fields)
{
    const int32_t turn_us = (int32_t)tmini_scan_period_ms(scan) * 1000;
    const int32_t begin = begin_us(laser, scan, turn_us);
    const float increment = (float)turn_us * 1e-6f / (float)laser->config.rays;
    fields->scan_time = (float)turn_us * 1e-6f;
    fields->time_increment = laser->config.is_mirrored ? increment : -increment;
    fields->stamp_us = laser->config.is_mirrored ? begin : begin + turn_us;
}

static void set_limits(const tmini_laser_t *laser, tmini_laser_fields_t *fields)
{
    const float increment = tmini_ranges_increment(laser->config.rays);
    fields->angle_increment = increment;
    fields->angle_min = increment * (float)first_step(laser);
    fields->angle_max = fields->angle_min + increment * (float)(laser->config.rays - 1);
    fields->range_min = tmini_metres(laser->config.min_mm);
    fields->range_max = tmini_metres(laser->config.max_mm);
}

bool tmini_laser_of_scan(tmini_laser_t *laser, const tmini_scan_t *scan, float *ranges,
                         float *intensities, tmini_laser_fields_t *fields)
{
    if (scan == NULL || laser->config.rays == 0) {
        return false;
    }
    learn_where_turns_begin(laser, scan);
    for (size_t ray = 0; ray < laser->config.rays; ray++) {
        ranges[ray] = laser->config.missing_inf ? INFINITY : NAN;
        intensities[ray] = 0.0f;
    }
    take_all(laser, scan, ranges, intensities);
    mask(laser, ranges, intensities);
    set_limits(laser, fields);
    set_times(laser, scan, fields);
    return true;
}
