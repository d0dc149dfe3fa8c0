/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The library, the simulated lidar and the faulty wire between them, in one process and in virtual
 * time. An observer knows the state of all three and checks the library:
 *
 *   - every packet that arrives unharmed while the library scans is delivered, point by point;
 *   - nothing is delivered that was not on the line as a valid packet;
 *   - no scan has points of two revolutions;
 *   - every byte is counted exactly once in the library's counters;
 *   - the lidar never gets a command other than stop while it scans;
 *   - a fault is reported exactly while it exists, within the time allowed.
 *
 * Each millisecond the line's bytes are fed to the library, as by a receive interrupt or a DMA
 * channel, whether or not the main loop is busy. */

#ifndef WORLD_H
#define WORLD_H

#include "link.h"
#include "random.h"
#include "truth.h"

#include "tmini/tmini.h"

typedef struct {
    uint64_t seed;
    sim_config_t sim;
    sim_link_config_t link;
    size_t rx_size; /* At most WORLD_RX_MAX. */
    bool dma;
    bool streaming;
    tmini_recovery_mode_t recovery;
    uint16_t frequency_chz; /* The frequency wanted; 0: none. */
    bool listen_only;
    uint16_t max_points;    /* 0: WORLD_POINTS. */
    bool short_writes;      /* The port accepts 0, 1 or 2 bytes, at random. */
    uint16_t busy_one_in;   /* One millisecond in this many begins a busy period; 0: none. */
    uint16_t busy_ms;       /* Longest busy period. */
    bool overruns_expected; /* The ring is too small for the busy periods: it may lose packets. */
    bool report;            /* Prints each violation. */
} world_config_t;

#define WORLD_RX_MAX 8192u
#define WORLD_POINTS 4000u

typedef enum {
    VIOLATION_LOST_PACKET,   /* A packet arrived unharmed, but was not delivered. */
    VIOLATION_FALSE_PACKET,  /* A delivered packet was not on the line. */
    VIOLATION_WRONG_SCAN,    /* A scan's points differ from those of its packets. */
    VIOLATION_MIXED_SCAN,    /* Points of two revolutions in one scan. */
    VIOLATION_BYTES,         /* Bytes not accounted for. */
    VIOLATION_COMMAND,       /* A command other than stop was sent to a scanning lidar. */
    VIOLATION_FALSE_FAULT,   /* A fault was reported but absent, or reported as gone but present. */
    VIOLATION_MISSED_FAULT,  /* A fault was not reported in time, or gone but still reported. */
    VIOLATION_ANSWER,        /* A command on an undisturbed line had no reply, or a wrong one. */
    VIOLATION_SLOW_RECOVERY, /* It took longer than WORLD_RECOVERY_MS after the last trouble. */
    VIOLATION_STATE,         /* An impossible state of the library (test/support/invariants.h). */
    VIOLATION_KINDS
} violation_t;

/* The time after the end of the last trouble in which scans must resume. In the worst case the
 * lidar returns just after a start was sent (timeout 2 s), the longest pause follows (4 s), then a
 * reboot (5 s), and the query for the frequency is lost (2 s). Start and first revolution take the
 * rest. */
#define WORLD_RECOVERY_MS 15000u

/* A fault of the lidar, and its end, must be reported within this time: three revolutions, or the 3
 * s until missing revolutions are noticed. */
#define WORLD_FAULT_MS 5000u

typedef struct {
    uint32_t events[TMINI_EVENT_MORE + 1];
    uint32_t polls;
    uint64_t points;            /* In scans and packets, all compared. */
    uint32_t packets_checked;   /* Sent, arrived unharmed, and delivered. */
    uint32_t packets_by_chance; /* Damaged, but the checksum matches: no parser can detect it. */
    uint32_t packets_split;     /* Interrupted by a silence and abandoned. */
    uint32_t packets_eclipsed;  /* Began inside a packet counted in packets_by_chance. */
    uint32_t recoveries;        /* Whose duration was measured. */
    uint32_t worst_recovery_ms; /* From the end of the trouble to the first packet. */
    uint32_t violations[VIOLATION_KINDS];
} world_counts_t;

typedef struct {
    world_config_t config;
    sim_t sim;
    sim_link_t link;
    bool deaf; /* Commands do not reach the lidar. */
    uint32_t writes;
    tmini_t lidar;
    tmini_port_t port;
    random_t random;
    uint64_t now_us;
    uint64_t busy_until_us;
    uint8_t rx[WORLD_RX_MAX];
    tmini_point_t points[WORLD_POINTS];
    size_t dma_position;
    uint64_t fed;               /* Bytes that have come since the library was set up. */
    uint64_t published;         /* Those that the library knows of. */
    uint64_t fed_before;        /* Bytes that came before it was set up. */
    uint64_t silent_since_us;   /* Time of the last poll that found new bytes. */
    uint64_t published_at_poll; /* `published` at that poll. */
    uint64_t trouble_us;        /* When the last trouble ended. */
    bool in_trouble;            /* A loss has been reported and not recovered. */
    uint64_t fault_on_us[8];    /* When each fault was last present. */
    uint64_t fault_off_us[8];   /* When it was last absent. */
    uint8_t faults;             /* The faults reported last. */
    tmini_scan_t scan;          /* The last one; its points are no longer valid. */
    truth_t truth;
    world_counts_t counts;
} world_t;

/* No faults, a ring of 2048 bytes fed by the CPU, and scans. */
world_config_t world_default_config(void);

void world_init(world_t *world, const world_config_t *config);

/* The controller restarts: the library is set up anew, while the lidar goes on. */
void world_restart_library(world_t *world);

/* A millisecond passes. Returns a bit for each event. */
unsigned world_step(world_t *world);

unsigned world_run_ms(world_t *world, uint32_t ms);

/* Runs until one of the events (bits) comes or the time is over; returns a bit for each event. */
unsigned world_run_until(world_t *world, unsigned events, uint32_t ms);

/* Whether line and power have had no fault since then. */
bool world_is_undisturbed_since(const world_t *world, uint64_t since_us);

/* Counts a violation that the test has found itself. */
void world_violate(world_t *world, violation_t violation, const char *what);

const char *world_violation_name(violation_t violation);

#define BIT(event) (1u << (event))

#endif
