/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The lidar under FreeRTOS, on any chip: bytes go from your UART interrupt to the lidar, and the
 * task that polls sleeps until bytes have come. Nothing is allocated; no interrupt is disabled.
 *
 *     static tmini_freertos_t port;
 *     static tmini_t lidar;
 *
 *     tmini_freertos_init(&port, &wiring);
 *     config.port = &tmini_freertos_port;
 *     config.port_context = &port;
 *     if (tmini_init(&lidar, &config) != TMINI_OK) { halt(); }
 *     tmini_freertos_start(&port, &lidar);     bytes are taken
 *     tmini_start(&lidar);                      the lidar scans
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         case TMINI_EVENT_SCAN: use(tmini_scan(&lidar)); break;
 *         case TMINI_EVENT_NONE: tmini_freertos_sleep(&port, tmini_next_poll_ms(&lidar)); break;
 *         default: break;
 *         }
 *     }
 *
 *     void UART1_Handler(void)
 *     {
 *         BaseType_t woken = pdFALSE;
 *         … take `count` bytes out of the UART …
 *         tmini_freertos_receive_from_isr(&port, bytes, count, &woken);
 *         portYIELD_FROM_ISR(woken);
 *     }
 *
 * There are two ways. Without a stream (`stream` NULL) the interrupt stores into the lidar's own
 * buffer and notifies the polling task: the shortest way, and the usual one. With a stream the
 * interrupt fills a FreeRTOS stream buffer, and a receiving task passes on the bytes that the lidar
 * has room for. Then the polling task may be late by the time that the stream can bridge, and
 * `rx_buffer` may be small.
 *
 * Contexts. The two functions whose names end in _from_isr belong to the UART's interrupt, all
 * others to the task that polls. Any number of lidars, each with a tmini_freertos_t of its own. */

#ifndef TMINI_FREERTOS_H
#define TMINI_FREERTOS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "FreeRTOS.h"
#include "stream_buffer.h"
#include "task.h"

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifndef TMINI_FREERTOS_STACK_WORDS
/** The receiving task's stack, in words. */
#define TMINI_FREERTOS_STACK_WORDS 192
#endif

#ifndef TMINI_FREERTOS_WAKE_BYTES
/** The polling task is woken after this many bytes: 13,100 come per second while scanning. Fewer
 * wait for 10 ms in tmini_freertos_sleep(), for the time-out in tmini_freertos_wait(). */
#define TMINI_FREERTOS_WAKE_BYTES 64
#endif

#ifndef TMINI_FREERTOS_NOTIFICATION
/** The index of the notification that wakes a task; below configTASK_NOTIFICATION_ARRAY_ENTRIES. */
#define TMINI_FREERTOS_NOTIFICATION 0
#endif

/** How the lidar is connected. */
typedef struct {
    /** Sends, as `write` of tmini_port_t does: required. */
    int (*write)(void *uart, const uint8_t *bytes, size_t count);
    void *uart;                  /**< Passed to `write` and `restart`. */
    void (*restart)(void *uart); /**< As `restart` of tmini_port_t; NULL: none. */
    uint8_t *stream;      /**< The stream buffer's memory; NULL: no stream and no receiving task. */
    size_t stream_size;   /**< 128 or more; 1024 bytes last 44 ms. */
    UBaseType_t priority; /**< The receiving task's: above the polling task's. */
} tmini_freertos_wiring_t;

/** Received bytes on their way to the lidar. Running totals, modulo 2^32. */
typedef struct {
    uint32_t bytes;      /**< From the interrupt. */
    uint32_t bytes_lost; /**< How many of them the stream had no room for. */
    uint32_t overruns;   /**< tmini_freertos_gap_from_isr() was called. */
} tmini_freertos_counters_t;

/** One UART with a lidar. Treat the members as private. */
typedef struct {
    /** @cond private */
    tmini_freertos_wiring_t wiring;
    tmini_t *lidar;
    TaskHandle_t poller;
    TaskHandle_t receiver;
    StreamBufferHandle_t stream;
    volatile bool is_receiving;  /* Written by start and stop. */
    volatile bool is_parked;     /* The receiving task has noticed the stop. */
    volatile bool is_closed;     /* The stream takes no bytes until it has been emptied. */
    volatile bool has_received;  /* Bytes have come: set by the interrupt, cleared by its task. */
    volatile bool wakes_at_once; /* The next byte shall wake the task that the interrupt wakes. */
    uint32_t unannounced;        /* Bytes since the polling task was last woken. */
    uint32_t time_ms;            /* The time at `tick`, in ms. */
    uint32_t time_rest;          /* The fraction of a millisecond to add. */
    TickType_t tick;
    tmini_freertos_counters_t counters;
    StaticStreamBuffer_t stream_memory;
    StaticTask_t task_memory;
    StackType_t stack[TMINI_FREERTOS_STACK_WORDS];
    /** @endcond */
} tmini_freertos_t;

/** The `port` of tmini_config_t; its `port_context` is the tmini_freertos_t. Its clock is the
 * kernel's tick, of any rate and width. Poll at least once before the tick count wraps around. */
extern const tmini_port_t tmini_freertos_port;

/** Copies the wiring and creates the stream, if there is one; nothing is received yet. May be
 * called before the scheduler runs. Call it only once: the receiving task, once started, stays.
 * Returns
 *   TMINI_OK
 *   TMINI_ERROR_ARGUMENT  null pointer, no `write`, a stream below 128 bytes, a priority that the
 *                         kernel does not have */
tmini_status_t tmini_freertos_init(tmini_freertos_t *port, const tmini_freertos_wiring_t *wiring);

/** From now on received bytes go to `lidar`, set up by tmini_init(); the counters begin at 0.
 * Returns
 *   TMINI_OK
 *   TMINI_ERROR_ARGUMENT  null pointer, or no tmini_freertos_init() before
 *   TMINI_ERROR_STATE     started already */
tmini_status_t tmini_freertos_start(tmini_freertos_t *port, tmini_t *lidar);

/** From now on received bytes are dropped. With a stream it waits until the receiving task has
 * stopped: at most two ticks. Stop the lidar first, or it keeps scanning. The UART's
 * interrupt must not be running on another core. */
void tmini_freertos_stop(tmini_freertos_t *port);

/** Sleeps until the lidar must be polled again, when tmini_poll() has returned TMINI_EVENT_NONE:
 * `due_ms` is tmini_next_poll_ms(). The first byte after a silence wakes the task at once, so that
 * a tickless system sleeps while a lidar is idle, lost or awaited; while bytes flow,
 * TMINI_FREERTOS_WAKE_BYTES or 10 ms. Rounded down to ticks, but at least one; at once for 0. The
 * caller is the task that will be woken. Only this task may call the functions of tmini.h: no call
 * from elsewhere ends the sleep. */
void tmini_freertos_sleep(tmini_freertos_t *port, uint32_t due_ms);

/** Sleeps until TMINI_FREERTOS_WAKE_BYTES have come, at most `ticks` (at least one): for a polling
 * task with a time of its own. Not above 10 ms, because fewer bytes wait for the time-out. The
 * caller is the task that will be woken. */
void tmini_freertos_wait(tmini_freertos_t *port, TickType_t ticks);

/** Takes received bytes; for the UART's interrupt. *woken becomes pdTRUE if a task of higher
 * priority has been woken, as with FreeRTOS's own functions of this kind. One copy, no other loop,
 * no wait. */
void tmini_freertos_receive_from_isr(tmini_freertos_t *port, const uint8_t *bytes, size_t count,
                                     BaseType_t *woken);

/** Reports that bytes were lost before those received next: the UART has signalled an overrun. For
 * the UART's interrupt. */
void tmini_freertos_gap_from_isr(tmini_freertos_t *port);

/** Copies the counters. */
void tmini_freertos_counters(const tmini_freertos_t *port, tmini_freertos_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
