/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * What the driver needs from the board: a way to send bytes, and a clock. Received bytes come the
 * other way, through tmini_feed_byte(), tmini_feed() or tmini_feed_dma().
 *
 * The driver calls the members from tmini_poll(), from a wish or query, or from a blocking helper.
 * So they run in the polling context, and never two at a time for one lidar. */

#ifndef TMINI_PORT_H
#define TMINI_PORT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The functions of a board. Each gets the configuration's `port_context`. The structure must
 * outlive the lidar; it may be constant, and several lidars may share it. */
typedef struct {
    /** Hands up to `count` bytes, 1 or 2, to the UART. Returns how many it took, 0 to count, or a
     * negative number when sending has failed. It may take fewer, even none, while the
     * transmitter is busy: the driver offers the rest again at a later tmini_poll(). It must not
     * wait longer than the bytes take on the wire (87 µs for two). The bytes are valid only during
     * the call: copy what is sent later. Required, unless listen_only is configured. */
    int (*write)(void *context, const uint8_t *bytes, size_t count);

    /** Milliseconds since any moment, modulo 2^32; a resolution of 10 ms is enough. Must not wait.
     * If the clock steps back by up to a second (give or take 10 ms), no time counts until it has
     * caught up. If it steps back by more, time-outs begin again. Scans are incomplete while it is
     * more than 10 ms back. Required. */
    uint32_t (*now_ms)(void *context);

    /** Lets other work run for about a millisecond (an RTOS delay, a sleep until the next
     * interrupt). Only the blocking helpers of tmini_blocking.h call it, while they wait. Optional:
     * with NULL they poll without a pause. */
    void (*wait)(void *context);

    /** Starts reception again, in case the receiver has stopped. Called when the lidar is lost, and
     * after each failed attempt to start it. tmini_poll() takes as much longer: a few milliseconds
     * at most, if possible. To report a gap here, first end the old reception: two contexts must
     * not feed a lidar at the same time. Optional: NULL. */
    void (*restart)(void *context);
} tmini_port_t;

#ifdef __cplusplus
}
#endif

#endif
