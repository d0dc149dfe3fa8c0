/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The least that decoding can cost: what the library is compared with. */

#ifndef LIMIT_H
#define LIMIT_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint16_t angle_q6;
    uint16_t distance_mm;
    uint8_t intensity;
    uint8_t flag;
} limit_point_t;

/* Room for the points of 4096 bytes at least, whatever they are. */
#define LIMIT_POINTS 1400

/* From an undamaged stream of scan packets to points, in one pass that checks and stores: no ring,
 * no resynchronising, no scans, no CT information; for machines that read words at any address, the
 * first byte lowest. The byte after the last one is read, too. Returns how many bytes it has used:
 * all up to the first incomplete packet. */
size_t limit_decode(const uint8_t *bytes, size_t count, limit_point_t *points);

#endif
