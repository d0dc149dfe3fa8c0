/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Marked samples: no two of 8192 revolutions are equal, though the stream looks random. */

#include "simulator.h"

#define MARK_MASK 0xFFFFFFu /* 24 bits: those of a sample. */
#define SAMPLE_BITS 11u     /* The other 13 are for the revolution. */

/* Odd: a product by them, modulo 2^24, shows what was multiplied. */
#define FACTOR_A 0x9E3779u
#define FACTOR_B 0x85EBCBu

encode_sample_t sim_mark(const sim_t *sim, uint32_t revolution, uint32_t sample)
{
    const uint32_t key = (uint32_t)(sim->config.seed * 0xD6E8FEu);
    uint32_t mark = (((revolution << SAMPLE_BITS | sample) ^ key) * FACTOR_A) & MARK_MASK;
    mark ^= mark >> 13;
    mark = (mark * FACTOR_B) & MARK_MASK;
    return (encode_sample_t){.distance_mm = (uint16_t)(mark & 0x3FFFu),
                             .intensity = (uint8_t)(mark >> 16),
                             .flag = (uint8_t)(mark >> 14 & 3u)};
}
