/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A picture of points as a file: seen from above, the lidar in the middle, its front up, angles
 * clockwise. Drawn with cairo. */

#ifndef PICTURE_H
#define PICTURE_H

#include <stdbool.h>

#include "points.h"

typedef struct {
    char title[80];
    char subtitle[600]; /* Meant to be UTF-8; but it may contain a file's name. */
    const tmini_point_t *points;
    survey_t survey; /* Of these points. */
} figure_t;

/* True if the name ends in .svg, .png or .pdf, or is "-". */
bool picture_is_known(const char *path);

/* The distance of the outermost ring in a picture of points with this survey. */
unsigned picture_range_mm(const survey_t *survey);

/* Whether flagged points are marked: some units flag every sample (section 9.9), and marks on all
 * of them would hide the room. */
bool picture_marks_flags(const survey_t *survey);

/* Draws the figure and writes the file; SVG to standard output for "-". Prints errors, and returns
 * the exit status. */
int picture_write(const char *path, const figure_t *figure);

#endif
