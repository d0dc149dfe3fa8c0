/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Primitives: memory order between the two sides of the ring, access to several bytes at once, and
 * compiler hints for the innermost loops. This is the only file with compiler extensions.
 *
 * tmini_load() reads a size_t that the other side writes, and no later access moves before it;
 * tmini_store() writes one, and no earlier access moves after it (acquire and release, in C11's
 * words). Both act as a single access: the other side sees the old value or the new one.
 * tmini_fence() keeps earlier reads before later ones.
 *
 * GCC and Clang translate them to instructions that are also right on several cores (ESP32). A core
 * always sees its own accesses in order, also from its interrupts. With only one core it is enough
 * to stop the compiler from reordering, which costs nothing: TMINI_SINGLE_CORE is then 1. It is 1
 * on Cortex-M unless the chip is known to have two cores; to overrule that, define it as 0 or 1 for
 * the whole build. Where the processor itself may reorder reads (Cortex-M7), circular DMA acts like
 * another core: there tmini_fence() remains an instruction.
 *
 * For another compiler or an unusual machine, name a header that defines the three functions:
 * -DTMINI_ATOMIC_HEADER='"my_atomic.h"'. */

#ifndef TMINI_ATOMIC_H
#define TMINI_ATOMIC_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** @def TMINI_SINGLE_CORE
 * 1: feeding and polling run on the same core; 0: they may run on two. Define it to overrule the
 * default. */
#if !defined(TMINI_SINGLE_CORE)
#if defined(PICO_RP2040) || defined(PICO_RP2350) || defined(ARDUINO_ARCH_RP2040)
#define TMINI_SINGLE_CORE 0
#elif defined(__ARM_ARCH_PROFILE)
#define TMINI_SINGLE_CORE (__ARM_ARCH_PROFILE == 'M')
#else
#define TMINI_SINGLE_CORE 0
#endif
#endif

/** @def TMINI_INLINE
 * For functions where each instruction counts: at -Os a compiler might not inline them. */
#if defined(__GNUC__) && defined(__OPTIMIZE__)
#define TMINI_INLINE static inline __attribute__((always_inline))
#else
#define TMINI_INLINE static inline
#endif

/** @def TMINI_NOINLINE
 * For a function that must not share its registers, or its stack, with its caller, and for one
 * whose copies in all callers would be larger than the calls. */
#if defined(__GNUC__)
#define TMINI_NOINLINE __attribute__((noinline))
#else
#define TMINI_NOINLINE
#endif

/** @def TMINI_MUST_CHECK
 * For a function whose result a program must look at. */
#if defined(__GNUC__)
#define TMINI_MUST_CHECK __attribute__((warn_unused_result))
#else
#define TMINI_MUST_CHECK
#endif

/** @def TMINI_UNROLL
 * Before a loop that the compiler may unroll eight times when it optimises for speed. */
#if defined(__GNUC__) && __GNUC__ >= 8 && !defined(__clang__)
#define TMINI_UNROLL _Pragma("GCC unroll 8")
#else
#define TMINI_UNROLL
#endif

#if defined(TMINI_ATOMIC_HEADER)

#include TMINI_ATOMIC_HEADER

#elif defined(__AVR__)

/* This 8-bit machine needs two accesses for a size_t: interrupts are disabled meanwhile. */
#include <util/atomic.h>

/** Reads an index that the other side writes; no later access moves before it. Any context; two
 * accesses on this 8-bit machine, with interrupts disabled. */
TMINI_INLINE size_t tmini_load(const size_t *value)
{
    size_t loaded;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        loaded = *(const volatile size_t *)value;
    }
    return loaded;
}

/** Writes an index that the other side reads; no earlier access moves after it. Any context; two
 * accesses on this 8-bit machine, with interrupts disabled. */
TMINI_INLINE void tmini_store(size_t *value, size_t stored)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        *(volatile size_t *)value = stored;
    }
}

/** Keeps earlier reads before later ones. This core reads in order; only the compiler has to be
 * stopped. */
TMINI_INLINE void tmini_fence(void)
{
    __asm__ volatile("" ::: "memory");
}

#elif defined(__GNUC__) && TMINI_SINGLE_CORE

/** Reads an index that the other side writes; no later access moves before it. Any context; one
 * access. A plain read: the compiler may join it with a read of the neighbouring member (LDRD), but
 * may not reuse an earlier value. */
TMINI_INLINE size_t tmini_load(const size_t *value)
{
    const size_t loaded = *value;
    __asm__ volatile("" ::: "memory");
    return loaded;
}

/** Writes an index that the other side reads; no earlier access moves after it. Any context; one
 * access. */
TMINI_INLINE void tmini_store(size_t *value, size_t stored)
{
    __asm__ volatile("" ::: "memory");
    *(volatile size_t *)value = stored;
}

/** Keeps earlier reads before later ones. */
TMINI_INLINE void tmini_fence(void)
{
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
}

#elif defined(__GNUC__) && __GCC_ATOMIC_POINTER_LOCK_FREE < 2

/* A machine that loads and stores an index in one access, but has no instruction that also changes
 * it (Cortex-M0, rv32imc). Clang would call a library for the primitives below: the same barriers,
 * written out. */

/** Reads an index that the other side writes; no later access moves before it. Any context; one
 * access. */
TMINI_INLINE size_t tmini_load(const size_t *value)
{
    const size_t loaded = *(const volatile size_t *)value;
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    return loaded;
}

/** Writes an index that the other side reads; no earlier access moves after it. Any context; one
 * access. */
TMINI_INLINE void tmini_store(size_t *value, size_t stored)
{
    __atomic_thread_fence(__ATOMIC_RELEASE);
    *(volatile size_t *)value = stored;
}

/** Keeps earlier reads before later ones. */
TMINI_INLINE void tmini_fence(void)
{
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
}

#elif defined(__GNUC__)

/** Reads an index that the other side writes; no later access moves before it. Any context; one
 * access. */
TMINI_INLINE size_t tmini_load(const size_t *value)
{
    return __atomic_load_n(value, __ATOMIC_ACQUIRE);
}

/** Writes an index that the other side reads; no earlier access moves after it. Any context; one
 * access. */
TMINI_INLINE void tmini_store(size_t *value, size_t stored)
{
    __atomic_store_n(value, stored, __ATOMIC_RELEASE);
}

/** Keeps earlier reads before later ones. */
TMINI_INLINE void tmini_fence(void)
{
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
}

#else

#error "tmini: no memory-ordering primitives for this compiler; see TMINI_ATOMIC_HEADER above"

#endif

/** @def TMINI_COPY
 * Copies a constant number of bytes without a call, also where memcpy() is always one
 * (-ffreestanding, -fno-builtin). */
#if defined(__GNUC__) && !defined(TMINI_MEMCPY_ONLY) /* For a model checker. */
#define TMINI_COPY(to, from, size) __builtin_memcpy(to, from, size)
#else
#define TMINI_COPY(to, from, size) memcpy(to, from, size)
#endif

/** @def TMINI_WORD_ALIGNMENT
 * Words are loaded only from addresses that are a multiple of this: 4, or 1 where any address
 * works. If it is 1, words are also stored at any address. Do not set it yourself (a test does):
 * compilers make unaligned words of the library's other code, too. */
#if defined(TMINI_WORD_ALIGNMENT)
/* Set by a test. */
#elif defined(__ARM_FEATURE_UNALIGNED) || defined(__x86_64__) || defined(__i386__) || \
    defined(__riscv_misaligned_fast) || defined(__AVR__)
#define TMINI_WORD_ALIGNMENT 1u
#else
#define TMINI_WORD_ALIGNMENT 4u
#endif

/** Four bytes as a number, the first one lowest. The address is a multiple of TMINI_WORD_ALIGNMENT.
 * One load on little-endian machines. */
TMINI_INLINE uint32_t tmini_word(const uint8_t *bytes)
{
#if defined(__GNUC__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    uint32_t word;
    TMINI_COPY(&word, __builtin_assume_aligned(bytes, TMINI_WORD_ALIGNMENT), sizeof word);
    return word;
#else
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
#endif
}

/** Copies two bytes, the second one reduced to the bits in `mask`. One load and one store where
 * TMINI_WORD_ALIGNMENT is 1. */
TMINI_INLINE void tmini_copy_pair(uint8_t *to, const uint8_t *from, uint8_t mask)
{
    const uint8_t masks[] = {0xFF, mask};
    uint16_t pair;
    uint16_t pair_mask;
    TMINI_COPY(&pair, from, sizeof pair);
    TMINI_COPY(&pair_mask, masks, sizeof pair_mask);
    pair &= pair_mask;
    TMINI_COPY(to, &pair, sizeof pair);
}

/** Stores two numbers of 16 bits side by side: `first`, below 65536, and the upper half of
 * `second`. One store on ARM, which shifts as it combines. */
TMINI_INLINE void tmini_store_two(uint8_t *to, uint32_t first, uint32_t second)
{
#if defined(__ARM_FEATURE_UNALIGNED) && !defined(__ARM_BIG_ENDIAN)
    const uint32_t both = first | (second & 0xFFFF0000u);
    TMINI_COPY(to, &both, sizeof both);
#else
    const uint16_t low = (uint16_t)first;
    const uint16_t high = (uint16_t)(second >> 16);
    TMINI_COPY(to, &low, sizeof low);
    TMINI_COPY(to + sizeof low, &high, sizeof high);
#endif
}

#endif
