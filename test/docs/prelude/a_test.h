/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the code in test/simulator/README.md needs: a test that has data to send. */

#include <stddef.h>
#include <stdint.h>

#include "link.h"
#include "simulator.h"

extern const uint64_t end_us;
extern uint8_t bytes[64];
extern const uint8_t command[2];
extern const size_t length;
extern size_t count;
