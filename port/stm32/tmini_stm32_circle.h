/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The position of circular DMA: code that the port over the HAL and the ports on the registers
 * share. Private to them. It is a header so that each port remains a single source file.
 *
 * Three contexts read the DMA channel's position and hand over the bytes: the DMA's interrupt (half
 * and whole buffer), the UART's interrupt (idle line) and the poll. An older position must not be
 * used after a newer one. So a context that interrupts another during this work only sets a flag,
 * and the interrupted one repeats its work. On one core this needs no lock, and interrupts stay
 * enabled.
 *
 * Finding an unseen lap. Between two positions the DMA passes the buffer's middle, its end, both or
 * neither, and its interrupt reports each passing once. If a passing is reported that does not lie
 * between the two positions, DMA has written one more lap. If that is the middle, the end of the
 * same lap may follow: the HAL reports it just after. If both lie between them, the interrupts
 * were late, and DMA may have written one more lap, too. In both cases more than half of the buffer
 * is new, and unread bytes in the other part are no longer trusted. */

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
    uint16_t position;        /**< The bytes before this position have been handed over. */
    volatile uint8_t middles; /**< Reported passings; written only by the DMA's interrupt. */
    volatile uint8_t ends;
    uint8_t known_middles; /**< As of the last advance. */
    uint8_t known_ends;
    uint8_t unreported_middles; /**< Passings seen and not yet reported: 0 or 1. */
    uint8_t unreported_ends;
    volatile bool busy;  /**< A context is handing over. */
    volatile bool again; /**< Another context wanted to hand over meanwhile. */
} tmini_stm32_circle_t;

static inline void tmini_stm32_circle_begin(tmini_stm32_circle_t *circle, size_t size)
{
    memset(circle, 0, sizeof *circle);
    circle->size = (uint16_t)size;
}

/** For the DMA channel's interrupt: counts the passings that it reports. */
static inline void tmini_stm32_circle_report(tmini_stm32_circle_t *circle, bool middle, bool end)
{
    circle->middles = (uint8_t)(circle->middles + middle);
    circle->ends = (uint8_t)(circle->ends + end);
}

/** True if the caller is to hand over now; otherwise another context does. */
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

/** True if the caller has to hand over once more. */
static inline bool tmini_stm32_circle_leave(tmini_stm32_circle_t *circle)
{
    circle->busy = false;
    return circle->again && tmini_stm32_circle_enter(circle);
}

/** Moves to the position that the hardware shows; the buffer's size means 0. `middles` and `ends`
 * are the passings reported before the position was read. Returns true if a lap may have been
 * missed. */
static inline bool tmini_stm32_circle_advance(tmini_stm32_circle_t *circle, uint16_t position,
                                              uint8_t middles, uint8_t ends)
{
    const uint16_t from = circle->position;
    const uint16_t to = position == circle->size ? 0 : position;
    const uint16_t half = circle->size / 2;
    const bool end = to < from;
    const bool middle = end ? from < half || to >= half : from < half && to >= half;
    const int more_middles =
        circle->unreported_middles + middle - (uint8_t)(middles - circle->known_middles);
    const uint8_t reported_ends = (uint8_t)(ends - circle->known_ends);
    const int more_ends = circle->unreported_ends + end - reported_ends;
    const bool end_follows = more_middles < 0 && more_ends == 0 && reported_ends == 0;
    circle->position = to;
    circle->known_middles = middles;
    circle->known_ends = ends;
    circle->unreported_middles = more_middles > 0;
    circle->unreported_ends = more_ends > 0 || end_follows;
    return more_middles < 0 || more_ends < 0 || (middle && end);
}

/* ------------------------------------------------------------------- the lidar's receive buffer */

/** A lidar that is not set up has no room although no byte has come. */
static inline bool tmini_stm32_circle_is_set_up(const tmini_t *lidar)
{
    return lidar != NULL && (tmini_feed_room(lidar) > 0 || tmini_feed_position(lidar) > 0);
}

/** The buffer's size; 0 unless it is the target of DMA (rx_dma). */
static inline size_t tmini_stm32_circle_size(const tmini_t *lidar)
{
    size_t size;
    (void)tmini_rx_buffer(lidar, &size);
    return size;
}

/** When DMA is started, it begins at the buffer's start. So this skips the bytes from the old
 * position to the end. It clears them first, because they could look like new packets. Call it
 * before reception begins, in the polling context. */
static inline void tmini_stm32_circle_rewind(tmini_t *lidar)
{
    size_t size;
    uint8_t *const memory = tmini_rx_buffer(lidar, &size);
    const size_t position = tmini_feed_position(lidar) & (size - 1);
    if (position > 0) {
        memset(&memory[position], 0, size - position);
        tmini_feed_dma(lidar, size);
    } else if (tmini_feed_position(lidar) > 0) {
        tmini_feed_gap(lidar); /* Otherwise nothing shows that bytes are missing. */
    }
}

#endif
