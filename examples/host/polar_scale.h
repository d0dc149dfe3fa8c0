/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the picture of a scan must be able to show: how far, how bright, what stands out. */

#ifndef POLAR_SCALE_H
#define POLAR_SCALE_H

#include "polar.h"

typedef struct {
    unsigned range_mm; /* The outermost ring. */
    unsigned step_mm;  /* From ring to ring. */
    int decimals;      /* Of the rings' labels, in metres. */
    uint8_t darkest;   /* Intensities of the points with a distance. */
    uint8_t brightest;
    double beam_alpha;
    size_t specular; /* Points with that flag. */
    size_t ambient;
    const tmini_point_t *nearest; /* NULL: there is no point with a distance. */
} scale_t;

/* Fits the scale to all scans of the figure. */
void scale_fit(scale_t *scale, const figure_t *figure);

/* The intensity as a share, from 0 for the darkest to 1 for the brightest. */
double scale_intensity(const scale_t *scale, uint8_t intensity);

#endif
