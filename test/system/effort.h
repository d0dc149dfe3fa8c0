/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* How long tests with random input run: for some seconds, unless the environment asks for more.
 *
 *   TMINI_TEST_EFFORT=20   twenty times as many cases (of the angles, all)
 *   TMINI_TEST_SEED=12345  other cases; a failure prints the seed that reproduces it */

#ifndef EFFORT_H
#define EFFORT_H

#include <stdint.h>

uint32_t effort(void);
uint32_t effort_seed(void);

#endif
