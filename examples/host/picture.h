/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A figure as a file. */

#ifndef PICTURE_H
#define PICTURE_H

#include <stdbool.h>

#include "polar.h"

/* True if the name ends in .svg or .png. */
bool picture_is_known(const char *path);

/* Draws the figure and writes the file. Returns the status to leave with, and says what went wrong. */
int picture_write(const char *path, const figure_t *figure);

#endif
