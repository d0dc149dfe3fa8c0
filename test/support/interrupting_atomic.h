/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A TMINI_ATOMIC_HEADER for tests: calls interrupt() before and after each access of an index that
 * both sides use. There a test plays the interrupt, the DMA or the other core. */

#ifndef INTERRUPTING_ATOMIC_H
#define INTERRUPTING_ATOMIC_H

#include <stddef.h>

/* Defined by the test. */
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
