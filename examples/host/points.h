/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What points show, in numbers, colours and words, and as rows for other programs: the same for
 * live and recorded points. A text that is not in the caller's buffer is valid until the next call
 * of the same function. */

#ifndef POINTS_H
#define POINTS_H

#include "stream.h"

/* What points show as a whole. All members except `count` are about points with a distance. */
typedef struct {
    size_t count;
    size_t valid; /* How many have a distance, and how many of those have which flag (section 5). */
    size_t specular;
    size_t ambient;
    unsigned farthest_mm;
    uint8_t darkest; /* The lowest and highest intensity; 255 and 0 without points. */
    uint8_t brightest;
    const tmini_point_t *nearest; /* NULL: there is none. */
} survey_t;

survey_t points_survey(const tmini_point_t *points, size_t count);

/* Red, green and blue, from 0 to 1. */
typedef struct {
    double red, green, blue;
} colour_t;

/* The colour of an intensity, from blue for the darkest to yellow for the brightest of a survey. */
colour_t points_colour(const survey_t *survey, uint8_t intensity);

/* The point's angle, rounded down to one decimal, so that it is never 360.0. */
double points_degrees(const tmini_point_t *point);

/* "ahead", "behind left", … */
const char *direction_name(uint16_t angle_q6);

/* "1.023 m at 134.5 deg, behind right" */
const char *place_text(const tmini_point_t *point);

/* Space for any text of faults_text() and health_text(). */
#define FAULTS_TEXT_SIZE 120

/* "healthy", or "faulty: " and the modules and what to check, in `text`. */
const char *faults_text(unsigned faults, char text[FAULTS_TEXT_SIZE]);

/* The same for the health that the stream reports; or why it is unknown. */
const char *health_text(const stream_t *stream, char text[FAULTS_TEXT_SIZE]);

/* "T-mini Plus", or what is known about another model. */
const char *model_text(uint8_t model);

/* "8 complete, 1 with packets missing" */
const char *scans_text(const stream_t *stream);

/* "6.0 Hz" or "unknown" */
const char *frequency_text(unsigned frequency_chz);

/* What share of the packets is damaged: "0.0 %", "under 0.1 %", "10.7 %". */
const char *damaged_text(const stream_t *stream);

/* A row for each sample of each valid packet. */
#define ROWS_HEADER "scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz"

/* What the columns and members mean, for --help. */
extern const char rows_help[];

/* Prints the rows of the packet that the stream has just taken. */
void rows_print_packet(const stream_t *stream);

/* Prints the stream's latest scan as a JSON object on a line of its own. */
void rows_print_scan(const stream_t *stream);

#endif
