/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A ring of received bytes: the only data that the receive interrupt shares with the rest.
 *
 * One producer (an interrupt, a DMA channel or a receiving task) and one consumer (the context
 * that parses), without locks. The producer calls the producer's functions, the consumer all
 * others. Call init before either runs.
 *
 *   CPU-fed ring   The producer hands over bytes. Once a byte has found the ring full, the ring is
 *                  closed: it refuses and counts all bytes until the consumer has taken
 *                  everything stored and opens it again. So bytes can be missing only after the
 *                  last one stored.
 *   DMA ring       Circular DMA writes straight into the ring's memory; the producer only
 *                  publishes how far. The hardware does not see the consumer and may overwrite
 *                  unread bytes. The consumer detects this, because at most half the ring may be
 *                  unread: the hardware may be writing to the other half. So the hardware must
 *                  never be half a ring ahead of the position published last. And half a ring must
 *                  hold an incomplete packet and the bytes published next. */

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

/** The producer closes a ring by moving its index this far ahead, a quarter of an index's range.
 * The consumer opens it by moving its own index by the same distance. So each index has one
 * writer. */
#define TMINI_RING_CLOSED (SIZE_MAX / 4 + 1)

/** The largest ring, in bytes: an eighth of an index's range; 8192 if size_t has 16 bits. */
#define TMINI_RING_SIZE_MAX (TMINI_RING_CLOSED / 2)

/** A ring. Treat the members as private.
 *
 * The indices count bytes and wrap with size_t. The memory's size is a power of two, so that an
 * index modulo the size is always the right place. Each side reads its own index as a plain
 * variable, because only this side writes it. It stores the index atomically for the other side.
 *
 * The producer remembers how far it may write, so that a byte costs one comparison and two stores.
 * `stop` is one size ahead of the tail that the producer saw last (the tail never moves back), or
 * the memory's end if that comes first. Up to there `origin` plus an index is an address. At the
 * stop, about twice per lap, the producer reads the tail again. All other functions that move
 * `head` move `stop` with it, so that the next byte reads the tail again. An all-zero ring has no
 * room and refuses every byte. */
typedef struct {
    size_t head;      /**< Written by the producer: the place of the next byte. */
    size_t stop;      /**< The producer's own: where it must read the tail again. */
    uintptr_t origin; /**< The producer's own: while head is below stop, origin + head is the
                       * address of the next byte. */
    size_t tail;      /**< Written by the consumer: the oldest byte not yet given back. Head is at
                       * most one size ahead. */
    uint8_t *memory;  /**< The caller's memory. */
    size_t overrun;   /**< Written by the producer: bytes refused. */
    size_t size;      /**< Size of the memory. */
    size_t window;    /**< How many unread bytes are certainly intact: the size; with DMA half of
                       * it. */
} tmini_ring_t;

/** Sets up an empty ring over `memory`, which stays the caller's and must outlive the ring. `size`
 * is a power of two, 2 to TMINI_RING_SIZE_MAX. `dma`: circular DMA writes the memory. The producer
 * must not run meanwhile.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT (null pointer, wrong size): the ring then refuses every
 * byte. */
tmini_status_t tmini_ring_init(tmini_ring_t *ring, uint8_t *memory, size_t size, bool dma);

/* ----------------------------------------------------------------------- the producer's context */

/** Producer of a CPU-fed ring: the part of tmini_ring_put() for a head that is at its stop. */
void tmini_ring_put_at_stop(tmini_ring_t *ring, uint8_t byte);

/** Producer of a CPU-fed ring: stores one byte. Interrupt-safe; no loop, no wait: 8 instructions on
 * Cortex-M4, at most 32 at the stop. Counts an overrun when the ring is full or closed. In the
 * header, because a call would cost as much as the work. */
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

/** Producer of a CPU-fed ring: stores those of `count` bytes that fit, refuses the rest, and
 * returns how many were stored. Interrupt-safe; at most two block copies. */
size_t tmini_ring_write(tmini_ring_t *ring, const uint8_t *bytes, size_t count);

/** Producer of a CPU-fed ring: how many bytes tmini_ring_write() would store now, at least.
 * Interrupt-safe; no loop, no wait. */
size_t tmini_ring_room(const tmini_ring_t *ring);

/** Producer of a DMA ring: the hardware's next write goes to memory[position]; `position` equal to
 * the size means 0. It must never go back. Call it from the half-transfer, transfer-complete and
 * idle-line interrupts: the first two alone publish half a ring at once, which leaves no room for
 * the part of a packet that came before. Interrupt-safe; no loop, no wait. */
void tmini_ring_publish(tmini_ring_t *ring, size_t position);

/** Producer: an unknown number of bytes was lost after the last one stored (tmini_feed_gap()
 * explains why). A CPU-fed ring is closed, as after an overrun. In a DMA ring one lap of the oldest
 * bytes counts as overwritten, and then all that exceeds the window. Interrupt-safe; no loop, no
 * wait. */
void tmini_ring_gap(tmini_ring_t *ring);

/* ----------------------------------------------------------------------- the consumer's context */

/** The place in the stream of the next byte to come. It changes when bytes are stored, and when the
 * ring is closed. Compare places with tmini_ring_distance(), not by subtraction: they jump when a
 * ring is closed and opened. */
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

/** How many bytes are stored and not yet discarded; below TMINI_RING_CLOSED. */
static inline size_t tmini_ring_unread(const tmini_ring_t *ring)
{
    return tmini_ring_distance(tmini_ring_tail(ring), tmini_ring_head(ring));
}

/** How far the head is ahead of the tail. For an open ring this is the number of unread bytes; with
 * DMA some of them may be overwritten if it exceeds the window. For a closed ring it is
 * TMINI_RING_CLOSED more than the number of unread bytes. */
static inline size_t tmini_ring_ahead(const tmini_ring_t *ring)
{
    return tmini_ring_head(ring) - tmini_ring_tail(ring);
}

/** True for a ring that DMA writes: unread bytes may be overwritten, and it is never closed. */
static inline bool tmini_ring_is_dma(const tmini_ring_t *ring)
{
    return ring->window != ring->size;
}

/** True if bytes are missing after the last one stored: the ring stays closed until everything in
 * it has been discarded. */
static inline bool tmini_ring_is_closed(const tmini_ring_t *ring)
{
    return !tmini_ring_is_dma(ring) && tmini_ring_ahead(ring) > ring->window;
}

/** True if there is no room for a byte: the whole memory is unread, or the ring is closed. */
static inline bool tmini_ring_is_full(const tmini_ring_t *ring)
{
    return tmini_ring_ahead(ring) >= ring->size;
}

/** The unread byte at `offset`, counted from the oldest; `offset` is below tmini_ring_unread(). A
 * larger offset reads some other byte of the ring's memory, never one outside it. */
static inline uint8_t tmini_ring_peek(const tmini_ring_t *ring, size_t offset)
{
    return ring->memory[(ring->tail + offset) & (ring->size - 1)];
}

/** True if nothing that has been read so far can have been overwritten. Only DMA can make it
 * false. */
bool tmini_ring_intact(const tmini_ring_t *ring);

/** Copies `count` unread bytes from `offset` on to `bytes`; offset + count is at most
 * tmini_ring_unread(). A loop per byte: meant for a few bytes. */
void tmini_ring_copy(const tmini_ring_t *ring, size_t offset, uint8_t *bytes, size_t count);

/** Returns the unread bytes from `offset` on that are contiguous in memory, so that loops over them
 * need not wrap. `*count` is how many are wanted (at least one), and becomes how many there are (at
 * least one). */
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
TMINI_INLINE void tmini_ring_discard(tmini_ring_t *ring, size_t count)
{
    tmini_store(&ring->tail, ring->tail + count); /* Completes all reads before. */
}

/** Opens a closed ring again, once everything in it has been discarded. */
static inline void tmini_ring_open(tmini_ring_t *ring)
{
    tmini_ring_discard(ring, TMINI_RING_CLOSED);
}

/** The number of bytes refused since init, modulo the range of size_t. */
static inline size_t tmini_ring_overrun(const tmini_ring_t *ring)
{
    return tmini_load(&ring->overrun);
}

#ifdef __cplusplus
}
#endif

#endif
