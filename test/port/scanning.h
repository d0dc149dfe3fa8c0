/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program that scans with the port under test: a lidar with its buffers, and a loop. Its scans
 * are compared with what the simulated lidar has sent (sim_judge.h). */

#ifndef SCANNING_H
#define SCANNING_H

#include <stdint.h>

#include "simulator.h"
#include "tmini/tmini.h"

typedef struct {
    const tmini_port_t *port;
    void *context;
    void (*wait)(void); /* Called when a poll returns no event. */
    bool rx_dma;        /* DMA writes into the receive buffer. */
} scanning_t;

extern tmini_t lidar;

/* Clears the record of what was sent; returns the observer to give to the simulated lidar. */
sim_observer_t truth_begin(void);

/* The number of packets sent. */
uint32_t truth_packets(void);

/* The scan is complete and has exactly the points of this revolution, or of some later one. */
void truth_assert_revolution(const tmini_scan_t *scan, uint32_t revolution);
void truth_assert_some_revolution(const tmini_scan_t *scan);

/* The scan has nothing but points of one revolution, in this order and in no other scan. Some may
 * be missing, if it says so. */
void truth_assert_nothing_invented(const tmini_scan_t *scan);

/* Resets the program and sets up `lidar`, with a receive buffer of `rx_size` bytes, at most
 * 1024. */
void scanning_begin(const scanning_t *program, size_t rx_size);

/* Polls until there is no event. */
void poll_all(void);

/* Polls until `wanted` happens; fails after ten seconds. */
void poll_until(tmini_event_t wanted);

/* The next scans are these revolutions, with every point. */
void assert_true_scans(uint32_t first, uint32_t last);

/* Polls until a scan is complete; returns the number of scans. Those before may lack points, but
 * have no wrong ones. */
unsigned scans_until_complete(void);

/* The next scan is not complete, but a later one is. */
void assert_gap(void);

/* The lidar is lost and then recovers. */
void assert_recovery(void);

/* Bytes come at any access to the library's indices or the model; every point must arrive. */
void assert_true_scans_wherever_bytes_come(void);

/* A layer below the program can hold `bytes`. Pauses cost no scan if at most 0.9 of these bytes
 * arrive meanwhile. */
void assert_pauses_cost_no_scan(uint32_t bytes);

#endif
