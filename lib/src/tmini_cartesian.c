/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_cartesian.h"

#define TURN ((uint32_t)TMINI_FULL_CIRCLE_Q6)
#define HALF_TURN (TURN / 2)
#define QUARTER (TURN / 4)

/* The sine of 0 to 91 degrees in 1/65536. Straight lines between these lie below the curve by up to
 * 38 millionths, so that the entries are half of that too large. */
static const uint16_t sines[] = {
    0,     1144,  2287,  3430,  4572,  5712,  6851,  7987,  9121,  10252, 11380, 12505,
    13626, 14743, 15855, 16962, 18065, 19161, 20252, 21337, 22415, 23486, 24551, 25607,
    26656, 27697, 28730, 29753, 30768, 31773, 32769, 33754, 34729, 35694, 36648, 37591,
    38522, 39441, 40349, 41244, 42127, 42996, 43853, 44696, 45526, 46342, 47144, 47931,
    48704, 49462, 50204, 50932, 51644, 52340, 53021, 53685, 54333, 54964, 55579, 56176,
    56757, 57320, 57866, 58394, 58904, 59397, 59871, 60327, 60765, 61184, 61585, 61967,
    62330, 62674, 62998, 63304, 63591, 63858, 64105, 64333, 64542, 64730, 64899, 65049,
    65178, 65288, 65378, 65447, 65497, 65527, 65535, 65527,
};

/* The sine of 0 to 5760 (90 degrees). */
static uint32_t sine(uint32_t angle_q6)
{
    const uint32_t degree = angle_q6 / 64u;
    const uint32_t low = sines[degree];
    const int32_t rise = (int32_t)sines[degree + 1] - (int32_t)low;
    return low + (uint32_t)((rise * (int32_t)(angle_q6 % 64u) + 32) / 64);
}

/* distance * sin(angle), for angles below a circle and a quarter. */
static int16_t leg(uint32_t angle_q6, uint16_t distance_mm)
{
    const uint32_t angle = angle_q6 < TURN ? angle_q6 : angle_q6 - TURN;
    const uint32_t within = angle < HALF_TURN ? angle : angle - HALF_TURN;
    const uint32_t up = sine(within <= QUARTER ? within : HALF_TURN - within);
    const int16_t length_mm = (int16_t)((distance_mm * up + 32768u) / 65536u);
    return (int16_t)(angle < HALF_TURN ? length_mm : -length_mm);
}

tmini_xy_t tmini_cartesian(uint16_t angle_q6, uint16_t distance_mm)
{
    return (tmini_xy_t){.x_mm = leg(angle_q6 + QUARTER, distance_mm),
                        .y_mm = (int16_t)-leg(angle_q6, distance_mm)};
}
