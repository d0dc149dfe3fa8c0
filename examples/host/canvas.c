/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "canvas.h"

#include <math.h>
#include <stdlib.h>

bool canvas_init(canvas_t *canvas, unsigned width, unsigned height)
{
    *canvas = (canvas_t){width, height, calloc((size_t)width * height, 3)};
    return canvas->pixels != NULL;
}

void canvas_free(canvas_t *canvas)
{
    free(canvas->pixels);
}

static uint8_t mix(uint8_t below, uint8_t above, double share)
{
    return (uint8_t)lround(below + (above - below) * share);
}

/* `inside` is how far, in pixels, the pixel's centre lies inside the shape; negative: outside. */
static void cover(const canvas_t *canvas, unsigned x, unsigned y, double inside, paint_t paint)
{
    const double coverage = fmin(fmax(inside + 0.5, 0), 1);
    const double share = coverage * paint.alpha;
    uint8_t *const pixel = &canvas->pixels[3 * ((size_t)y * canvas->width + x)];
    pixel[0] = mix(pixel[0], paint.red, share);
    pixel[1] = mix(pixel[1], paint.green, share);
    pixel[2] = mix(pixel[2], paint.blue, share);
}

/* A coordinate as the index of a pixel, within 0 to `end`. */
static unsigned clip(double coordinate, unsigned end)
{
    return (unsigned)fmin(fmax(floor(coordinate), 0), end);
}

void canvas_box(canvas_t *canvas, spot_t corner, spot_t size, paint_t paint)
{
    const unsigned right = clip(corner.x + size.x + 1, canvas->width);
    const unsigned bottom = clip(corner.y + size.y + 1, canvas->height);
    for (unsigned y = clip(corner.y, canvas->height); y < bottom; y++) {
        for (unsigned x = clip(corner.x, canvas->width); x < right; x++) {
            const double inside_x = size.x / 2 - fabs(x + 0.5 - corner.x - size.x / 2);
            const double inside_y = size.y / 2 - fabs(y + 0.5 - corner.y - size.y / 2);
            cover(canvas, x, y, fmin(inside_x, inside_y), paint);
        }
    }
}

void canvas_disc(canvas_t *canvas, spot_t centre, double radius, paint_t paint)
{
    const unsigned right = clip(centre.x + radius + 2, canvas->width);
    const unsigned bottom = clip(centre.y + radius + 2, canvas->height);
    for (unsigned y = clip(centre.y - radius - 1, canvas->height); y < bottom; y++) {
        for (unsigned x = clip(centre.x - radius - 1, canvas->width); x < right; x++) {
            const double distance = hypot(x + 0.5 - centre.x, y + 0.5 - centre.y);
            cover(canvas, x, y, radius - distance, paint);
        }
    }
}

static void dotted_ring(canvas_t *canvas, spot_t centre, double radius, const pen_t *pen)
{
    const double turn = 2 * acos(-1);
    const int dots = (int)(turn * radius / (4 * pen->width));
    for (int i = 0; i < dots; i++) {
        const double angle = turn * i / dots;
        const spot_t at = {centre.x + radius * cos(angle), centre.y + radius * sin(angle)};
        canvas_disc(canvas, at, pen->width / 2, pen->paint);
    }
}

void canvas_ring(canvas_t *canvas, spot_t centre, double radius, const pen_t *pen)
{
    if (pen->dotted) {
        dotted_ring(canvas, centre, radius, pen);
        return;
    }
    const double outer = radius + pen->width / 2;
    const unsigned right = clip(centre.x + outer + 2, canvas->width);
    const unsigned bottom = clip(centre.y + outer + 2, canvas->height);
    for (unsigned y = clip(centre.y - outer - 1, canvas->height); y < bottom; y++) {
        for (unsigned x = clip(centre.x - outer - 1, canvas->width); x < right; x++) {
            const double distance = hypot(x + 0.5 - centre.x, y + 0.5 - centre.y);
            cover(canvas, x, y, pen->width / 2 - fabs(distance - radius), pen->paint);
        }
    }
}

/* How far a place is from the line between two others. */
static double distance_from_line(spot_t at, spot_t from, spot_t to)
{
    const spot_t along = {to.x - from.x, to.y - from.y};
    const double square = along.x * along.x + along.y * along.y;
    double share = 0;
    if (square > 0) {
        share = ((at.x - from.x) * along.x + (at.y - from.y) * along.y) / square;
        share = fmin(fmax(share, 0), 1);
    }
    return hypot(at.x - from.x - share * along.x, at.y - from.y - share * along.y);
}

/* The pixels of row `y` that a line with that reach to either side may touch. */
static void row_of_line(spot_t from, spot_t to, double y, double reach, double span[2])
{
    span[0] = fmin(from.x, to.x) - reach;
    span[1] = fmax(from.x, to.x) + reach;
    const double rise = to.y - from.y;
    if (fabs(rise) > 1) {
        const double run = (to.x - from.x) / rise;
        const double crossing = from.x + (y - from.y) * run;
        const double width = reach * sqrt(1 + run * run);
        span[0] = fmax(span[0], crossing - width);
        span[1] = fmin(span[1], crossing + width);
    }
}

void canvas_line(canvas_t *canvas, spot_t from, spot_t to, const pen_t *pen)
{
    const double reach = pen->width / 2 + 1;
    const unsigned bottom = clip(fmax(from.y, to.y) + reach + 1, canvas->height);
    for (unsigned y = clip(fmin(from.y, to.y) - reach, canvas->height); y < bottom; y++) {
        double span[2];
        row_of_line(from, to, y + 0.5, reach, span);
        const unsigned right = clip(span[1] + 1, canvas->width);
        for (unsigned x = clip(span[0], canvas->width); x < right; x++) {
            const double distance = distance_from_line((spot_t){x + 0.5, y + 0.5}, from, to);
            cover(canvas, x, y, pen->width / 2 - distance, pen->paint);
        }
    }
}
