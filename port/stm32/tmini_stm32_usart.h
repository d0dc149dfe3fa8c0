/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A tmini port for STM32 without the HAL, on the USART's registers; it also works together with LL.
 * Compile the one source that fits the family:
 *
 *   tmini_stm32_usart_dr.c    registers SR and DR: F1, F2, F4, L1
 *   tmini_stm32_usart_rdr.c   registers ISR and RDR: all others (C0, F0, F3, F7, G0, G4, H5, H7,
 *                             L0, L4, L5, U0, U5, WB, WL, …), and every LPUART
 *
 * In the program:
 *
 *     static const tmini_stm32_usart_wiring_t wiring = {
 *         .usart = USART1, .clock_hz = 84000000, .time_ms = &time_ms};
 *     tmini_stm32_usart_init(&port, &wiring);
 *     config.port = &tmini_stm32_usart_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_stm32_usart_start(&port, &lidar);    an interrupt per byte; with rx_dma, by DMA
 *     NVIC_EnableIRQ(USART1_IRQn);
 *     …
 *     tmini_stm32_usart_stop(&port);
 *
 *     void USART1_IRQHandler(void) { tmini_stm32_usart_interrupt(&port); }
 *
 * Yours: the clocks of USART, DMA and pins, the pins' alternate function, the DMA channel,
 * interrupts in the NVIC, and a count of milliseconds. README.md beside this file shows a DMA
 * channel. */

#ifndef TMINI_STM32_USART_H
#define TMINI_STM32_USART_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini/tmini.h"
#include "tmini_stm32_circle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The hardware that the port uses. */
typedef struct {
    volatile void *usart; /**< The USART's base address: for example USART1 of ST's headers. */
    uint32_t clock_hz; /**< The USART's clock, at least 3.7 MHz; 0: baud rate and format are set up
                        * already. */
    const volatile uint32_t *time_ms;   /**< Milliseconds, counted by an interrupt of yours. */
    const volatile uint32_t *remaining; /**< For rx_dma: the DMA channel's register of items left
                                           (NDTR, CNDTR, CBR1). */
} tmini_stm32_usart_wiring_t;

/** Running totals, for diagnostics. With DMA, several errors between two looks at the USART (idle
 * line, half a buffer, poll) count as one. */
typedef struct {
    uint32_t bytes;          /**< Received by interrupt; compare with tmini_counters(). */
    uint32_t overruns;       /**< Bytes came faster than interrupt or DMA took them. */
    uint32_t framing_errors; /**< A stop bit was missing: wrong baud rate, noise? */
    uint32_t noise_errors;   /**< A bit's samples differed. */
    uint32_t laps;           /**< How often DMA may have written an unseen lap, because interrupts
                              * were too late. */
} tmini_stm32_usart_counters_t;

/** One lidar's USART. Treat the members as private. */
typedef struct {
    /** @cond private */
    tmini_stm32_usart_wiring_t wiring;
    tmini_t *lidar;              /* NULL: not receiving. */
    tmini_stm32_circle_t circle; /* Of size 0: one interrupt per byte. */
    uint32_t line_flags;         /* Errors that have been counted and whose flags are still set. */
    volatile tmini_stm32_usart_counters_t counters;
    /** @endcond */
} tmini_stm32_usart_t;

/** The `port` of tmini_config_t; its `port_context` is the address of a tmini_stm32_usart_t. Never
 * waits: takes as many bytes as the transmitter has room for. When the lidar is lost, it sets the
 * USART up again. */
extern const tmini_port_t tmini_stm32_usart_port;

/** Copies the wiring. Touches no register. From the polling context. Returns TMINI_OK, or
 * TMINI_ERROR_ARGUMENT: a null pointer (`remaining` may be null), or a clock that makes no baud
 * rate within 2 % of 230400. */
tmini_status_t tmini_stm32_usart_init(tmini_stm32_usart_t *port,
                                      const tmini_stm32_usart_wiring_t *wiring);

/** Sets the USART to 230400 8N1, if `clock_hz` is given, and receives for `lidar`, set up by
 * tmini_init(): by an interrupt per byte; or, with rx_dma, by circular DMA into the buffer given
 * there, of 512 to 32768 bytes. Before that, set up and enable the DMA channel: from the USART's
 * data register, byte-wide, circular, FIFO off, at the buffer's start, over its whole size. If the
 * processor has a data cache, the buffer must be in memory that is not cached. After _stop() set
 * the channel up again before the next start.
 * Returns TMINI_OK;
 *   TMINI_ERROR_STATE     port or lidar not set up
 *   TMINI_ERROR_ARGUMENT  with rx_dma: `remaining` is null or differs from the buffer's size */
tmini_status_t tmini_stm32_usart_start(tmini_stm32_usart_t *port, tmini_t *lidar);

/** Ends reception: no more interrupts, no more requests to the DMA channel. Disable the channel
 * yourself. Bytes received before are handed over. Sending still works. From the polling
 * context. */
void tmini_stm32_usart_stop(tmini_stm32_usart_t *port);

/** Returns the counters of errors so far. From the polling context. */
void tmini_stm32_usart_counters(const tmini_stm32_usart_t *port,
                                tmini_stm32_usart_counters_t *counters);

/** Call it from the USART's interrupt. No loop over bytes, no wait. A byte with a framing or noise
 * error is counted and stored: the packet's checksum decides whether it is used. */
void tmini_stm32_usart_interrupt(tmini_stm32_usart_t *port);

/** Call it from the DMA channel's interrupt with the flags that it found and has cleared. If both
 * were set, pass both in one call: they show that the interrupt was late. */
void tmini_stm32_usart_dma_interrupt(tmini_stm32_usart_t *port, bool half, bool complete);

#ifdef __cplusplus
}
#endif

#endif
