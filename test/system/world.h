/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The library, the simulated lidar and the faulty wire between them, in one process and in virtual
 * time; and an observer that knows the truth of all three and checks the library against it:
 *
 *   - every packet that arrives unharmed while the library scans is delivered, point by point;
 *   - nothing is delivered that was not on the line as a valid packet;
 *   - no scan has points of two revolutions;
 *   - every byte is in exactly one place of the library's counters;
 *   - the lidar never gets a command other than stop while it scans;
 *   - a reported fault is there, and one that has gone is not reported.
 *
 * The line's bytes reach the library as a receive interrupt or a DMA channel would hand them over,
 * a millisecond's worth at a time, whether or not the main loop is busy. */

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
    uint16_t frequency_chz; /* As configured; 0: none is wanted. */
    bool listen_only;
    uint16_t max_points;    /* 0: WORLD_POINTS. */
    bool short_writes;      /* The port takes 0, 1 or 2 bytes, by chance. */
    uint16_t busy_one_in;   /* How often the main loop is busy; 0: never. */
    uint16_t busy_ms;       /* At most for so long. */
    bool overruns_expected; /* A ring too small for that: packets may be lost in it. */
    bool report;            /* Says each violation on standard output. */
} world_config_t;

#define WORLD_RX_MAX 8192u
#define WORLD_POINTS 4000u

typedef enum {
    VIOLATION_LOST_PACKET,   /* Arrived unharmed, but was not delivered. */
    VIOLATION_FALSE_PACKET,  /* Delivered, but no valid packet of the line. */
    VIOLATION_WRONG_SCAN,    /* Not the points of the packets it is made of. */
    VIOLATION_MIXED_SCAN,    /* Points of two revolutions in one scan. */
    VIOLATION_BYTES,         /* Bytes not accounted for. */
    VIOLATION_COMMAND,       /* Other than stop, while the lidar was scanning. */
    VIOLATION_FALSE_FAULT,   /* Reported though not there, or as gone though there. */
    VIOLATION_MISSED_FAULT,  /* There, but not reported in time; or gone, but still reported. */
    VIOLATION_ANSWER,        /* A command on an undisturbed line had no answer, or a wrong one. */
    VIOLATION_SLOW_RECOVERY, /* Later than WORLD_RECOVERY_MS after the last trouble. */
    VIOLATION_STATE,         /* One that cannot be: test/support/invariants.h. */
    VIOLATION_KINDS
} violation_t;

/* Scans have resumed that long after the last trouble has ended. The worst case: the lidar comes
 * back just after a start was sent (2 s until that is given up), the longest pause follows (4 s),
 * then it is the reboot's turn (5 s), and the question for the frequency is lost (2 s); start and
 * first revolution take the rest. */
#define WORLD_RECOVERY_MS 15000u

/* A fault of the lidar must be reported, and its end too, within that time: three revolutions, or
 * the 3 s that it takes to notice that there are none. */
#define WORLD_FAULT_MS 5000u

typedef struct {
    uint32_t events[TMINI_EVENT_MORE + 1];
    uint32_t polls;
    uint64_t points;            /* In scans and packets, all compared. */
    uint32_t packets_checked;   /* Sent, arrived unharmed, and delivered. */
    uint32_t packets_by_chance; /* Damaged, but the checksum matches: no parser can know. */
    uint32_t packets_split;     /* Arrived with a silence inside, and were given up. */
    uint32_t packets_eclipsed;  /* Began inside one of those by chance. */
    uint32_t recoveries;        /* Of which the time was measured. */
    uint32_t worst_recovery_ms; /* From the end of the trouble to the first packet. */
    uint32_t violations[VIOLATION_KINDS];
} world_counts_t;

typedef struct {
    world_config_t config;
    sim_t sim;
    sim_link_t link;
    bool deaf; /* What the library sends does not arrive. */
    uint32_t writes;
    tmini_t lidar;
    tmini_port_t port;
    random_t random;
    uint64_t now_us;
    uint64_t busy_until_us;
    uint8_t rx[WORLD_RX_MAX];
    tmini_point_t points[WORLD_POINTS];
    size_t dma_position;
    uint64_t fed;             /* Bytes that came since the library was set up, */
    uint64_t told;            /* and those of them that it knows of. */
    uint64_t fed_before;      /* Bytes that came before that. */
    uint64_t silent_since_us; /* The last poll that found new bytes, */
    uint64_t told_at_poll;    /* which were these. */
    uint64_t trouble_us;      /* When the last trouble ended. */
    bool in_trouble;          /* A loss has been reported and not recovered. */
    uint64_t fault_on_us[8];  /* When each bit was last there, */
    uint64_t fault_off_us[8]; /* and when not. */
    uint8_t faults;           /* As reported last. */
    tmini_scan_t scan;        /* The last one; its points are no longer valid. */
    truth_t truth;
    world_counts_t counts;
} world_t;

/* A lidar without faults on the line, a CPU-fed ring of 2048 bytes and scans; nothing goes
 * wrong. */
world_config_t world_default_config(void);

void world_init(world_t *world, const world_config_t *config);

/* The controller restarts: the library is set up anew, whatever the lidar does. */
void world_restart_library(world_t *world);

/* A millisecond passes. Returns a bit for each event that came. */
unsigned world_step(world_t *world);

unsigned world_run_ms(world_t *world, uint32_t ms);

/* Runs until one of the events (bits) comes or the time is up; returns the events that came. */
unsigned world_run_until(world_t *world, unsigned events, uint32_t ms);

/* Whether nothing has been wrong with the line since then, nor with the power. */
bool world_is_undisturbed_since(const world_t *world, uint64_t since_us);

/* For what the test that runs the world has found itself. */
void world_violate(world_t *world, violation_t violation, const char *what);

/* The sum of all violations. */
uint32_t world_violations(const world_t *world);

const char *world_violation_name(violation_t violation);

#define BIT(event) (1u << (event))

#endif
