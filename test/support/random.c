/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "random.h"

/* A counter run through an invertible mixing function: any two seeds give unrelated sequences. */
static uint64_t mix(uint64_t x)
{
    x = (x ^ (x >> 32)) * UINT64_C(0xD6E8FEB86659FD93);
    x = (x ^ (x >> 32)) * UINT64_C(0xD6E8FEB86659FD93);
    return x ^ (x >> 32);
}

void random_seed(random_t *random, uint64_t seed)
{
    random->state = mix(seed + UINT64_C(0x9E3779B97F4A7C15));
}

uint64_t random_u64(random_t *random)
{
    random->state += UINT64_C(0x9E3779B97F4A7C15);
    return mix(random->state);
}

uint32_t random_u32(random_t *random)
{
    return (uint32_t)(random_u64(random) >> 32);
}

uint32_t random_below(random_t *random, uint32_t limit)
{
    return (uint32_t)(((uint64_t)random_u32(random) * limit) >> 32);
}

uint32_t random_between(random_t *random, uint32_t low, uint32_t high)
{
    return low + random_below(random, high - low + 1u);
}

/* log2(x) for x >= 1 as a 16.16 number: the integer part is the top bit's place; each squaring of
 * the mantissa then yields one more bit of the fraction. */
static uint32_t log2_q16(uint32_t x)
{
    uint32_t result = 31;
    uint64_t mantissa = x;
    while ((mantissa & UINT64_C(0x80000000)) == 0) {
        mantissa <<= 1;
        result--;
    }
    for (int bit = 0; bit < 16; bit++) {
        mantissa = (mantissa * mantissa) >> 31;
        result <<= 1;
        if (mantissa >= UINT64_C(0x100000000)) {
            mantissa >>= 1;
            result |= 1u;
        }
    }
    return result;
}

/* -ln(u) for u uniform in (0, 1]: ln(2) * (32 - log2(u * 2^32)). */
uint64_t random_gap(random_t *random, uint32_t mean)
{
    const uint32_t ln2_q16 = 45426;
    const uint32_t draw = random_u32(random) | 1u;
    const uint64_t log_q16 = UINT64_C(32) * 65536u - log2_q16(draw);
    const uint64_t exponential_q16 = (log_q16 * ln2_q16) >> 16;
    return ((exponential_q16 * mean) >> 16) + 1u;
}
