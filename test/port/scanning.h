/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program that scans over a port under test: one lidar with its buffers, and its loop. What it
 * gets is compared with what the simulated lidar has sent (truth.h). */

#ifndef SCANNING_H
#define SCANNING_H

#include <stdint.h>

#include "tmini/tmini.h"
#include "truth.h"

typedef struct {
    const tmini_port_t *port;
    void *context;
    uint64_t (*now_us)(void);
    void (*wait)(void);        /* When there is nothing left to poll for. */
    void (*work)(uint32_t us); /* The program does something else. */
} scanning_t;

extern tmini_t lidar;

/* The program, before it has started anything; `rx_size` of its receive buffer at most 1024. */
void scanning_begin(const scanning_t *program, size_t rx_size);

/* Polls until `wanted` happens; fails when it does not within ten seconds. */
void poll_until(tmini_event_t wanted);

/* The next scans are these revolutions, with every point. */
void assert_true_scans(uint32_t first, uint32_t last);

/* Scans, from which something is missing but in which nothing is wrong, until one is complete;
 * returns how many. */
unsigned scans_until_complete(void);

/* The next scan is not complete, then they are again. */
void assert_gap(void);

/* The lidar is lost and comes back. */
void assert_recovery(void);

/* At whatever access of the library's indices, or of the model, some bytes come. */
void assert_true_scans_wherever_bytes_come(void);

/* A layer below the program holds `bytes`: pauses of up to 0.9 of what these last cost no scan. */
void assert_pauses_cost_no_scan(uint32_t bytes);

#endif
