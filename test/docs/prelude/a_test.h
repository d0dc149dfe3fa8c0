/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What test/simulator/README.md takes for granted: a test that has something to send. */

#include <stddef.h>
#include <stdint.h>

#include "link.h"
#include "simulator.h"

extern const uint64_t end_us;
extern uint8_t bytes[64];
extern const uint8_t command[2];
extern const size_t length;
extern size_t count;
