/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "proof.h"

uint8_t ring_memory[LARGE_RING_SIZE];

static tmini_ring_t *fed; /* NULL: nothing comes. */
static bool has_come;

tmini_parser_t nondet_parser(void);

bool any_bool(void)
{
    return (nondet_byte() & 1u) != 0;
}

tmini_ring_t any_ring_of(size_t size)
{
    for (size_t i = 0; i < size; i++) {
        ring_memory[i] = nondet_byte();
    }
    const bool dma = any_bool();
    const size_t limit = nondet_size();
    const tmini_ring_t ring = {.memory = ring_memory,
                               .size = size,
                               .window = dma ? size / 2 : size,
                               .gate = dma || any_bool() ? size - 1 : 0,
                               .limit = limit,
                               .head = limit - size + nondet_size(),
                               .overrun = nondet_size()};
    ASSUME(ring_is_sound(&ring));
    return ring;
}

tmini_ring_t any_ring(void)
{
    return any_ring_of(RING_SIZE);
}

tmini_ring_t any_early_ring(size_t size)
{
    for (size_t i = 0; i < size; i++) {
        ring_memory[i] = nondet_byte();
    }
    const bool dma = any_bool();
    const uint8_t limit = nondet_byte();
    const uint16_t unread = nondet_half();
    ASSUME(dma || unread <= size);
    return (tmini_ring_t){.memory = ring_memory,
                          .size = size,
                          .window = dma ? size / 2 : size,
                          .gate = dma || any_bool() ? size - 1 : 0,
                          .limit = limit,
                          .head = (size_t)limit - size + unread};
}

tmini_parser_t any_parser(tmini_ring_t *ring)
{
    tmini_parser_t parser = nondet_parser();
    parser.frame.ring = ring;
    parser.awaiting = any_bool();
    parser.counters = (tmini_parser_counters_t){0};
    ASSUME(parser_is_sound(&parser));
    return parser;
}

tmini_ring_t any_ring_like(const tmini_ring_t *ring)
{
    const tmini_ring_t other = any_early_ring(ring->size);
    ASSUME(other.window == ring->window);
    return other;
}

void let_bytes_come(tmini_ring_t *ring)
{
    fed = ring;
    has_come = has_come && ring == NULL;
}

bool have_bytes_come(void)
{
    return has_come;
}

/* The producer, between two accesses of the consumer. */
static void come(tmini_ring_t *ring)
{
    const size_t count = nondet_byte();
    if (ring->window == ring->size) {
        ASSUME(count <= (ring->gate != 0 ? ring->limit - ring->head : 0));
        if (any_bool()) {
            ring->overrun += nondet_byte();
            ring->gate = 0;
        }
    }
    ring->head += count;
}

void proof_access(void)
{
    if (fed != NULL && any_bool()) {
        has_come = true;
        come(fed);
    }
}
