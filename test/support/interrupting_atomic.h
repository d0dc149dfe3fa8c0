/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A TMINI_ATOMIC_HEADER for tests: before and after each access of an index that both sides use,
 * the test may be the interrupt, the DMA or the other core that comes just then. */

#ifndef INTERRUPTING_ATOMIC_H
#define INTERRUPTING_ATOMIC_H

#include <stddef.h>

/* The test's. */
void interrupt(void);

static inline size_t tmini_load(const size_t *value)
{
    interrupt();
    const size_t loaded = *(const volatile size_t *)value;
    interrupt();
    return loaded;
}

static inline void tmini_store(size_t *value, size_t stored)
{
    interrupt();
    *(volatile size_t *)value = stored;
    interrupt();
}

static inline void tmini_fence(void)
{
    interrupt();
}

#endif
