/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar on a UART of an RP2040 or RP2350 (Raspberry Pi Pico, Pico 2), with the Pico SDK.
 *
 *     TMINI_PICO_RING(ring, 1024);
 *     static tmini_pico_t port;
 *     static tmini_t lidar;
 *
 *     const tmini_pico_wiring_t wiring = {
 *         .uart = uart1, .tx_pin = 4, .rx_pin = 5, .ring = ring, .ring_size = sizeof ring,
 *     };
 *     tmini_pico_init(&port, &wiring);
 *     config.port = &tmini_pico_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_pico_start(&port, &lidar);      bytes come
 *     tmini_start(&lidar);                   the lidar scans
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN: use(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_NONE: tmini_pico_wait(&port, 10); break;
 *         default: break;
 *         }
 *     }
 *
 * With a ring, two DMA channels take turns writing into it without end and without any interrupt;
 * tmini_pico_wait() takes out the new bytes. Without a ring (`ring` NULL) an interrupt empties the
 * UART's FIFO. README.md explains which to choose, and why the ring is safe.
 *
 * Contexts. All functions belong to the context that polls. The interrupt, if there is one, is
 * served by the core that calls tmini_pico_start(); tmini_poll() may run on the other. */

#ifndef TMINI_PICO_H
#define TMINI_PICO_H

#include <stddef.h>
#include <stdint.h>

#include "hardware/uart.h"

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The smallest ring, in bytes. */
#define TMINI_PICO_RING_MIN 256u
/** The largest ring, in bytes. */
#define TMINI_PICO_RING_MAX 32768u

/** Defines a ring where the hardware needs it: at a multiple of its size. */
#define TMINI_PICO_RING(name, size) static uint8_t name[size] __attribute__((aligned(size)))

/** How the lidar is connected. The chip's data sheet and the Pico's pinout show which pins can be
 * TX and RX of each UART. */
typedef struct {
    uart_inst_t *uart; /**< uart0 carries the console, unless the program moves it. */
    uint tx_pin;       /**< The GPIO wired to the lidar's RX. */
    uint rx_pin;       /**< The GPIO wired to the lidar's TX. */
    uint8_t *ring;     /**< TMINI_PICO_RING(), for DMA; NULL: an interrupt. */
    size_t ring_size;  /**< A power of two from 256 to 32768; 1024 bytes last 43 ms. */
} tmini_pico_wiring_t;

/** Received bytes on their way to the lidar. Running totals, modulo 2^32. */
typedef struct {
    uint32_t bytes;          /**< Handed to the lidar. */
    uint32_t bytes_lost;     /**< Overwritten by DMA before they were taken, or not yet taken when
                              * the FIFO overran. */
    uint32_t overruns;       /**< The UART's FIFO was full: the interrupt or DMA came too late. */
    uint32_t framing_errors; /**< A stop bit was missing: wrong baud rate, noise? */
    uint32_t breaks;         /**< The line was low for longer than a byte: no supply, no wire? */
} tmini_pico_counters_t;

/** One UART with a lidar. Treat the members as private. */
typedef struct {
    /** @cond private */
    tmini_t *lidar; /* NULL: not receiving. */
    uart_inst_t *uart;
    uint8_t *ring;
    uint32_t ring_size;
    uint32_t taken; /* Bytes taken out of the ring, as the channels count them; with an interrupt,
                     * bytes that tmini_pico_wait() has reported. */
    uint8_t channels[2];
    tmini_pico_counters_t counters;
    /** @endcond */
} tmini_pico_t;

/** The `port` of tmini_config_t; its `port_context` is the tmini_pico_t. `rx_dma` stays false: the
 * ring that DMA writes is the port's own. */
extern const tmini_port_t tmini_pico_port;

/** Sets up UART and pins: 230400 baud, 8N1, pull-up on RX. Nothing is received yet. The ring stays
 * the caller's. Do not call it between tmini_pico_start() and tmini_pico_stop(). Returns
 *   TMINI_OK
 *   TMINI_ERROR_ARGUMENT  null pointer; pins that this UART does not have; a ring that is too small
 *                         or too large, no power of two, or not at a multiple of its size
 *   TMINI_ERROR_STATE     the UART's clock does not make 230400 baud within 2 % */
tmini_status_t tmini_pico_init(tmini_pico_t *port, const tmini_pico_wiring_t *wiring);

/** From now on received bytes go to `lidar`, set up by tmini_init(). What came before is dropped,
 * and the counters begin at 0. Takes two DMA channels, or the UART's interrupt handler. Returns
 *   TMINI_OK
 *   TMINI_ERROR_ARGUMENT  null pointer, or no tmini_pico_init() before
 *   TMINI_ERROR_STATE     started already; fewer than two DMA channels are free; the UART's
 *                         interrupt has another handler */
tmini_status_t tmini_pico_start(tmini_pico_t *port, tmini_t *lidar);

/** Waits until bytes have come, at most `timeout_ms` (0: not at all), and returns how many. With a
 * ring it passes them to the lidar, as far as the lidar has room: call it before the ring is full.
 * By interrupt the lidar has them already. Returns 0 at once if nothing has been started. */
size_t tmini_pico_wait(tmini_pico_t *port, uint32_t timeout_ms);

/** Ends reception and gives back what tmini_pico_start() took. Stop the lidar before, or it goes on
 * scanning. Call it on the core that called tmini_pico_start(). */
void tmini_pico_stop(tmini_pico_t *port);

/** Copies the counters. */
void tmini_pico_counters(const tmini_pico_t *port, tmini_pico_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
