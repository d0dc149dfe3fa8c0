/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The memory-ordering primitives: the only place with compiler extensions.
 *
 * tmini_load() reads a size_t that the other side writes, and no later access moves before it;
 * tmini_store() writes one, and no earlier access moves behind it (acquire and release, in C11's
 * words). Both are one access wide, so that the other side sees the old value or the new one.
 * tmini_fence() keeps earlier reads before later ones.
 *
 * GCC and Clang map them to instructions that are right on several cores too (ESP32). For another
 * compiler, or a machine with needs of its own, name a header that defines the three functions:
 * -DTMINI_ATOMIC_HEADER='"my_atomic.h"'. */

#ifndef TMINI_ATOMIC_H
#define TMINI_ATOMIC_H

#include <stddef.h>

#if defined(TMINI_ATOMIC_HEADER)

#include TMINI_ATOMIC_HEADER

#elif defined(__AVR__)

/* A size_t takes two accesses on this 8-bit machine: keep interrupts out for those two. */
#include <util/atomic.h>

static inline size_t tmini_load(const size_t *value)
{
    size_t loaded;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        loaded = *(const volatile size_t *)value;
    }
    return loaded;
}

static inline void tmini_store(size_t *value, size_t stored)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        *(volatile size_t *)value = stored;
    }
}

static inline void tmini_fence(void)
{
    __asm__ volatile(
        "" ::
            : "memory"); /* One core that reads in order: only the compiler might not. */
}

#elif defined(__GNUC__)

static inline size_t tmini_load(const size_t *value)
{
    return __atomic_load_n(value, __ATOMIC_ACQUIRE);
}

static inline void tmini_store(size_t *value, size_t stored)
{
    __atomic_store_n(value, stored, __ATOMIC_RELEASE);
}

static inline void tmini_fence(void)
{
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
}

#else

#error "tmini: no memory-ordering primitives for this compiler; see TMINI_ATOMIC_HEADER above"

#endif

#endif
