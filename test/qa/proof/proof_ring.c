/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proofs of the ring, at any indices (also where they wrap): every access is inside its memory; a
 * byte that is put is later read unchanged, or is counted as refused; no unread byte is
 * overwritten. */

#include "proof.h"

void prove_ring_init(void)
{
    tmini_ring_t ring;
    const size_t size = nondet_size();
    const bool dma = any_bool();
    uint8_t *const memory = any_bool() ? ring_memory : NULL;
    const bool is_power = size == 2 || size == 4 || size == 8 || size == 16 || size == 32;
    ASSUME(size <= RING_SIZE);
    const tmini_status_t status = tmini_ring_init(&ring, memory, size, dma);
    CLAIM((status == TMINI_OK) == (memory != NULL && is_power));
    if (status == TMINI_OK) {
        CLAIM(ring_is_sound(&ring));
        CLAIM(tmini_ring_unread(&ring) == 0 && tmini_ring_overrun(&ring) == 0);
        CLAIM(ring.window == (dma ? size / 2 : size) && !tmini_ring_is_closed(&ring));
    } else {
        CLAIM(tmini_ring_room(&ring) == 0); /* The ring refuses every byte. */
        tmini_ring_put(&ring, 0);
        CLAIM(tmini_ring_overrun(&ring) == 1);
    }
    CLAIM(tmini_ring_init(NULL, memory, size, dma) == TMINI_ERROR_ARGUMENT);
}

void prove_ring_put(void)
{
    tmini_ring_t ring = any_ring();
    ASSUME(ring.window == ring.size);
    const size_t unread = tmini_ring_unread(&ring);
    const size_t offset = nondet_size();
    const uint8_t before = tmini_ring_peek(&ring, offset);
    const size_t refused = tmini_ring_overrun(&ring);
    const bool was_closed = tmini_ring_is_closed(&ring);
    const uint8_t byte = nondet_byte();
    CLAIM(tmini_ring_is_full(&ring) == (unread == RING_SIZE || was_closed));
    tmini_ring_put(&ring, byte);
    CLAIM(ring_is_sound(&ring));
    CLAIM(offset >= unread || tmini_ring_peek(&ring, offset) == before);
    if (unread == RING_SIZE || was_closed) {
        CLAIM(tmini_ring_is_closed(&ring));
        CLAIM(tmini_ring_unread(&ring) == unread && tmini_ring_overrun(&ring) == refused + 1);
    } else {
        CLAIM(!tmini_ring_is_closed(&ring));
        CLAIM(tmini_ring_unread(&ring) == unread + 1 && tmini_ring_overrun(&ring) == refused);
        CLAIM(tmini_ring_peek(&ring, unread) == byte);
    }
}

void prove_ring_write(void)
{
    tmini_ring_t ring = any_early_ring(RING_SIZE);
    ASSUME(ring.window == ring.size);
    uint8_t bytes[RING_SIZE + 3];
    for (size_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = nondet_byte();
    }
    const size_t count = nondet_size();
    const size_t unread = tmini_ring_unread(&ring);
    const size_t refused = tmini_ring_overrun(&ring);
    const size_t room = tmini_ring_is_closed(&ring) ? 0 : RING_SIZE - unread;
    const size_t offset = nondet_size();
    const uint8_t before = tmini_ring_peek(&ring, offset);
    ASSUME(count <= sizeof bytes);
    CLAIM(tmini_ring_room(&ring) == room);
    const size_t stored = tmini_ring_write(&ring, bytes, count);
    CLAIM(ring_is_sound(&ring));
    CLAIM(stored == (count < room ? count : room));
    CLAIM(tmini_ring_unread(&ring) == unread + stored);
    CLAIM(tmini_ring_overrun(&ring) - refused == count - stored);
    if (offset < unread) {
        CLAIM(tmini_ring_peek(&ring, offset) == before);
    } else if (offset - unread < stored) {
        CLAIM(tmini_ring_peek(&ring, offset) == bytes[offset - unread]);
    }
}

void prove_ring_publish(void)
{
    tmini_ring_t ring = any_ring();
    ASSUME(ring.window < ring.size);
    const size_t before = ring.head;
    const size_t position = nondet_size();
    tmini_ring_publish(&ring, position);
    CLAIM(ring_is_sound(&ring));
    CLAIM(ring.head - before < RING_SIZE); /* Less than a lap. */
    CLAIM(ring.head % RING_SIZE == position % RING_SIZE);
}

void prove_ring_gap(void)
{
    tmini_ring_t ring = any_ring();
    const size_t unread = tmini_ring_unread(&ring);
    const size_t ahead = tmini_ring_ahead(&ring);
    tmini_ring_gap(&ring);
    CLAIM(ring_is_sound(&ring));
    if (ring.window == ring.size) {
        CLAIM(tmini_ring_is_closed(&ring) && tmini_ring_room(&ring) == 0);
        CLAIM(tmini_ring_unread(&ring) == unread);
    } else {
        CLAIM(tmini_ring_ahead(&ring) == ahead + RING_SIZE);
    }
}

/* Bytes arrive meanwhile. */
void prove_ring_discard(void)
{
    tmini_ring_t ring = any_ring();
    const size_t tail = tmini_ring_tail(&ring);
    const size_t count = nondet_size();
    ASSUME(count <= tmini_ring_unread(&ring));
    let_bytes_come(&ring);
    tmini_ring_discard(&ring, count);
    let_bytes_come(NULL);
    CLAIM(ring_is_sound(&ring));
    CLAIM(tmini_ring_tail(&ring) == tail + count);
}

void prove_ring_open(void)
{
    tmini_ring_t ring = any_ring();
    ASSUME(tmini_ring_is_closed(&ring) && tmini_ring_unread(&ring) == 0);
    const size_t tail = tmini_ring_tail(&ring);
    tmini_ring_open(&ring);
    CLAIM(ring_is_sound(&ring) && !tmini_ring_is_closed(&ring));
    CLAIM(tmini_ring_unread(&ring) == 0 && tmini_ring_room(&ring) == RING_SIZE);
    CLAIM(tmini_ring_distance(tail, tmini_ring_tail(&ring)) == 0); /* No byte was skipped. */
}

void prove_ring_read(void)
{
    tmini_ring_t ring = any_ring();
    const size_t offset = nondet_size();
    const size_t wanted = nondet_size();
    const size_t index = nondet_size();
    uint8_t bytes[RING_SIZE + 1] = {0};
    size_t count = wanted;
    ASSUME(wanted >= 1 && wanted <= RING_SIZE && index < wanted);
    tmini_ring_copy(&ring, offset, bytes, wanted);
    CLAIM(bytes[index] == tmini_ring_peek(&ring, offset + index));
    CLAIM(bytes[wanted] == 0);
    const uint8_t *const piece = tmini_ring_piece(&ring, offset, &count);
    CLAIM(count >= 1 && count <= wanted);
    if (index < count) {
        CLAIM(piece[index] == bytes[index]); /* Also proves that this is inside the memory. */
    }
}
