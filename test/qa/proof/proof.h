/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Shared by the proofs. A proof is a function prove_…(): it sets up any state that the module's
 * invariants (invariants.h) allow, with any contents, calls one function, and makes claims. The
 * model checker tries all values at once. After a proof, prove.py makes a claim that must fail:
 * otherwise no values satisfy the assumptions, and nothing would be proved.
 *
 * The library is compiled with proof_atomic.h: between any two accesses to an index that both sides
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

/* Return any value. */
size_t nondet_size(void);
uint32_t nondet_word(void);
uint16_t nondet_half(void);
uint8_t nondet_byte(void);
int nondet_int(void);
bool any_bool(void);

#define RING_SIZE 32u

/* Twice as large, so that a reply fits in half of it. */
#define LARGE_RING_SIZE 64u

extern uint8_t ring_memory[LARGE_RING_SIZE];

/* Any state of a ring that its functions can produce, at any indices, fed by the CPU or by DMA. */
tmini_ring_t any_ring_of(size_t size);
tmini_ring_t any_ring(void);

/* As above, but with indices near 0, before or after it. This suffices: indices are only subtracted
 * from one another and taken modulo the size. */
tmini_ring_t any_early_ring(size_t size);

/* Any state of a parser on this ring. Only its counters are 0: they are only ever increased. */
tmini_parser_t any_parser(tmini_ring_t *ring);

/* From now on any number of bytes may arrive at each access to an index of `ring`; NULL: none. */
void let_bytes_come(tmini_ring_t *ring);

/* True if bytes may have arrived since the last call of let_bytes_come() with a ring. */
bool have_bytes_come(void);

/* ---- The contract of the parser's functions: parser_contract.c ---- */

/* proof_parser.c proves that the parser keeps it. stubs.c, which replaces the parser in the
 * driver's proofs, assumes nothing else. */

/* True if the members are equal that only init and await may change. */
bool same_expectations(const tmini_parser_t *before, const tmini_parser_t *after);

/* The contract of tmini_parser_next(), which has returned `type`. */
bool next_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after,
                         tmini_frame_type_t type);

/* The contract of tmini_parser_skip_all() and tmini_parser_abandon(). */
bool skip_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after);

#endif
