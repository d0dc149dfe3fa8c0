/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ring, at any indices (also where they wrap): no function leaves its memory; a byte that is
 * put is the byte that is read, or is counted as refused; nothing that is unread is overwritten. */

#include "proof.h"

static void put_keeps_every_unread_byte(void)
{
    tmini_ring_t ring = any_ring();
    const size_t unread = tmini_ring_unread(&ring);
    const size_t offset = nondet_size();
    ASSUME(offset < unread);
    const uint8_t before = tmini_ring_peek(&ring, offset);
    const size_t refused = tmini_ring_overrun(&ring);
    const bool was_closed = tmini_ring_is_closed(&ring);
    const uint8_t byte = nondet_byte();
    tmini_ring_put(&ring, byte);
    CLAIM(tmini_ring_peek(&ring, offset) == before);
    if (unread == RING_SIZE || was_closed) {
        CLAIM(tmini_ring_is_closed(&ring));
        CLAIM(tmini_ring_unread(&ring) == unread && tmini_ring_overrun(&ring) == refused + 1);
    } else {
        CLAIM(tmini_ring_unread(&ring) == unread + 1 && tmini_ring_overrun(&ring) == refused);
        CLAIM(tmini_ring_peek(&ring, unread) == byte);
    }
}

static void write_stores_what_fits_and_counts_the_rest(void)
{
    tmini_ring_t ring = any_ring();
    uint8_t bytes[RING_SIZE + 3];
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = nondet_byte();
    }
    const size_t count = nondet_size();
    const size_t unread = tmini_ring_unread(&ring);
    const size_t refused = tmini_ring_overrun(&ring);
    const size_t room = tmini_ring_is_closed(&ring) ? 0 : RING_SIZE - unread;
    ASSUME(count <= sizeof bytes);
    tmini_ring_write(&ring, bytes, count);
    const size_t stored = tmini_ring_unread(&ring) - unread;
    CLAIM(stored == (count < room ? count : room));
    CLAIM(tmini_ring_overrun(&ring) - refused == count - stored);
    const size_t offset = nondet_size();
    if (offset < stored) {
        CLAIM(tmini_ring_peek(&ring, unread + offset) == bytes[offset]);
    }
}

static void publish_stays_below_one_round(void)
{
    tmini_ring_t ring = any_ring();
    const size_t before = ring.head;
    const size_t position = nondet_size();
    tmini_ring_publish(&ring, position);
    CLAIM(ring.head - before < RING_SIZE);
    CLAIM(ring.head % RING_SIZE == position % RING_SIZE);
}

static void pieces_lie_in_the_memory(void)
{
    tmini_ring_t ring = any_ring();
    const size_t offset = nondet_size();
    const size_t wanted = nondet_size();
    const size_t index = nondet_size();
    size_t count = wanted;
    ASSUME(wanted >= 1 && wanted <= RING_SIZE && offset <= RING_SIZE);
    const uint8_t *const piece = tmini_ring_piece(&ring, offset, &count);
    CLAIM(count >= 1 && count <= wanted);
    ASSUME(index < count);
    CLAIM(piece[index] == tmini_ring_peek(&ring, offset + index)); /* Also reads within bounds. */
}

int main(void)
{
    put_keeps_every_unread_byte();
    write_stores_what_fits_and_counts_the_rest();
    publish_stays_below_one_round();
    pieces_lie_in_the_memory();
    return 0;
}
