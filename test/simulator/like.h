/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Makes the simulated lidar like a real one: reads its settings from the lines `key = value` of a
 * report of `tmini survey`. */

#ifndef LIKE_H
#define LIKE_H

#include "options.h"

#include <stddef.h>

/* A number from `low` to `high` that, multiplied by `scale` and rounded, goes into the member of
 * `size` bytes at `place`. A double is not rounded. */
typedef struct {
    size_t place;
    size_t size;
    double scale;
    double low;
    double high;
} number_t;

#define NUMBER(member, scale, low, high)                                                   \
    {                                                                                      \
        offsetof(options_t, member), sizeof(((options_t *)NULL)->member), scale, low, high \
    }

/* Reads a number from `low` to `high`, which is the whole text; and such a member. False: it is
 * none. */
bool like_parse(const char *text, double low, double high, double *number);
bool like_read_number(options_t *options, const number_t *number, const char *text);

/* Finds the name among the names; false: it is not there. */
bool like_find(const char *name, const char *const *names, unsigned count, unsigned *found);

/* A line of a report. False: the value is invalid. Other keys and the value "unknown" change
 * nothing. */
bool like_set(options_t *options, const char *key, const char *value);

/* Reads the file. False if it cannot be read, contains no such line, or a value is invalid. Lines
 * that begin with # change nothing. */
bool like_read(options_t *options, const char *path);

#endif
