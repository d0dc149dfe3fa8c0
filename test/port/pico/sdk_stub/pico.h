/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the Pico SDK's header of this name, as do the others here, on the model of the chip
 * (../pico_model.h). Each includes the same headers as the original (SDK 2.2.0), so that code that
 * compiles here also compiles with the SDK. Written for the tests from the SDK's public
 * documentation and the data sheets. */

#ifndef PICO_H
#define PICO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h> /* uint */

#if PICO_RP2350
#define NUM_BANK0_GPIOS 48u
#else
#define PICO_RP2040 1
#define NUM_BANK0_GPIOS 30u
#endif

typedef uint64_t absolute_time_t;

#endif
