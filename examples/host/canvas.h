/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A picture of pixels, and anti-aliased shapes on it: each pixel is covered as far as its distance
 * from the shape's edge says. Sizes in pixels, y points down, pixel (0, 0) has its centre at
 * (0.5, 0.5). */

#ifndef CANVAS_H
#define CANVAS_H

#include "sheet.h"

typedef struct {
    unsigned width;
    unsigned height;
    uint8_t *pixels; /* Red, green, blue; row by row. */
} canvas_t;

/* Black. Returns false if memory is short. Released by canvas_free(). */
bool canvas_init(canvas_t *canvas, unsigned width, unsigned height);
void canvas_free(canvas_t *canvas);

void canvas_box(canvas_t *canvas, spot_t corner, spot_t size, paint_t paint);
void canvas_disc(canvas_t *canvas, spot_t centre, double radius, paint_t paint);
void canvas_ring(canvas_t *canvas, spot_t centre, double radius, const pen_t *pen);

/* A line with round ends. */
void canvas_line(canvas_t *canvas, spot_t from, spot_t to, const pen_t *pen);

#endif
