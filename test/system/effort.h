/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How long tests with random input run: for some seconds, unless the environment asks for more.
 *
 *   TMINI_TEST_EFFORT=20   twenty times as many cases (of the angles, all)
 *   TMINI_TEST_SEED=12345  other cases; a failure prints the seed that reproduces it */

#ifndef EFFORT_H
#define EFFORT_H

#include <stdint.h>
#include <stdlib.h>

static inline uint32_t effort_of(const char *name)
{
    const char *const text = getenv(name);
    return text != NULL && text[0] != '\0' ? (uint32_t)strtoul(text, NULL, 10) : 1;
}

static inline uint32_t effort(void)
{
    return effort_of("TMINI_TEST_EFFORT");
}

static inline uint32_t effort_seed(void)
{
    return effort_of("TMINI_TEST_SEED");
}

#endif
