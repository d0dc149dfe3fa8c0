/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The truth about the line: the packets that arrived unharmed, and all raw bytes. Compares what the
 * library delivers with both, using the reference decoder. Part of world.h.
 *
 * Places on the line are counted in bytes that reached the host. */

#ifndef TRUTH_H
#define TRUTH_H

#include "link.h"

#include "tmini/tmini.h"

#define TRUTH_PACKETS 1024u
#define TRUTH_HISTORY 131072u /* Bytes: 10 s of scanning. */
#define TRUTH_SPLITS 16u

/* If the line loses all bytes of a packet with this few samples, its loss cannot be detected: the
 * hole is less than 4 degrees wide, and no bytes are skipped. */
#define TRUTH_SMALL_SAMPLES 7u

typedef struct {
    uint64_t offset;
    uint16_t length;
    bool starts_revolution;
    bool is_of_partial; /* Of a partial turn, which continues in the next revolution. */
    uint32_t revolution;
    uint32_t number; /* Of the packet among all sent, without the small damaged ones. */
} truth_packet_t;

typedef enum {
    TRUTH_RIGHT,
    TRUTH_BY_CHANCE, /* Damaged, but the bytes that arrived are a valid packet. */
    TRUTH_LOST,      /* A packet that arrived unharmed was not delivered. */
    TRUTH_MIXED,     /* A scan of two revolutions. */
    TRUTH_WRONG
} truth_verdict_t;

typedef struct {
    uint8_t history[TRUTH_HISTORY];
    uint64_t end;                          /* Place of the end of the history. */
    truth_packet_t packets[TRUTH_PACKETS]; /* Packets not yet compared, in order. */
    uint32_t first;
    uint32_t count;
    uint32_t overflows;
    uint32_t small_damaged; /* Small damaged packets so far. */
    uint64_t splits[TRUTH_SPLITS];
    uint32_t split_count;
    uint64_t delivered_end; /* End of the last packet delivered. */
    uint64_t compared;      /* The next scan begins here or later. */
    bool has_start;         /* It may begin with any packet, not only with a start packet. */
    bool origin_is_partial; /* The last start packet began a partial turn. */
    uint32_t checked;
    uint32_t split;
    uint32_t eclipsed;
    uint64_t points;
} truth_t;

void truth_init(truth_t *truth);

/* The link has reported this packet. */
void truth_sent(truth_t *truth, const sim_link_packet_t *packet);

/* Bytes have reached the host. */
void truth_arrived(truth_t *truth, const uint8_t *bytes, size_t count);

/* After the byte before `end` the line was silent so long that the host gives up waiting. */
void truth_fell_silent(truth_t *truth, uint64_t end);

/* Packets that end before `end` need not have been delivered: the library was not receiving. */
void truth_forget(truth_t *truth, uint64_t end);

/* Packets that end at `end` or before must have been delivered. */
truth_verdict_t truth_must_be_empty(truth_t *truth, uint64_t end);

/* Compares a delivered packet that ends at `end`. */
truth_verdict_t truth_compare_packet(truth_t *truth, uint64_t end, const tmini_packet_t *packet);

/* Compares a scan that a packet of `closing_length` bytes ended, which ends at `end`. */
truth_verdict_t truth_compare_scan(truth_t *truth, uint64_t end, unsigned closing_length,
                                   const tmini_scan_t *scan);

#endif
