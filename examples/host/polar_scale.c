/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "polar_scale.h"

#define RINGS_MAX 6u

/* Light of the beams in a picture of one scan. */
#define BEAM_ALPHA 0.05

static void look_at(scale_t *scale, const tmini_point_t *point, unsigned *farthest_mm)
{
    if (point->distance_mm == 0) {
        return;
    }
    scale->specular += point->flag == TMINI_FLAG_SPECULAR ? 1 : 0;
    scale->ambient += point->flag == TMINI_FLAG_AMBIENT ? 1 : 0;
    if (scale->nearest == NULL || point->distance_mm < scale->nearest->distance_mm) {
        scale->nearest = point;
    }
    *farthest_mm = point->distance_mm > *farthest_mm ? point->distance_mm : *farthest_mm;
    scale->darkest = point->intensity < scale->darkest ? point->intensity : scale->darkest;
    scale->brightest = point->intensity > scale->brightest ? point->intensity : scale->brightest;
}

/* The smallest step of a round number of millimetres that needs few enough rings. */
static void choose_rings(scale_t *scale, unsigned farthest_mm)
{
    static const unsigned steps_mm[] = {50, 100, 200, 250, 500, 1000, 2000, 2500, 5000};
    size_t i = 0;
    while (steps_mm[i] * RINGS_MAX < farthest_mm) {
        i++; /* Ends: 30 m are more than the 16383 mm of the protocol. */
    }
    const unsigned step_mm = steps_mm[i];
    const unsigned rings = (farthest_mm + step_mm - 1) / step_mm;
    scale->step_mm = step_mm;
    scale->range_mm = step_mm * (rings > 0 ? rings : 1);
    scale->decimals = step_mm % 1000 == 0 ? 0 : step_mm % 100 == 0 ? 1 : 2;
}

void scale_fit(scale_t *scale, const figure_t *figure)
{
    unsigned farthest_mm = 0;
    *scale = (scale_t){.darkest = UINT8_MAX};
    for (size_t i = 0; i < figure->count; i++) {
        for (size_t j = 0; j < figure->scans[i]->count; j++) {
            look_at(scale, &figure->scans[i]->points[j], &farthest_mm);
        }
    }
    if (scale->nearest == NULL) {
        scale->darkest = 0;
    }
    scale->beam_alpha = BEAM_ALPHA / (double)(figure->count > 0 ? figure->count : 1);
    choose_rings(scale, farthest_mm);
}

double scale_intensity(const scale_t *scale, uint8_t intensity)
{
    if (scale->brightest <= scale->darkest) {
        return 1;
    }
    return (double)(intensity - scale->darkest) / (scale->brightest - scale->darkest);
}
