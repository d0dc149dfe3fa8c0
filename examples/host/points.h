/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a lidar sends, in words and for other programs: the same whether it is live or recorded. */

#ifndef POINTS_H
#define POINTS_H

#include <inttypes.h>
#include <stdint.h>

#include "stream.h"

/* An angle in degrees, exactly: 1/64 degree has six decimals. For printf, with ANGLE_VALUES(). */
#define ANGLE_FORMAT "%" PRIu32 ".%06" PRIu32
#define ANGLE_VALUES(angle_q6) \
    (uint32_t)(angle_q6) / 64u, (uint32_t)(angle_q6) % 64u * (uint32_t)15625

/* The nearest point with a distance, or NULL. */
const tmini_point_t *points_nearest(const tmini_point_t *points, size_t count);

/* How many have a distance. */
size_t points_valid(const tmini_point_t *points, size_t count);

/* "ahead", "behind to the left", … */
const char *direction_name(uint16_t angle_q6);

/* Space for any text of faults_text(). */
#define FAULTS_TEXT_SIZE 120

/* "healthy", or "faulty: " and the modules with what to look at, in `text`. */
const char *faults_text(unsigned faults, char text[FAULTS_TEXT_SIZE]);

/* "6.0 Hz" or "unknown"; valid until the next call. */
const char *frequency_text(unsigned frequency_chz);

/* A row for each sample of each valid packet. */
#define ROWS_HEADER "scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz"

/* What the columns and members mean, for --help. */
extern const char rows_help[];

/* Prints the rows of a packet that the stream has just taken. */
void rows_print_packet(const stream_t *stream, const tmini_packet_t *packet);

/* Prints the stream's latest scan as a JSON object on a line of its own. */
void rows_print_scan(const stream_t *stream);

#endif
