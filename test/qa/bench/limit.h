/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simplest possible decoder: the library's cost is compared with its cost. */

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

/* Enough for the points of any 4096 bytes. */
#define LIMIT_POINTS 1400

/* Decodes an undamaged stream of scan packets to points in one pass, with checksums, but without
 * ring, resynchronisation, scans or CT information. Only for little-endian machines that read words
 * at any address. Also reads the byte after the last one. Returns the bytes used: all up to the
 * first incomplete packet. */
size_t limit_decode(const uint8_t *bytes, size_t count, limit_point_t *points);

#endif
