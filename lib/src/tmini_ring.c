/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_ring.h"

#include <string.h>

#include "tmini_atomic.h"

tmini_status_t tmini_ring_init(tmini_ring_t *ring, uint8_t *memory, size_t size, bool dma)
{
    if (ring == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *ring = (tmini_ring_t){0};
    if (memory == NULL || size == 0 || (size & (size - 1)) != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    ring->memory = memory;
    ring->mask = size - 1;
    ring->window = dma ? size / 2 : size;
    tmini_store(&ring->limit, size); /* Last: until then a byte that comes early is refused. */
    return TMINI_OK;
}

void tmini_ring_put(tmini_ring_t *ring, uint8_t byte)
{
    const size_t head = ring->head;
    if (head == tmini_load(&ring->limit)) {
        tmini_store(&ring->refused, ring->refused + 1);
        return;
    }
    ring->memory[head & ring->mask] = byte;
    tmini_store(&ring->head, head + 1);
}

void tmini_ring_write(tmini_ring_t *ring, const uint8_t *bytes, size_t count)
{
    const size_t head = ring->head;
    const size_t room = tmini_load(&ring->limit) - head;
    const size_t taken = count < room ? count : room;
    if (taken > 0) {
        const size_t at = head & ring->mask;
        const size_t to_end = ring->mask + 1 - at;
        const size_t first = taken < to_end ? taken : to_end;
        memcpy(&ring->memory[at], bytes, first);
        memcpy(ring->memory, &bytes[first], taken - first);
        tmini_store(&ring->head, head + taken);
    }
    if (taken < count) {
        tmini_store(&ring->refused, ring->refused + (count - taken));
    }
}

void tmini_ring_publish(tmini_ring_t *ring, size_t position)
{
    const size_t head = ring->head;
    tmini_store(&ring->head, head + ((position - head) & ring->mask));
}

bool tmini_ring_intact(const tmini_ring_t *ring)
{
    tmini_fence(); /* What has been read was read before the producer's index is read again. */
    return tmini_ring_unread(ring) <= ring->window;
}

size_t tmini_ring_stored(const tmini_ring_t *ring)
{
    return tmini_load(&ring->head);
}

size_t tmini_ring_unread(const tmini_ring_t *ring)
{
    return tmini_load(&ring->head) - ring->tail;
}

uint8_t tmini_ring_peek(const tmini_ring_t *ring, size_t offset)
{
    return ring->memory[(ring->tail + offset) & ring->mask];
}

void tmini_ring_copy(const tmini_ring_t *ring, size_t offset, uint8_t *bytes, size_t count)
{
    /* In locals, because `bytes` might overlap the ring for all the compiler knows. */
    const uint8_t *const memory = ring->memory;
    const size_t mask = ring->mask;
    size_t index = ring->tail + offset;
    for (const uint8_t *const end = bytes + count; bytes != end; bytes++) {
        *bytes = memory[index++ & mask];
    }
}

const uint8_t *tmini_ring_samples(const tmini_ring_t *ring, size_t offset, size_t *count,
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
        joined[i] = tmini_ring_peek(ring, offset + i);
    }
    *count = 1;
    return joined;
}

void tmini_ring_discard(tmini_ring_t *ring, size_t count)
{
    ring->tail += count;
    tmini_store(&ring->limit, ring->tail + ring->mask + 1);
}

size_t tmini_ring_refused(const tmini_ring_t *ring)
{
    return tmini_load(&ring->refused);
}
