/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The faulty wire between a bed and its lidar (link.h), and an observer that knows the state of
 * both, and checks the library:
 *
 *   - every packet that arrives unharmed while the library scans is delivered, in exactly one scan;
 *   - no scan lies (sim_judge.h); nothing is delivered that was not sent;
 *   - every byte is counted exactly once in the library's counters;
 *   - its state is possible (test/support/invariants.h);
 *   - the lidar never gets a command other than stop while it scans;
 *   - a fault is reported exactly while it exists, within the time allowed;
 *   - after the last trouble packets come again within the time allowed.
 *
 * Where the receiver loses bytes, packets with losses need not be delivered, and each of the others
 * is judged at the end of a trial.
 *
 * The lidar must be marked. */

#ifndef WATCH_H
#define WATCH_H

#include "link.h"
#include "sim_judge.h"

#include "tmini/tmini.h"

#define WATCH_PACKETS 1024u
#define WATCH_TURNS 128u     /* Those of a trial, and those that pass after its end. */
#define WATCH_HISTORY 65536u /* Bytes: 5 s of scanning. */

/* The time after the end of the last trouble in which scans must resume. In the worst case the
 * lidar returns just after a start was sent (timeout 2 s), the longest pause follows (2 s), then a
 * reboot (5 s), and the query for the frequency is lost (2 s). Start, first revolution and a second
 * try of one of these take the rest. */
#define WATCH_RECOVERY_MS 15000u

/* A fault of the lidar, and its end, must be reported within this time: three revolutions, or the 3
 * s until missing revolutions are noticed. */
#define WATCH_FAULT_MS 5000u

/* Each lie of a scan, and: */
typedef enum {
    WRONG_LOST_PACKET = SIM_LIES, /* A packet arrived unharmed, but was not delivered. */
    WRONG_BYTES,                  /* Bytes not accounted for. */
    WRONG_COMMAND,                /* A command other than stop was sent to a scanning lidar. */
    WRONG_FALSE_FAULT,   /* A fault was reported but absent, or reported as gone but present. */
    WRONG_MISSED_FAULT,  /* A fault was not reported in time, or gone but still reported. */
    WRONG_ANSWER,        /* A command on an undisturbed line had no reply, or a wrong one. */
    WRONG_SLOW_RECOVERY, /* It took longer than WATCH_RECOVERY_MS after the last trouble. */
    WRONG_STATE,         /* An impossible state of the library. */
    WRONG_REMAINDER,     /* Bytes are still pending after a long silence. */
    WRONG_COST,          /* A turn without losses is not delivered as complete. */
    WRONG_KINDS
} wrong_t;

/* A packet that arrived unharmed. Places on the line are counted in bytes that reached the host. */
typedef struct {
    uint64_t offset;
    uint16_t length;
    bool starts_revolution;
    bool is_split; /* A silence in its middle: the library gives it up. */
    bool is_lost;  /* The receiver has lost a part of it. */
    uint32_t turn;
    uint64_t at_us;
    uint32_t place; /* Of its first sample (sim_judge.h). */
    uint32_t samples;
} watch_packet_t;

typedef struct {
    uint64_t points;            /* Compared. */
    uint32_t packets;           /* Arrived unharmed, and delivered. */
    uint32_t by_chance;         /* Deliveries spoilt by damage whose checksum matches. */
    uint32_t split;             /* Packets interrupted by a silence and given up. */
    uint32_t recoveries;        /* Whose duration was measured. */
    uint32_t worst_recovery_ms; /* From the end of the trouble to the first packet. */
    uint32_t wrongs[WRONG_KINDS];
} watch_counts_t;

typedef struct {
    uint32_t samples;
    bool is_touched; /* A byte of it, or of the next start packet, is lost. */
    bool is_delivered;
} watch_turn_t;

typedef struct bed bed_t;

typedef struct {
    /* To be set before bed_init(). */
    sim_link_config_t line;
    bool may_lose; /* Packets: the ring is too small, or the program too slow. */

    /* For a trial of a few seconds: packets and turns are kept, and judged in the end. */
    bool is_trial;
    bool (*loses)(void *context, const sim_run_t *run, size_t i); /* As sim_link_observer_t. */
    void (*on_scan)(bed_t *bed, sim_reading_t *reading); /* May excuse a lie. NULL: nothing. */

    sim_link_t link;
    sim_judge_t judge;
    watch_turn_t turns[WATCH_TURNS];
    uint64_t lost_to;                      /* After the latest byte that the receiver has lost. */
    watch_packet_t packets[WATCH_PACKETS]; /* Not yet delivered, in order. */
    uint32_t first;
    uint32_t count;
    bool has_begun; /* A start packet has come: from then on every packet is in a scan. */
    bool was_scanning;
    uint8_t history[WATCH_HISTORY];
    uint64_t arrived;         /* Bytes in all. */
    uint64_t begun_at;        /* Those before the library was set up. */
    uint64_t silent_since_us; /* Time of the last poll that found new bytes, */
    uint64_t known_at_poll;   /* and how many the library knew of. */
    uint64_t trouble_us;      /* When the last trouble ended. */
    bool in_trouble;          /* A loss has been reported and not recovered. */
    uint64_t fault_on_us[8];  /* When each fault was last present. */
    uint64_t fault_off_us[8]; /* When it was last absent. */
    uint8_t faults;           /* The faults reported last. */
    watch_counts_t counts;
    const char *wrong; /* The first thing that was wrong; NULL: nothing. */
} watch_t;

/* Called by the bed: at its beginning; when the library was set up; for bytes that come; in each
 * step; before a round of polls, for each of its events, and after it. */
void watch_begin(bed_t *bed);
void watch_restart(bed_t *bed);
void watch_arrive(bed_t *bed, const uint8_t *bytes, size_t count);
void watch_lose(bed_t *bed, uint64_t from, uint64_t to); /* Of the bytes that have come. */
void watch_step(bed_t *bed);
void watch_before_polls(bed_t *bed);
void watch_event(bed_t *bed, tmini_event_t event);
void watch_after_polls(bed_t *bed);

/* A trial ends, after a long silence. */
typedef struct {
    uint64_t intact; /* Points of packets without losses, */
    uint64_t in_one; /* and those of them in exactly one scan. */
} watch_end_t;
watch_end_t watch_end(bed_t *bed);

/* Counts what the test itself has found wrong. */
void watch_complain(bed_t *bed, unsigned wrong);

/* Whether line and power have had no fault since then. */
bool watch_is_undisturbed_since(const bed_t *bed, uint64_t since_us);

const char *watch_name(unsigned wrong);

#endif
