/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Marked samples: which sample of which revolution, scrambled so that the stream looks random. */

#include "simulator.h"

#define MARK_MASK 0xFFFFFFu /* 24 bits: those of a sample. */
#define SAMPLE_MASK ((1u << SIM_MARK_SAMPLE_BITS) - 1u)

/* Odd numbers and, modulo 2^24, their inverses. */
#define FACTOR_A 0x9E3779u
#define FACTOR_B 0x85EBCBu

static uint32_t inverse(uint32_t odd)
{
    uint32_t x = odd;
    for (unsigned round = 0; round < 4; round++) {
        x = x * (2u - odd * x);
    }
    return x & MARK_MASK;
}

static uint32_t key_of(const sim_t *sim)
{
    return (uint32_t)(sim->config.seed * 0xD6E8FEu) & MARK_MASK;
}

encode_sample_t sim_mark(const sim_t *sim, uint32_t revolution, uint32_t sample)
{
    const uint32_t plain = (revolution << SIM_MARK_SAMPLE_BITS | sample) ^ key_of(sim);
    uint32_t mark = (plain * FACTOR_A) & MARK_MASK;
    mark ^= mark >> 13;
    mark = (mark * FACTOR_B) & MARK_MASK;
    return (encode_sample_t){.distance_mm = (uint16_t)(mark & 0x3FFFu),
                             .intensity = (uint8_t)(mark >> 16),
                             .flag = (uint8_t)(mark >> 14 & 3u)};
}

void sim_read_mark(const sim_t *sim, encode_sample_t point, uint32_t *revolution, uint32_t *sample)
{
    const uint32_t mark =
        (uint32_t)point.intensity << 16 | (uint32_t)point.flag << 14 | point.distance_mm;
    uint32_t plain = (mark * inverse(FACTOR_B)) & MARK_MASK;
    plain ^= plain >> 13;
    plain = ((plain * inverse(FACTOR_A)) & MARK_MASK) ^ key_of(sim);
    *revolution = plain >> SIM_MARK_SAMPLE_BITS;
    *sample = plain & SAMPLE_MASK;
}
