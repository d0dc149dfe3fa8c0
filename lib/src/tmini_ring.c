/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_ring.h"

#include <string.h>

tmini_status_t tmini_ring_init(tmini_ring_t *ring, uint8_t *memory, size_t size, bool dma)
{
    if (ring == NULL) {
        return TMINI_ERROR_ARGUMENT;
    }
    *ring = (tmini_ring_t){0};
    if (memory == NULL || size < 2 || size > TMINI_RING_SIZE_MAX || (size & (size - 1)) != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    ring->memory = memory;
    ring->window = size >> (dma ? 1 : 0);
    tmini_store(&ring->size, size); /* Last: a byte that comes before this is refused. */
    return TMINI_OK;
}

/* How many bytes fit: head may be one size ahead of the tail. For a closed ring the result is
 * larger than the size. */
static size_t room_ahead(const tmini_ring_t *ring, size_t head)
{
    return tmini_load(&ring->tail) + ring->size - head;
}

/* Moves the head and makes the next tmini_ring_put() read the tail. */
TMINI_INLINE void move_head(tmini_ring_t *ring, size_t head)
{
    ring->stop = head;
    tmini_store(&ring->head, head);
}

/* Counts refused bytes. If the ring is full (no room), closes it. */
static void refuse(tmini_ring_t *ring, size_t room, size_t count)
{
    tmini_store(&ring->overrun, ring->overrun + count);
    if (room == 0) { /* Last: a consumer that sees the ring closed also sees all bytes and the
                      * count. */
        move_head(ring, ring->head + TMINI_RING_CLOSED);
    }
}

void tmini_ring_put_at_stop(tmini_ring_t *ring, uint8_t byte)
{
    const size_t head = ring->head;
    const size_t room = room_ahead(ring, head);
    if (room - 1 >= ring->size) { /* No room (0 - 1 wraps), or a closed ring. */
        refuse(ring, room, 1);
        return;
    }
    const size_t at = head & (ring->size - 1);
    uint8_t *const place = &ring->memory[at];
    const size_t to_end = ring->size - at;
    *place = byte;
    ring->origin = (uintptr_t)place - head;
    ring->stop = head + (room < to_end ? room : to_end);
    tmini_store(&ring->head, head + 1);
}

size_t tmini_ring_write(tmini_ring_t *ring, const uint8_t *bytes, size_t count)
{
    const size_t head = ring->head;
    const size_t room = room_ahead(ring, head);
    const size_t usable = room <= ring->size ? room : 0;
    const size_t taken = count < usable ? count : usable;
    if (taken > 0) {
        const size_t at = head & (ring->size - 1);
        const size_t to_end = ring->size - at;
        const size_t first = taken < to_end ? taken : to_end;
        memcpy(&ring->memory[at], bytes, first);
        if (first < taken) {
            memcpy(ring->memory, &bytes[first], taken - first);
        }
        move_head(ring, head + taken);
    }
    if (taken < count) {
        refuse(ring, room - taken, count - taken);
    }
    return taken;
}

/* The consumer can only make more room meanwhile, never less. */
size_t tmini_ring_room(const tmini_ring_t *ring)
{
    const size_t room = room_ahead(ring, ring->head);
    return room <= ring->size ? room : 0;
}

/* The position shows where in a lap the hardware is, but not which lap. So it is taken as the next
 * such place after the last one published. */
void tmini_ring_publish(tmini_ring_t *ring, size_t position)
{
    const size_t head = ring->head;
    if (ring->size > ring->window) { /* A DMA ring that has been set up. */
        move_head(ring, head + ((position - head) & (ring->size - 1)));
    }
}

void tmini_ring_gap(tmini_ring_t *ring)
{
    if (tmini_ring_is_dma(ring)) {
        move_head(ring, ring->head + ring->size); /* The unseen lap. */
    } else if (room_ahead(ring, ring->head) <= ring->size) {
        /* Closes an open ring, as a refused byte does, but counts no byte. */
        move_head(ring, ring->head + TMINI_RING_CLOSED);
    }
}

bool tmini_ring_intact(const tmini_ring_t *ring)
{
    if (!tmini_ring_is_dma(ring)) {
        return true;
    }
    tmini_fence(); /* All earlier reads come before this read of the producer's index. */
    return tmini_ring_ahead(ring) <= ring->window;
}

void tmini_ring_copy(const tmini_ring_t *ring, size_t offset, uint8_t *bytes, size_t count)
{
    /* In local variables, because the compiler must assume that `bytes` overlaps the ring. */
    const uint8_t *const memory = ring->memory;
    const size_t mask = ring->size - 1;
    size_t index = ring->tail + offset;
    for (const uint8_t *const end = bytes + count; bytes != end; bytes++) {
        *bytes = memory[index++ & mask];
    }
}
