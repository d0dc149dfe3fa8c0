/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "proof.h"

uint8_t ring_memory[RING_SIZE];

tmini_ring_t any_ring(void)
{
    for (size_t i = 0; i < RING_SIZE; i++) {
        ring_memory[i] = nondet_byte();
    }
    tmini_ring_t ring;
    const bool dma = nondet_bool();
    CLAIM(tmini_ring_init(&ring, ring_memory, RING_SIZE, dma) == TMINI_OK);
    ring.limit = nondet_size();
    ring.head = nondet_size();
    ring.overrun = nondet_size();
    ring.gate = nondet_bool() ? RING_SIZE - 1 : 0;
    ASSUME(ring.head - tmini_ring_tail(&ring) <=
           RING_SIZE); /* DMA may go further; see proof_ring.c. */
    return ring;
}
