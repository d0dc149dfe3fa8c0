/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The TMINI_ATOMIC_HEADER of the proofs and of memory_model.c. In the proofs, the other side may
 * act at each access to an index that both sides use (any.c); memory_model.c decides what each
 * access sees if two cores make them. */

#ifndef PROOF_ATOMIC_H
#define PROOF_ATOMIC_H

#include <stddef.h>

/* The model checker does not know this builtin. */
#define __builtin_assume_aligned(address, alignment) (address)

size_t tmini_load(const size_t *value);
void tmini_store(size_t *value, size_t stored);
void tmini_fence(void);

#endif
