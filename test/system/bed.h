/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program, the library and an unkind lidar (simulator.h: on_event, sim_befall()) in virtual time,
 * as light as can be: thousands of seconds per second. It keeps what the program sees. For checks
 * against the bytes on the line there is world.h.
 *
 * All of it is in one struct without pointers to elsewhere, so that a copy of it, put back in the
 * same place, goes on from there. */

#ifndef BED_H
#define BED_H

#include "simulator.h"

#include "tmini/tmini.h"

#define BED_EVENTS 32u
#define BED_RECENT 12u
#define BED_ROW 8u

typedef struct {
    /* To be set before bed_init(). */
    uint32_t poll_ms;   /* Between two rounds of polls. 0: 1. */
    uint32_t write_max; /* Bytes that the port takes per call. 0: all. */
    tmini_config_t config;
    tmini_timing_t timing;

    sim_t sim;
    tmini_t lidar;
    tmini_port_t port;
    uint64_t now_us;
    uint8_t outbox[16]; /* Bytes that reach the lidar with the next step. */
    size_t outbox_count;

    /* What the program has seen. */
    uint32_t events[BED_EVENTS];
    uint64_t event_us[BED_EVENTS];  /* The latest of each kind; 0: none. */
    uint64_t recent_us[BED_RECENT]; /* The latest ones except packets and scans, in a circle. */
    uint32_t recent;                /* How many there have been. */
    uint32_t most_per_second;       /* The most of these in any second. */
    tmini_scan_t scan;              /* The latest; its points may have been overwritten. */
    uint32_t complete;              /* Complete scans. */
    uint32_t complete_in_a_row;     /* Now. */
    uint16_t row_chz[BED_ROW];      /* The frequencies of the latest of these, in a circle. */
    uint64_t complete_us;           /* The latest complete scan. */
    uint64_t longest_gap_us;        /* Between two of these, or since the first one. */

    uint8_t rx[4096];
    tmini_point_t points[800];
} bed_t;

/* Defaults of the README's program, without a frequency: to be changed before bed_init(). The lidar
 * is set up by bed_init() with `sim`, idle and powered. */
void bed_prepare(bed_t *bed);
bool bed_init(bed_t *bed, const sim_config_t *sim);

/* Time passes: bytes go both ways, then the program polls until nothing is left to do. */
void bed_step(bed_t *bed);
void bed_run_ms(bed_t *bed, uint32_t ms);

uint32_t bed_ms(const bed_t *bed);

/* The number of the event with this name (tmini_event_name()); BED_EVENTS - 1, which never comes,
 * if there is none. */
unsigned bed_event_named(const char *name);

/* The latest `scans` scans, at most BED_ROW, are complete and at this frequency, within 5 %, which is
 * also the one that is set, and that the driver knows. 0: at any frequency. */
bool bed_scans_at(const bed_t *bed, uint16_t frequency_chz, uint32_t scans);

/* Lidar and driver are idle. The driver may be unsure, because a late byte has come. */
bool bed_is_idle(const bed_t *bed);

#endif
