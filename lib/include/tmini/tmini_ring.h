/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A ring of received bytes: the only thing that the receive interrupt and the rest share.
 *
 * One producer (an interrupt, a DMA channel or a receiving task) and one consumer (the context
 * that parses), without locks: each index is written by one side only. The three producer
 * functions are for the producer's context, init is for before either runs; everything else is
 * the consumer's.
 *
 *   CPU-fed ring   The producer hands over bytes. Those that find the ring full are refused,
 *                  counted, and never overwrite anything.
 *   DMA ring       Circular DMA writes straight into the ring's memory; the producer only
 *                  publishes how far. The hardware does not see the consumer and may overwrite
 *                  unread bytes: the consumer detects it, because no more than half the ring may
 *                  lie unread. The other half is what the hardware may be writing meanwhile. So
 *                  it must never be half a ring ahead of the position published last; and what is
 *                  published at once, with a packet that waits for its rest, must fit in half. */

#ifndef TMINI_RING_H
#define TMINI_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The indices count bytes since init and wrap with size_t; the memory's size is a power of two, so
 * that a count modulo the size is always the right place. An all-zero ring is safe: its head stands
 * at its limit, so it refuses every byte. Treat the members as private. */
typedef struct {
    uint8_t *memory;
    size_t mask;    /* The memory's size - 1. */
    size_t window;  /* Unread bytes that are certainly intact: the size, or half of it with DMA. */
    size_t head;    /* Written by the producer: bytes stored. */
    size_t refused; /* Written by the producer: bytes that found the ring full. */
    size_t limit;   /* Written by the consumer: where head must stop, one size ahead of tail. */
    size_t tail;    /* The consumer's own: bytes given back. */
} tmini_ring_t;

/* Empties the ring over `memory`, which the caller owns and keeps for as long as the ring is used.
 * `size` is a power of two. The producer must not run meanwhile.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT (null pointer, size not a power of two): the ring then
 * refuses every byte. */
tmini_status_t tmini_ring_init(tmini_ring_t *ring, uint8_t *memory, size_t size, bool dma);

/* Producer of a CPU-fed ring: stores one byte. Interrupt-safe; no loop, no wait. */
void tmini_ring_put(tmini_ring_t *ring, uint8_t byte);

/* Producer of a CPU-fed ring: stores as many of `count` bytes as fit and refuses the rest.
 * Interrupt-safe; two block copies at most. */
void tmini_ring_write(tmini_ring_t *ring, const uint8_t *bytes, size_t count);

/* Producer of a DMA ring: the hardware's next write goes to memory[position]; `position` equal to
 * the size means 0. It must never go back. Call it from the half-transfer, transfer-complete and
 * idle-line interrupts: the first two alone publish half a ring at once, and nothing is left for a
 * packet that has come in part. Interrupt-safe; no loop, no wait. */
void tmini_ring_publish(tmini_ring_t *ring, size_t position);

/* Consumer: the number of bytes stored since init, modulo the range of size_t. */
size_t tmini_ring_stored(const tmini_ring_t *ring);

/* Consumer: bytes stored and not yet discarded. More than `window` of them (DMA only) means that
 * the hardware may have overwritten the oldest. */
size_t tmini_ring_unread(const tmini_ring_t *ring);

/* Consumer: the unread byte `offset` bytes from the oldest, below tmini_ring_unread(). A larger
 * offset reads another byte of the ring's memory, never one outside it. */
uint8_t tmini_ring_peek(const tmini_ring_t *ring, size_t offset);

/* Consumer: true if nothing that has been read so far can have been overwritten. Only DMA can make
 * it false. */
bool tmini_ring_intact(const tmini_ring_t *ring);

/* Consumer: copies `count` unread bytes from `offset` on. */
void tmini_ring_copy(const tmini_ring_t *ring, size_t offset, uint8_t *bytes, size_t count);

/* Consumer: the three-byte samples from the unread byte `offset` on that lie in one piece, so that
 * the loops over samples, the hottest there are, run without wrapping. At most *count samples;
 * *count becomes how many there are. One that straddles the memory's end is put together in
 * `joined`. */
const uint8_t *tmini_ring_samples(const tmini_ring_t *ring, size_t offset, size_t *count,
                                  uint8_t joined[3]);

/* Consumer: gives the oldest `count` bytes back to the producer; at most tmini_ring_unread(). */
void tmini_ring_discard(tmini_ring_t *ring, size_t count);

/* Consumer: the number of bytes refused since init, modulo the range of size_t. */
size_t tmini_ring_refused(const tmini_ring_t *ring);

#ifdef __cplusplus
}
#endif

#endif
