/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What sectors and ranges share: equal parts of a circle, and the nearest point in each. */

#ifndef TMINI_BINS_H
#define TMINI_BINS_H

#include "tmini/tmini_types.h"

/* Which of `count` parts (1 to 65535) contains an angle. The angle is at most a full circle and
 * counts from the middle of part 0. No overflow: 2 * 23040 * 65535 + 23040 is below 2^32. */
static inline size_t tmini_bin(uint32_t angle_q6, size_t count)
{
    const uint32_t circle = TMINI_FULL_CIRCLE_Q6;
    const uint32_t parts = (2 * angle_q6 * (uint32_t)count + circle) / 1024u; /* Two circles are 45
                                                                               * * 1024. */
#if defined(__AVR__) /* A 16-bit division is four times as fast as a 32-bit one. */
    const uint32_t bin = parts <= UINT16_MAX ? (uint16_t)parts / 45u : parts / 45u;
#else
    const uint32_t bin = parts / 45u;
#endif
    return (size_t)(bin < count ? bin : 0);
}

/* True if the point has a range and is nearer than `nearest_mm`, the nearest so far (0: none
 * yet). */
static inline bool tmini_is_nearer(const tmini_point_t *point, uint16_t nearest_mm)
{
    return point->distance_mm != 0 && (nearest_mm == 0 || point->distance_mm < nearest_mm);
}

#endif
