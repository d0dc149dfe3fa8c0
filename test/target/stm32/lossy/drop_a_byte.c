/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A deliberate fault, linked into the firmware by the linker's --wrap: of the bytes that the interrupt
 * receives, one now and then does not reach the library. The target test must find it. */

#include "tmini/tmini_ring.h"

#define INTERVAL 5000u

void __real_tmini_ring_put(tmini_ring_t *ring, uint8_t byte);
void __wrap_tmini_ring_put(tmini_ring_t *ring, uint8_t byte);

void __wrap_tmini_ring_put(tmini_ring_t *ring, uint8_t byte)
{
    static uint32_t count;
    count++;
    if (count % INTERVAL != 0) {
        __real_tmini_ring_put(ring, byte);
    }
}
