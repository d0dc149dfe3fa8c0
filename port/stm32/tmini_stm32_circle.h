/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * How far circular DMA has come: what the port over the HAL and the ports on the registers share.
 * Private to them; it stands in a header so that each of them is a single source.
 *
 * Three contexts ask the DMA channel for its position and hand over what has come: the DMA's
 * interrupt (half and whole buffer), the UART's (idle line) and the poll. A position read by one
 * must not be used after a newer one of another; so whoever comes in while another is at it leaves
 * only a note, and the other goes round again. On one core this needs neither a lock nor interrupts
 * held back.
 *
 * A lap that nobody has seen. Whoever goes from one position to the next passes by the buffer's
 * middle, its end, or neither; and the DMA's interrupt tells of each passing once. A passing that
 * is told and was not on the way means that the way was longer by a lap. A way past both is one
 * that the interrupts have slept through, and it may have been longer by a lap as well. In both
 * cases more than half a buffer is new, and what has not been read of the rest is not trusted any
 * more. */

#ifndef TMINI_STM32_CIRCLE_H
#define TMINI_STM32_CIRCLE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "tmini/tmini.h"

#define TMINI_STM32_BAUD_RATE 230400u /**< Section 1. */

/** The DMA controllers count in 16 bits; a power of two is at most this. */
#define TMINI_STM32_CIRCLE_MAX 32768u

typedef struct {
    uint16_t size;
    uint16_t position;        /**< Handed over up to here. */
    volatile uint8_t middles; /**< Passings told; written by the DMA's interrupt alone. */
    volatile uint8_t ends;
    uint8_t known_middles; /**< As of the last advance. */
    uint8_t known_ends;
    int8_t untold_middles; /**< Passings seen and not told yet: 0 or 1. */
    int8_t untold_ends;
    volatile bool busy;  /**< Someone is handing over, */
    volatile bool again; /**< and someone else has come by meanwhile. */
} tmini_stm32_circle_t;

static inline void tmini_stm32_circle_begin(tmini_stm32_circle_t *circle, size_t size)
{
    *circle = (tmini_stm32_circle_t){.size = (uint16_t)size};
}

/** For the interrupt of the DMA channel: which flags it has served. */
static inline void tmini_stm32_circle_tell(tmini_stm32_circle_t *circle, bool middle, bool end)
{
    circle->middles = (uint8_t)(circle->middles + middle);
    circle->ends = (uint8_t)(circle->ends + end);
}

/** Whether the caller is the one who hands over now. */
static inline bool tmini_stm32_circle_enter(tmini_stm32_circle_t *circle)
{
    if (circle->busy) {
        circle->again = true;
        return false;
    }
    circle->busy = true;
    circle->again = false;
    return true;
}

/** Whether the caller has to hand over once more. */
static inline bool tmini_stm32_circle_leave(tmini_stm32_circle_t *circle)
{
    circle->busy = false;
    return circle->again && tmini_stm32_circle_enter(circle);
}

/** Whether more passings have been told than were on the way. */
static inline bool tmini_stm32_circle_settle(int8_t *untold, bool passed, uint8_t told)
{
    const int balance = *untold + passed - told;
    *untold = (int8_t)(balance > 0);
    return balance < 0;
}

/** Goes on to the position that the hardware shows, the size itself meaning 0. `middles` and `ends`
 * are the passings told before it was read. Returns true if a lap may have been missed on the
 * way. */
static inline bool tmini_stm32_circle_advance(tmini_stm32_circle_t *circle, uint16_t position,
                                              uint8_t middles, uint8_t ends)
{
    const uint16_t from = circle->position;
    const uint16_t to = position == circle->size ? 0 : position;
    const uint16_t half = circle->size / 2;
    const bool end = to < from;
    const bool middle = end ? from < half || to >= half : from < half && to >= half;
    const bool longer_by_middle = tmini_stm32_circle_settle(
        &circle->untold_middles, middle, (uint8_t)(middles - circle->known_middles));
    const bool longer_by_end =
        tmini_stm32_circle_settle(&circle->untold_ends, end, (uint8_t)(ends - circle->known_ends));
    circle->position = to;
    circle->known_middles = middles;
    circle->known_ends = ends;
    return longer_by_middle || longer_by_end || (middle && end);
}

/* ------------------------------------------------------------------- the lidar's receive buffer */

/** A lidar that is not set up has no room, and nothing has come; one that is full has had bytes. */
static inline bool tmini_stm32_circle_is_set_up(const tmini_t *lidar)
{
    return lidar != NULL && (tmini_feed_room(lidar) > 0 || tmini_feed_position(lidar) > 0);
}

/** 0 unless it was announced as the target of DMA (rx_dma). */
static inline size_t tmini_stm32_circle_size(const tmini_t *lidar)
{
    size_t size;
    (void)tmini_rx_buffer(lidar, &size);
    return size;
}

/** DMA that is started begins at the buffer's start, wherever it was before. The old bytes from
 * there to the end are overwritten, so that they cannot be taken for new packets, and passed.
 * Before reception begins, in the polling context. */
static inline void tmini_stm32_circle_rewind(tmini_t *lidar)
{
    size_t size;
    uint8_t *const memory = tmini_rx_buffer(lidar, &size);
    const size_t position = tmini_feed_position(lidar) & (size - 1);
    if (position > 0) {
        memset(&memory[position], 0, size - position);
        tmini_feed_dma(lidar, size);
    } else if (tmini_feed_position(lidar) > 0) {
        tmini_feed_gap(lidar); /* Nothing else would show that bytes are missing. */
    }
}

#endif
