/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "effort.h"

#include <stdlib.h>

static uint32_t number_in(const char *name, uint32_t otherwise)
{
    const char *const text = getenv(name);
    return text != NULL && text[0] != '\0' ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

uint32_t effort(void)
{
    return number_in("TMINI_TEST_EFFORT", 1);
}

uint32_t effort_seed(void)
{
    return number_in("TMINI_TEST_SEED", 1);
}
