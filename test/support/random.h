/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/*
 * Seeded random numbers for tests and for the simulated lidar: the same seed gives the same
 * sequence on every machine (integer arithmetic only).
 */

#ifndef RANDOM_H
#define RANDOM_H

#include <stdint.h>

typedef struct {
    uint64_t state;
} random_t;

/* Every seed, 0 included, gives a good sequence. */
void random_seed(random_t *random, uint64_t seed);

uint64_t random_u64(random_t *random);
uint32_t random_u32(random_t *random);

/* Uniform in 0..limit-1; limit 0 gives 0. */
uint32_t random_below(random_t *random, uint32_t limit);

/* Uniform in low..high, both included. */
uint32_t random_between(random_t *random, uint32_t low, uint32_t high);

/* The gap to the next of a series of independent events that are `mean` apart on average
 * (exponentially distributed), at least 1. */
uint64_t random_gap(random_t *random, uint32_t mean);

#endif
