/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a picture of points must be able to show: how far, how bright, what stands out. */

#ifndef SCALE_H
#define SCALE_H

#include "tmini/tmini_packet.h"

typedef struct {
    unsigned range_mm; /* The outermost ring. */
    unsigned step_mm;  /* From ring to ring. */
    int decimals;      /* Of the rings' labels, in metres. */
    uint8_t darkest;   /* Intensities of the points with a distance. */
    uint8_t brightest;
    size_t valid; /* Points with a distance, and how many of them are flagged. */
    size_t specular;
    size_t ambient;
    const tmini_point_t *nearest; /* NULL: there is no point with a distance. */
} scale_t;

/* Red, green and blue, from 0 to 1. */
typedef struct {
    double red, green, blue;
} colour_t;

/* Fits the scale to the points. */
void scale_fit(scale_t *scale, const tmini_point_t *points, size_t count);

/* The colour of an intensity, from blue for the darkest to yellow for the brightest. */
colour_t scale_colour(const scale_t *scale, uint8_t intensity);

#endif
