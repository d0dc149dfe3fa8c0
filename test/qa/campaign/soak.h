/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The campaign's mode of hours (soak.c), and what both draw by. */

#ifndef SOAK_H
#define SOAK_H

#include "random.h"

#include <stdbool.h>

extern random_t dice;

static inline uint32_t between(uint32_t low, uint32_t high)
{
    return random_between(&dice, low, high);
}

static inline bool one_in(uint32_t number)
{
    return number > 0 && random_below(&dice, number) == 0;
}

/* As main(): the arguments are "soak", the hours and the seed. */
int soak(int argc, char **argv);

#endif
