/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef PICO_STDLIB_H
#define PICO_STDLIB_H

#include "hardware/gpio.h"
#include "hardware/uart.h"
#include "pico.h"
#include "pico/stdio.h"
#include "pico/time.h"

#endif
