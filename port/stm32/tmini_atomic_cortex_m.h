/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The library's memory-ordering primitives for IAR and ARMCC 5, on a Cortex-M with one core:
 *
 *     -DTMINI_ATOMIC_HEADER="\"tmini_atomic_cortex_m.h\""
 *
 * A size_t is read and written by one instruction, and a core sees its own accesses in order, so
 * only the compiler has to be stopped from moving them. The fence is a real instruction because of
 * DMA: a Cortex-M7 may read memory in another order than the program. */

#ifndef TMINI_ATOMIC_CORTEX_M_H
#define TMINI_ATOMIC_CORTEX_M_H

#include <stddef.h>

#if defined(__ICCARM__)
#include <intrinsics.h>
#define TMINI_KEEP_ORDER() __asm volatile("" ::: "memory")
#define TMINI_FENCE() __DMB()
#elif defined(__CC_ARM)
#define TMINI_KEEP_ORDER() __memory_changed()
#define TMINI_FENCE() __dmb(0xF)
#else
#error "tmini: GCC, Clang and ARM Compiler 6 need no header of their own"
#endif

static inline size_t tmini_load(const size_t *value)
{
    const size_t loaded = *(const volatile size_t *)value;
    TMINI_KEEP_ORDER();
    return loaded;
}

static inline void tmini_store(size_t *value, size_t stored)
{
    TMINI_KEEP_ORDER();
    *(volatile size_t *)value = stored;
}

static inline void tmini_fence(void)
{
    TMINI_FENCE();
    TMINI_KEEP_ORDER();
}

#endif
