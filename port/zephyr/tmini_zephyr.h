/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar on a UART of any board that Zephyr knows, over the interrupt-driven or the async UART
 * API, for a thread of your own that polls. For a node in the devicetree, tmini_zephyr_device.h
 * provides this thread.
 *
 *     #define UART DEVICE_DT_GET(DT_BUS(DT_NODELABEL(lidar)))
 *
 *     static tmini_zephyr_t port;
 *     static tmini_t lidar;
 *
 *     tmini_zephyr_init(&port, UART);
 *     config.port = &tmini_zephyr_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_zephyr_start(&port, &lidar);      bytes come
 *     tmini_start(&lidar);                     the lidar scans
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN: use(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_NONE: tmini_zephyr_sleep(&port, tmini_next_poll_ms(&lidar)); break;
 *         default: break;
 *         }
 *     }
 *
 * The UART's callback stores bytes and nothing more; all functions here belong to the one thread
 * that polls. They return Zephyr's errors, as negative numbers. */

#ifndef TMINI_ZEPHYR_H
#define TMINI_ZEPHYR_H

#include <stdbool.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/kernel.h>

#include "tmini/tmini.h"

#ifndef CONFIG_TMINI_UART
#error \
    "tmini: CONFIG_TMINI_UART is off. It needs CONFIG_SERIAL, CONFIG_MULTITHREADING and a UART \
driver with the interrupt-driven or the async API (CONFIG_SERIAL_SUPPORT_INTERRUPT, _ASYNC)"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Received bytes on their way to the lidar. Running totals, modulo 2^32. Errors stay 0 with UART
 * drivers that do not report them. */
typedef struct {
    uint32_t bytes;          /**< Handed to the lidar. */
    uint32_t overruns;       /**< The interrupt came too late; bytes were lost. */
    uint32_t framing_errors; /**< A stop bit was missing: wrong baud rate, noise? */
    uint32_t noise_errors;   /**< A bit's samples differed. */
    uint32_t breaks;         /**< The line was low for longer than a byte: unplugged? */
} tmini_zephyr_counters_t;

/** One UART with a lidar. Treat the members as private. */
typedef struct {
    /** @cond private */
    const struct device *uart;
    tmini_t *lidar; /* NULL: not receiving. */
    struct k_sem received;
    struct k_spinlock lock; /* Separates stopping from the callback on another core. */
    uint32_t unannounced;   /* Bytes since the polling thread was last woken. */
    bool has_received;      /* Bytes have come since the last tmini_zephyr_sleep(). */
    bool wakes_at_once;     /* The next byte shall wake the polling thread. */
#ifdef CONFIG_TMINI_UART_ASYNC
    uint8_t buffers[2][CONFIG_TMINI_UART_BUFFER];
    uint8_t buffer;           /* The buffer given to the UART driver last. */
    volatile bool is_enabled; /* The UART driver receives; its callback clears it. */
#endif
    tmini_zephyr_counters_t counters;
    /** @endcond */
} tmini_zephyr_t;

/** The `port` of tmini_config_t; its `port_context` is the tmini_zephyr_t. */
extern const tmini_port_t tmini_zephyr_port;

/** Sets the UART to 230400 baud, 8N1. A driver that cannot change the baud rate while it runs keeps
 * the devicetree's `current-speed`. Do not call it between start and stop. Returns 0,
 *   -EINVAL  null pointer
 *   -ENODEV  the UART is not ready
 *   or the UART driver's error */
int tmini_zephyr_init(tmini_zephyr_t *port, const struct device *uart);

/** From now on received bytes go to `lidar`, set up by tmini_init(); the counters begin at 0. Takes
 * the UART's callback. Returns 0,
 *   -EINVAL    null pointer, or no tmini_zephyr_init() before
 *   -EALREADY  started already
 *   -ENOSYS    the UART's driver has no interrupt-driven API (reported since Zephyr 3.3)
 *   -ENOTSUP   CONFIG_UART_INTERRUPT_DRIVEN is off
 * After an error nothing is received. */
int tmini_zephyr_start(tmini_zephyr_t *port, tmini_t *lidar);

/** Ends reception. Stop the lidar before, or it goes on scanning. */
void tmini_zephyr_stop(tmini_zephyr_t *port);

/** Sleeps until the lidar must be polled again, when tmini_poll() has returned TMINI_EVENT_NONE:
 * `due_ms` is tmini_next_poll_ms(); 0: not at all. The first byte after a silence wakes the thread
 * at once, so that a tickless system sleeps while a lidar is idle, lost or awaited; while bytes
 * flow, CONFIG_TMINI_WAKE_BYTES or 10 ms. */
void tmini_zephyr_sleep(tmini_zephyr_t *port, uint32_t due_ms);

/** Sleeps until CONFIG_TMINI_WAKE_BYTES have come, at most `timeout`: for a polling thread with a
 * time of its own. Not above 10 ms, because fewer bytes wait for the time-out. */
void tmini_zephyr_wait(tmini_zephyr_t *port, k_timeout_t timeout);

/** Copies the counters. */
void tmini_zephyr_counters(const tmini_zephyr_t *port, tmini_zephyr_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
