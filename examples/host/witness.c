/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "witness.h"

#include <string.h>

/* A rate is measured after this many bytes, when all packets come, for at least this time. */
#define RATE_BYTES 512u
#define RATE_MS 200u

void witness_begin(witness_t *witness)
{
    memset(witness, 0, sizeof *witness);
    tape_begin(&witness->tape, NULL, 0);
}

/* Of the bytes before the latest ones, half of `latest` is kept. */
static void keep(witness_t *witness, const uint8_t *bytes, size_t count)
{
    if (count > sizeof witness->latest - witness->kept) {
        const size_t left = TRAITS_MAX - count;
        memmove(witness->latest, witness->latest + witness->kept - left, left);
        witness->kept = left;
    }
    memcpy(witness->latest + witness->kept, bytes, count);
    witness->kept += count;
}

void witness_take(witness_t *witness, const uint8_t *bytes, size_t count, uint32_t now_ms)
{
    const bool has_begun = witness->tape.stream.packets > witness->packets_before;
    const uint32_t pause_ms = has_begun ? now_ms - witness->last_ms : 0;
    witness->longest_ms = pause_ms > witness->longest_ms ? pause_ms : witness->longest_ms;
    if (witness->rate_bytes < RATE_BYTES) {
        witness->rate_bytes = witness->bytes + count;
        witness->rate_ms = now_ms;
    }
    witness->last_ms = now_ms;
    witness->bytes += count;
    witness->received += count;
    keep(witness, bytes, count);
    while (count > 0) {
        const size_t taken = tape_feed(&witness->tape, bytes, count);
        bytes += taken;
        count -= taken;
        while (tape_next(&witness->tape) != TAPE_NEEDS_BYTES) {
        }
    }
}

void witness_break(witness_t *witness)
{
    stream_break(&witness->tape.stream);
}

void witness_start(witness_t *witness)
{
    witness_break(witness);
    witness->bytes = 0;
    witness->kept = 0;
    witness->longest_ms = 0;
    witness->rate_bytes = 0;
    witness->packets_before = witness->tape.stream.packets;
}

void witness_look(witness_t *witness, facts_t *facts)
{
    const size_t count = witness->kept < TRAITS_MAX ? witness->kept : TRAITS_MAX;
    const uint32_t ms = witness->last_ms - witness->rate_ms;
    traits_find(&witness->traits, witness->latest + witness->kept - count, count);
    facts->traits = &witness->traits;
    facts->received = witness->received;
    facts->packets = witness->tape.stream.packets;
    facts->per_second =
        ms >= RATE_MS ? (unsigned)((witness->bytes - witness->rate_bytes) * 1000 / ms) : 0;
    facts->is_damaged = witness->tape.stream.damaged > 0;
}
