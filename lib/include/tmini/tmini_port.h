/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * What the driver needs of the board: something to send bytes with, and a clock. Received bytes
 * come the other way, through tmini_feed_byte(), tmini_feed() or tmini_feed_dma().
 *
 * All members are called from within tmini_poll(), a command function or a blocking helper, hence
 * in the context that calls those, never from an interrupt, and never two at a time for one
 * lidar. */

#ifndef TMINI_PORT_H
#define TMINI_PORT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The functions of a board. All get the configuration's `port_context`. The structure must
 * outlive the lidar; it may be constant, and several lidars may share it. */
typedef struct {
    /** Hands up to `count` (at most 2) bytes to the UART and returns how many it took, 0 to count,
     * or a negative number when sending has failed. It may take fewer, even none, when the
     * transmitter is busy: the driver offers the rest again at the next tmini_poll(). It must not
     * wait longer than the bytes take on the wire (87 µs for two). The bytes are the driver's only
     * during the call: copy what is sent later. Required, unless the configuration says
     * listen_only. */
    int (*write)(void *context, const uint8_t *bytes, size_t count);

    /** Milliseconds since any moment, running on modulo 2^32; steps of up to 10 ms will do. Must
     * not wait. A step back of up to a second counts as no time. Required. */
    uint32_t (*now_ms)(void *context);

    /** Lets other work run (an RTOS delay, a sleep until the next interrupt) for about a
     * millisecond. Only the blocking helpers of tmini_blocking.h call it, while they wait.
     * Optional: NULL makes them spin. */
    void (*wait)(void *context);

    /** Begins reception anew, where the receiver may have stopped for good: called when the lidar
     * is lost and after each attempt to start it that failed. Must not wait. Optional: NULL. */
    void (*restart)(void *context);
} tmini_port_t;

#ifdef __cplusplus
}
#endif

#endif
