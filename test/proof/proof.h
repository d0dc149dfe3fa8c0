/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the proofs share. A proof's main() sets up any state that the module's invariants allow,
 * with any contents, calls one function, and asserts; the model checker tries all values at
 * once. */

#ifndef PROOF_H
#define PROOF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini_ring.h"

#define ASSUME(condition) __CPROVER_assume(condition)
#define CLAIM(condition) __CPROVER_assert(condition, #condition)

/* Values of which nothing is known. */
size_t nondet_size(void);
uint8_t nondet_byte(void);
bool nondet_bool(void);

#define RING_SIZE 32u

extern uint8_t ring_memory[RING_SIZE];

/* Any ring that init and its functions can have brought about, at any count of bytes. */
tmini_ring_t any_ring(void);

#endif
