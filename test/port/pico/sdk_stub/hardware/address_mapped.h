/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef HARDWARE_ADDRESS_MAPPED_H
#define HARDWARE_ADDRESS_MAPPED_H

#include "pico.h"

void hw_write_masked(volatile uint32_t *address, uint32_t values, uint32_t mask);

#endif
