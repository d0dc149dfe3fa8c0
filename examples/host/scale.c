/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "scale.h"

#include <math.h>

#define RINGS_MAX 6u
#define EMPTY_MM 6000u /* Of a picture in which there is nothing. */

static void look_at(scale_t *scale, const tmini_point_t *point)
{
    if (point->distance_mm == 0) {
        return;
    }
    scale->valid++;
    scale->specular += point->flag == TMINI_FLAG_SPECULAR ? 1 : 0;
    scale->ambient += point->flag == TMINI_FLAG_AMBIENT ? 1 : 0;
    if (scale->nearest == NULL || point->distance_mm < scale->nearest->distance_mm) {
        scale->nearest = point;
    }
    scale->range_mm = point->distance_mm > scale->range_mm ? point->distance_mm : scale->range_mm;
    scale->darkest = point->intensity < scale->darkest ? point->intensity : scale->darkest;
    scale->brightest = point->intensity > scale->brightest ? point->intensity : scale->brightest;
}

/* The smallest step of a round number of millimetres that needs few enough rings. */
static void choose_rings(scale_t *scale)
{
    static const unsigned steps_mm[] = {50, 100, 200, 250, 500, 1000, 2000, 2500, 5000};
    size_t i = 0;
    while (steps_mm[i] * RINGS_MAX < scale->range_mm) {
        i++; /* Ends: 30 m are more than the 16383 mm of the protocol. */
    }
    const unsigned rings = (scale->range_mm + steps_mm[i] - 1) / steps_mm[i];
    scale->step_mm = steps_mm[i];
    scale->range_mm = steps_mm[i] * (rings > 0 ? rings : 1);
    scale->decimals = scale->step_mm % 1000 == 0 ? 0 : scale->step_mm % 100 == 0 ? 1 : 2;
}

void scale_fit(scale_t *scale, const tmini_point_t *points, size_t count)
{
    *scale = (scale_t){.darkest = UINT8_MAX};
    for (size_t i = 0; i < count; i++) {
        look_at(scale, &points[i]);
    }
    scale->range_mm = scale->valid > 0 ? scale->range_mm : EMPTY_MM;
    choose_rings(scale);
}

colour_t scale_colour(const scale_t *scale, uint8_t intensity)
{
    static const colour_t stops[] = {
        {0.32, 0.36, 0.89}, {0.13, 0.59, 0.89}, {0.18, 0.80, 0.67},
        {0.66, 0.89, 0.36}, {1.00, 0.84, 0.33},
    };
    const int last = (int)(sizeof stops / sizeof stops[0]) - 1;
    const double span = scale->brightest > scale->darkest ? scale->brightest - scale->darkest : 1;
    const double place = fmin(fmax((intensity - scale->darkest) / span, 0), 1) * last;
    const int below = (int)fmin(floor(place), last - 1);
    const double share = place - below;
    const colour_t from = stops[below];
    const colour_t to = stops[below + 1];
    return (colour_t){from.red + (to.red - from.red) * share,
                      from.green + (to.green - from.green) * share,
                      from.blue + (to.blue - from.blue) * share};
}
