/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Makes the simulated lidar like a real one: reads its settings from the lines `key = value` of a
 * report of `tmini survey`. */

#ifndef LIKE_H
#define LIKE_H

#include "options.h"

/* Reads the file. False if it cannot be read, contains no such line, or a value is invalid. Other
 * keys, the value "unknown" and lines that begin with # change nothing. */
bool like_read(options_t *options, const char *path);

#endif
