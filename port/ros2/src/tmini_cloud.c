/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini_cloud.h"

#include <math.h>

#include "tmini/tmini_units.h"

/* The angle in the message, in degrees from -180 to below 180. */
static float degrees_of(const tmini_laser_config_t *config, uint16_t angle_q6)
{
    const uint16_t half = TMINI_FULL_CIRCLE_Q6 / 2u;
    const uint16_t counted = config->is_mirrored ? angle_q6 : tmini_clockwise(angle_q6, 0);
    const uint16_t beyond = tmini_clockwise(config->is_turned ? 0 : half, counted);
    return tmini_degrees(beyond) - 180.0f;
}

static bool is_kept(const tmini_laser_config_t *config, const tmini_point_t *point, float degrees)
{
    return point->distance_mm != 0 && point->distance_mm >= config->min_mm &&
           point->distance_mm <= config->max_mm && tmini_laser_sees(config, degrees);
}

size_t tmini_cloud_of_scan(const tmini_laser_config_t *config, const tmini_scan_t *scan,
                           tmini_cloud_point_t *points)
{
    size_t count = 0;
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        const float degrees = degrees_of(config, point->angle_q6);
        if (is_kept(config, point, degrees)) {
            const float angle = degrees * (TMINI_PI / 180.0f);
            const float range = tmini_metres(point->distance_mm);
            points[count++] = (tmini_cloud_point_t){
                .x = range * cosf(angle),
                .y = range * sinf(angle),
                .intensity = (float)point->intensity,
                .time = (float)tmini_point_time_us(scan, i) * 1e-6f,
            };
        }
    }
    return count;
}
