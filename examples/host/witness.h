/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Sees all bytes that come from the port, beside the driver: keeps the latest ones, decodes them
 * without time-outs (so bytes that only come late are no damage), and notes when they came. */

#ifndef WITNESS_H
#define WITNESS_H

#include "causes.h"
#include "tape.h"

typedef struct {
    uint64_t received;   /* Bytes. */
    uint64_t bytes;      /* Of these, since the start. */
    uint32_t last_ms;    /* When the latest came. */
    uint64_t rate_bytes; /* Bytes since the start when the rate was begun to be measured. */
    uint32_t rate_ms;
    uint32_t longest_ms;    /* The longest time without a byte since the first packet. */
    count_t packets_before; /* Packets before the start. */
    tape_t tape;            /* tape.stream: the packets. */
    traits_t traits;        /* Of `latest`; see witness_look(). */
    size_t kept;
    uint8_t latest[2 * TRAITS_MAX];
} witness_t;

void witness_begin(witness_t *witness);

void witness_take(witness_t *witness, const uint8_t *bytes, size_t count, uint32_t now_ms);

/* What comes next does not follow what came before: the lidar was stopped, started or lost. */
void witness_break(witness_t *witness);

/* Forgets the bytes, but not the packets, from before a start. */
void witness_start(witness_t *witness);

/* Looks at the latest bytes, and fills in what it knows. */
void witness_look(witness_t *witness, facts_t *facts);

#endif
