/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "ramp.h"

#include <math.h>

#define STOPS 5

static uint8_t mix(uint8_t from, uint8_t to, double share)
{
    return (uint8_t)lround(from + (to - from) * share);
}

paint_t ramp_colour(double share)
{
    static const paint_t stops[STOPS] = {
        {82, 92, 226, 1},  {34, 150, 226, 1}, {46, 205, 170, 1},
        {168, 226, 92, 1}, {255, 214, 84, 1},
    };
    const double place = fmin(fmax(share, 0), 1) * (STOPS - 1);
    const int below = (int)fmin(floor(place), STOPS - 2);
    const paint_t *const from = &stops[below];
    const paint_t *const to = &stops[below + 1];
    const double part = place - below;
    return (paint_t){mix(from->red, to->red, part), mix(from->green, to->green, part),
                     mix(from->blue, to->blue, part), 1};
}
