/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef PICO_STDIO_H
#define PICO_STDIO_H

#include "pico.h"

bool stdio_init_all(void);

#endif
