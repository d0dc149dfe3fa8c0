/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The proofs' TMINI_ATOMIC_HEADER: at each access to an index that both sides use, the other side
 * may act (any.c). memory_model.c checks the order in which two cores see these accesses. */

#ifndef PROOF_ATOMIC_H
#define PROOF_ATOMIC_H

#include <stddef.h>

/* The model checker does not know this builtin. */
#define __builtin_assume_aligned(address, alignment) (address)

void proof_access(void);

static inline size_t tmini_load(const size_t *value)
{
    proof_access();
    return *value;
}

static inline void tmini_store(size_t *value, size_t stored)
{
    *value = stored;
    proof_access();
}

static inline void tmini_fence(void)
{
    proof_access();
}

#endif
