/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A picture of points as a file: seen from above, the lidar in the middle, its front up, angles
 * clockwise. Drawn with cairo. */

#ifndef PICTURE_H
#define PICTURE_H

#include <stdbool.h>

#include "tmini/tmini_packet.h"

typedef struct {
    const char *title;
    const char *subtitle; /* UTF-8, or nearly so: it may hold a file's name. */
    const tmini_point_t *points;
    size_t count;
} figure_t;

/* True if the name ends in .svg, .png or .pdf, or is "-". */
bool picture_is_known(const char *path);

/* Draws the figure and writes the file; SVG to standard output for "-". Returns the status to leave
 * with, and says what went wrong. */
int picture_write(const char *path, const figure_t *figure);

#endif
