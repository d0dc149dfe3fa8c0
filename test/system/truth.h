/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What was on the line: the packets that arrived unharmed, and the raw bytes themselves. Compares
 * what the library delivers with that, by the independent decoder. Part of the world.
 *
 * Places on the line are counted in bytes that reached the host. */

#ifndef TRUTH_H
#define TRUTH_H

#include "link.h"

#include "tmini/tmini.h"

#define TRUTH_PACKETS 1024u
#define TRUTH_HISTORY 131072u /* Bytes: 10 s of scanning. */
#define TRUTH_SPLITS 16u

/* A packet of so few samples may vanish without a trace, if the line loses all of its bytes: the
 * hole is less than 4 degrees wide, and nothing is left that could be skipped. */
#define TRUTH_SMALL_SAMPLES 7u

typedef struct {
    uint64_t offset;
    uint16_t length;
    bool starts_revolution;
    bool is_of_partial; /* Of a turn's part, which the next revolution goes on with. */
    bool optional;      /* A silence fell into it: it may have been given up. */
    uint32_t revolution;
    uint32_t number; /* Of the packet among all that were sent, without the small damaged ones. */
} truth_packet_t;

typedef enum {
    TRUTH_RIGHT,
    TRUTH_BY_CHANCE, /* Not as sent, but a valid packet as it arrived. */
    TRUTH_LOST,      /* A packet that arrived unharmed is not there. */
    TRUTH_MIXED,     /* A scan of two revolutions. */
    TRUTH_WRONG
} truth_verdict_t;

typedef struct {
    uint8_t history[TRUTH_HISTORY];
    uint64_t end;                          /* Of the history. */
    truth_packet_t packets[TRUTH_PACKETS]; /* Those not yet compared, in order. */
    uint32_t first;
    uint32_t count;
    uint32_t overflows;
    uint32_t small_damaged; /* Packets sent so far. */
    uint64_t splits[TRUTH_SPLITS];
    uint32_t split_count;
    uint64_t delivered_end; /* Of the packet delivered last. */
    uint64_t compared;      /* Scans begin here or later; */
    bool has_start;         /* with any packet. */
    bool origin_is_partial; /* The last start packet that came is of a turn's part. */
    uint32_t checked;
    uint32_t split;
    uint32_t eclipsed;
    uint64_t points;
} truth_t;

void truth_init(truth_t *truth);

/* The link's report. */
void truth_sent(truth_t *truth, const sim_link_packet_t *packet);

/* Bytes have reached the host. */
void truth_arrived(truth_t *truth, const uint8_t *bytes, size_t count);

/* The host has seen the bytes before `end`, and then none for so long that it gives up on more. */
void truth_fell_silent(truth_t *truth, uint64_t end);

/* Packets that end before `end` need not have been delivered: the library was not receiving. */
void truth_forget(truth_t *truth, uint64_t end);

/* Packets that end at `end` or before must have been delivered. */
truth_verdict_t truth_must_be_empty(truth_t *truth, uint64_t end);

/* This packet was delivered, and ends at `end`. */
truth_verdict_t truth_compare_packet(truth_t *truth, uint64_t end, const tmini_packet_t *packet);

/* This scan was delivered by a packet that ends at `end`. */
truth_verdict_t truth_compare_scan(truth_t *truth, uint64_t end, unsigned closing_length,
                                   const tmini_scan_t *scan);

#endif
