/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program whose rows are claims, each with a name:
 *
 *     PROGRAM            all rows
 *     PROGRAM NAME …     these, with what is wrong
 *     PROGRAM --list */

#ifndef CLAIMS_H
#define CLAIMS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    const char *name;
    void (*run)(const char *argument);
    const char *argument;
} claim_t;

/* What the row claims. The first one that is not true counts. */
void expect(bool is_true, const char *format, ...);

bool is_right(void);

int claims_main(int argc, char **argv, const claim_t *claims, size_t count);

#endif
