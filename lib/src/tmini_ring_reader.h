/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The consumer's side of the ring, inline: these run for every byte. */

#ifndef TMINI_RING_READER_H
#define TMINI_RING_READER_H

#include "tmini/tmini_ring.h"
#include "tmini_atomic.h"

static inline size_t ring_unread(const tmini_ring_t *ring)
{
    return tmini_load(&ring->head) - ring->tail;
}

static inline uint8_t ring_peek(const tmini_ring_t *ring, size_t offset)
{
    return ring->memory[(ring->tail + offset) & ring->mask];
}

static inline void ring_copy(const tmini_ring_t *ring, size_t offset, uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        bytes[i] = ring_peek(ring, offset + i);
    }
}

static inline void ring_discard(tmini_ring_t *ring, size_t count)
{
    ring->tail += count;
    tmini_store(&ring->limit, ring->tail + ring->mask + 1);
}

/* The samples (three bytes each) from the unread byte `offset` on that lie in one piece: at most
 * *count, which becomes their number. One that straddles the memory's end is put together in
 * `joined`. Lets the loops over samples, the hottest there are, run without wrapping. */
static inline const uint8_t *ring_samples(const tmini_ring_t *ring, size_t offset, size_t *count,
                                          uint8_t joined[3])
{
    const size_t at = (ring->tail + offset) & ring->mask;
    const size_t to_end = ring->mask + 1 - at;
    if (3 * *count <= to_end) {
        return &ring->memory[at];
    }
    if (to_end >= 3) {
        *count = to_end / 3;
        return &ring->memory[at];
    }
    for (size_t i = 0; i < 3; i++) {
        joined[i] = ring->memory[(at + i) & ring->mask];
    }
    *count = 1;
    return joined;
}

#endif
