/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A ring of received bytes: the only thing that the receive interrupt and the rest share.
 *
 * One producer (an interrupt, a DMA channel or a receiving task) and one consumer (the context
 * that parses), without locks. The producer functions are for the producer's context, init is for
 * before either runs; everything else is the consumer's.
 *
 *   CPU-fed ring   The producer hands over bytes. Once one has found the ring full, the ring is
 *                  closed: it refuses all that follows, and counts it, until the consumer has taken
 *                  everything stored before and opens it again. So bytes are never missing anywhere
 *                  but after the last one stored, however many were refused, and however often.
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

#include "../tmini_atomic.h"
#include "../tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The producer closes a ring by moving its index so far ahead, a quarter of what an index can
 * count, and the consumer opens it by moving its own as far: each has one writer. */
#define TMINI_RING_CLOSED (SIZE_MAX / 4 + 1)

/** The largest ring: an eighth of what an index can count, 8192 bytes where size_t has 16 bits. */
#define TMINI_RING_SIZE_MAX (TMINI_RING_CLOSED / 2)

/** A ring. Treat the members as private.
 *
 * The indices count bytes and wrap with size_t; the memory's size is a power of two, so that an
 * index modulo the size is always the right place. A side reads its own index as a plain variable:
 * nothing else writes it, so nothing can race with that; what the other side reads is stored
 * atomically.
 *
 * The producer remembers how far it may go: `stop` is one size ahead of the tail as it was when the
 * producer last looked, or the memory's end if that comes first, so that `origin` plus an index is
 * a place up to there. The tail never moves back. So a byte costs a comparison and two stores, and
 * only at the stop, about twice a lap, the producer looks at the tail again. When something else
 * moves head, stop moves with it, and the next byte looks. An all-zero ring has no room: it refuses
 * every byte. */
typedef struct {
    size_t head;      /**< Written by the producer: where the next byte goes. */
    size_t stop;      /**< The producer's own: where head must look at the tail again. */
    uintptr_t origin; /**< The producer's own: before stop, head's place is this plus head. */
    size_t tail;      /**< Written by the consumer: the oldest byte not yet given back. Head stops
                        * one size ahead of it. */
    uint8_t *memory;  /**< The caller's. */
    size_t overrun;   /**< Written by the producer: bytes refused. */
    size_t size;      /**< Of the memory. */
    size_t window;    /**< Unread bytes that are certainly intact: the size, with DMA half of it. */
} tmini_ring_t;

/** Empties the ring over `memory`, which the caller owns and keeps for as long as the ring is used.
 * `size` is a power of two, 2 to TMINI_RING_SIZE_MAX. The producer must not run meanwhile.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT (null pointer, wrong size): the ring then refuses every
 * byte. */
tmini_status_t tmini_ring_init(tmini_ring_t *ring, uint8_t *memory, size_t size, bool dma);

/* ----------------------------------------------------------------------- the producer's context */

/** Producer of a CPU-fed ring whose head is at its stop: what tmini_ring_put() does then. */
void tmini_ring_put_at_stop(tmini_ring_t *ring, uint8_t byte);

/** Producer of a CPU-fed ring: stores one byte. Interrupt-safe; no loop, no wait: 8 instructions on
 * Cortex-M4, at most 32 at the stop. Raises overrun when the ring is full or closed. In the header,
 * because a call would cost as much as the act. */
TMINI_INLINE void tmini_ring_put(tmini_ring_t *ring, uint8_t byte)
{
    const size_t head = ring->head;
    if (head == ring->stop) {
        tmini_ring_put_at_stop(ring, byte);
    } else {
        *(uint8_t *)(ring->origin + head) = byte; /* NOLINT(performance-no-int-to-ptr) */
        tmini_store(&ring->head, head + 1);
    }
}

/** Producer of a CPU-fed ring: stores as many of `count` bytes as fit, refuses the rest, and
 * returns how many were stored. Interrupt-safe; two block copies at most. */
size_t tmini_ring_write(tmini_ring_t *ring, const uint8_t *bytes, size_t count);

/** Producer of a CPU-fed ring: how many bytes tmini_ring_write() would store now, at least.
 * Interrupt-safe; no loop, no wait. */
size_t tmini_ring_room(const tmini_ring_t *ring);

/** Producer of a DMA ring: the hardware's next write goes to memory[position]; `position` equal to
 * the size means 0. It must never go back. Call it from the half-transfer, transfer-complete and
 * idle-line interrupts: the first two alone publish half a ring at once, and nothing is left for a
 * packet that has come in part. Interrupt-safe; no loop, no wait. */
void tmini_ring_publish(tmini_ring_t *ring, size_t position);

/** Producer: bytes were lost on their way here, after the last one stored, and their number is not
 * known: a receiver's queue overflowed, or circular DMA may have gone a whole lap unseen (then call
 * this before publishing). A CPU-fed ring is closed, as after an overrun; of a DMA ring a lap of
 * the oldest bytes counts as overwritten, and what is left beyond the window: so nothing is read a
 * second time, even if there was no lap. Interrupt-safe; no loop, no wait. */
void tmini_ring_gap(tmini_ring_t *ring);

/* ----------------------------------------------------------------------- the consumer's context */

/** The place in the stream where the next byte goes. It differs from what it was if bytes have been
 * stored since, or the ring has been closed. How far two places are apart tmini_ring_distance()
 * tells, not their difference: they leap when a ring is closed and opened. */
static inline size_t tmini_ring_head(const tmini_ring_t *ring)
{
    return tmini_load(&ring->head);
}

/** The place in the stream of the oldest byte that has not been given back. */
static inline size_t tmini_ring_tail(const tmini_ring_t *ring)
{
    return ring->tail;
}

/** How many bytes were stored between two places in the stream, below TMINI_RING_CLOSED. When `to`
 * lies before `from`, TMINI_RING_CLOSED less that number. */
static inline size_t tmini_ring_distance(size_t from, size_t to)
{
    return (to - from) % TMINI_RING_CLOSED;
}

/** Bytes stored and not yet discarded, below TMINI_RING_CLOSED. */
static inline size_t tmini_ring_unread(const tmini_ring_t *ring)
{
    return tmini_ring_distance(tmini_ring_tail(ring), tmini_ring_head(ring));
}

/** How far the head is ahead of the tail: bytes that are unread, and with DMA perhaps overwritten,
 * if it is more than the window; of a closed ring TMINI_RING_CLOSED more than are unread. */
static inline size_t tmini_ring_ahead(const tmini_ring_t *ring)
{
    return tmini_ring_head(ring) - tmini_ring_tail(ring);
}

/** True for a ring that DMA writes: what is unread may be overwritten, and it is never closed. */
static inline bool tmini_ring_is_dma(const tmini_ring_t *ring)
{
    return ring->window != ring->size;
}

/** True if bytes are missing after the last one stored: the ring is closed until all that it holds
 * has been discarded. */
static inline bool tmini_ring_is_closed(const tmini_ring_t *ring)
{
    return !tmini_ring_is_dma(ring) && tmini_ring_ahead(ring) > ring->window;
}

/** True if there is no room for a byte: the whole memory is unread, or the ring is closed. */
static inline bool tmini_ring_is_full(const tmini_ring_t *ring)
{
    return tmini_ring_ahead(ring) >= ring->size;
}

/** The unread byte `offset` bytes from the oldest, below tmini_ring_unread(). A larger offset reads
 * another byte of the ring's memory, never one outside it. */
static inline uint8_t tmini_ring_peek(const tmini_ring_t *ring, size_t offset)
{
    return ring->memory[(ring->tail + offset) & (ring->size - 1)];
}

/** True if nothing that has been read so far can have been overwritten. Only DMA can make it
 * false. */
bool tmini_ring_intact(const tmini_ring_t *ring);

/** Copies `count` unread bytes from `offset` on to `bytes`; offset + count is at most
 * tmini_ring_unread(). A loop over bytes, for a few of them. */
void tmini_ring_copy(const tmini_ring_t *ring, size_t offset, uint8_t *bytes, size_t count);

/** The unread bytes from `offset` on that lie in one piece, so that loops over them need not wrap:
 * at most *count, which becomes how many there are, at least one. */
static inline const uint8_t *tmini_ring_piece(const tmini_ring_t *ring, size_t offset,
                                              size_t *count)
{
    const size_t at = (ring->tail + offset) & (ring->size - 1);
    const size_t to_end = ring->size - at;
    if (*count > to_end) {
        *count = to_end;
    }
    return &ring->memory[at];
}

/** Gives the oldest `count` bytes back to the producer; at most tmini_ring_unread(). */
void tmini_ring_discard(tmini_ring_t *ring, size_t count);

/** Opens a closed ring again, once everything in it has been discarded. */
void tmini_ring_open(tmini_ring_t *ring);

/** The number of bytes refused since init, modulo the range of size_t. */
static inline size_t tmini_ring_overrun(const tmini_ring_t *ring)
{
    return tmini_load(&ring->overrun);
}

#ifdef __cplusplus
}
#endif

#endif
