/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Points as text for other programs. */

#ifndef ROWS_H
#define ROWS_H

#include <inttypes.h>
#include <stdint.h>

#include "tmini/tmini_packet.h"

/* An angle in degrees, exactly: 1/64 degree has six decimals. For printf, with ANGLE_VALUES(). */
#define ANGLE_FORMAT "%" PRIu32 ".%06" PRIu32
#define ANGLE_VALUES(angle_q6) \
    (uint32_t)(angle_q6) / 64u, (uint32_t)(angle_q6) % 64u * (uint32_t)15625

/* The columns of a row. */
#define ROW_HEADER "scan,packet,point,angle_deg,distance_mm,intensity,flag"

/* Prints one row to standard output. */
void row_print(uint64_t scan, uint64_t packet, size_t index, const tmini_point_t *point);

/* Prints a JSON array of [angle in degrees, distance in mm, intensity, flag] to standard output. */
void row_print_json(const tmini_point_t *points, size_t count);

#endif
