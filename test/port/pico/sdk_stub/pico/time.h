/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef PICO_TIME_H
#define PICO_TIME_H

#include "pico.h"

absolute_time_t get_absolute_time(void);
uint32_t to_ms_since_boot(absolute_time_t time);
void sleep_ms(uint32_t ms);

#endif
