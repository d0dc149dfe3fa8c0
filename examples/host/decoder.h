/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A recording, packet by packet: the library's ring, parser and packet modules over a file, without
 * any port. No reply is awaited, so replies in the recording count as skipped bytes. */

#ifndef DECODER_H
#define DECODER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "tmini/tmini_packet.h"

/* Totals so far; 64 bits, because a recording may be longer than the parser's counters reach. */
typedef struct {
    uint64_t packets;
    uint64_t start_packets;
    uint64_t points;
    uint64_t checksum_errors;
    uint64_t bytes;
    uint64_t bytes_in_packets;
} decoder_totals_t;

typedef struct {
    tmini_packet_t packet; /* The one found last. */
    decoder_totals_t totals;
    FILE *file;
    tmini_ring_t ring;
    tmini_parser_t parser;
    uint32_t checksum_errors; /* Of the parser's, those that the totals include. */
    uint8_t memory[4096];
} decoder_t;

/* Decodes `file`, which stays the caller's. `max_samples`: 1 to 255, or 0 for the default. */
void decoder_init(decoder_t *decoder, FILE *file, uint8_t max_samples);

/* Finds the next valid packet. At the end of the file, what waits for more bytes is re-examined
 * byte by byte. Returns false when nothing is left; ferror(file) tells whether reading failed. */
bool decoder_next(decoder_t *decoder);

/* Bytes that belonged to no packet, of those decoded so far. */
uint64_t decoder_bytes_skipped(const decoder_t *decoder);

#endif
