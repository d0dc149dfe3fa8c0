/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef HARDWARE_SYNC_H
#define HARDWARE_SYNC_H

#include "hardware/address_mapped.h"
#include "pico.h"

void __dmb(void);

#endif
