/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the proofs share. A proof is a function prove_…(): it sets up any state that the module's
 * invariants (invariants.h) allow, with any contents, calls one function, and claims; the model
 * checker tries all values at once. It ends with REACHED(), a claim that must turn out false: if it
 * did not, then no values satisfy what was assumed, and the proof would say nothing.
 *
 * The library is compiled with proof_atomic.h: between any two accesses of an index that both sides
 * use, the other side may act. */

#ifndef PROOF_H
#define PROOF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "invariants.h"
#include "tmini/tmini.h"

#define ASSUME(condition) __CPROVER_assume(condition)
#define CLAIM(condition) __CPROVER_assert(condition, #condition)
#define REACHED() __CPROVER_assert(0, "the end is not reached")

/* Values of which nothing is known. */
size_t nondet_size(void);
uint32_t nondet_word(void);
uint16_t nondet_half(void);
uint8_t nondet_byte(void);
int nondet_int(void);
bool any_bool(void);

#define RING_SIZE 32u

/* Twice as much where a reply must fit in half of it. */
#define LARGE_RING_SIZE 64u

extern uint8_t ring_memory[LARGE_RING_SIZE];

/* Any ring that init and its functions can have brought about, at any count of bytes, fed by the
 * CPU or by DMA. */
tmini_ring_t any_ring_of(size_t size);
tmini_ring_t any_ring(void);

/* The same, but its indices have just passed 0, or are about to: they are only ever subtracted from
 * one another and taken modulo the size. */
tmini_ring_t any_early_ring(size_t size);

/* Any parser on it, but that its counters, which are only ever added to, are 0. */
tmini_parser_t any_parser(tmini_ring_t *ring);

/* From now on bytes may come at each access of an index of `ring`: none, some, too many. */
void let_bytes_come(tmini_ring_t *ring);

/* True if some have, or may have, since bytes were last let come. */
bool have_bytes_come(void);

#endif
