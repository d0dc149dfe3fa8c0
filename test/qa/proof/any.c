/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "proof.h"

/* Either way, unless a proof is run for each of the two. */
#ifndef FED_BY_DMA
#define FED_BY_DMA any_bool()
#endif

uint8_t ring_memory[LARGE_RING_SIZE];

static tmini_ring_t *fed; /* NULL: no byte arrives. */
static bool has_come;

tmini_parser_t nondet_parser(void);

bool any_bool(void)
{
    return (nondet_byte() & 1u) != 0;
}

/* The producer may already know that there is some room. */
static void let_stop_be_ahead(tmini_ring_t *ring)
{
    ring->origin = (uintptr_t)&ring->memory[ring->head & (ring->size - 1)] - ring->head;
    ring->stop = nondet_size();
    ASSUME(ring_is_sound(ring));
}

static void fill_memory(size_t size)
{
    for (size_t i = 0; i < size; i++) {
        ring_memory[i] = nondet_byte();
    }
}

tmini_ring_t any_ring_of(size_t size)
{
    fill_memory(size);
    tmini_ring_t ring = {.memory = ring_memory,
                         .size = size,
                         .window = any_bool() ? size / 2 : size,
                         .tail = nondet_size(),
                         .head = nondet_size(),
                         .overrun = nondet_size()};
    let_stop_be_ahead(&ring);
    return ring;
}

tmini_ring_t any_ring(void)
{
    return any_ring_of(RING_SIZE);
}

tmini_ring_t any_early_ring(size_t size)
{
    fill_memory(size);
    const bool dma = FED_BY_DMA;
    const bool is_closed = !dma && any_bool();
    const size_t tail = (size_t)nondet_byte() - size;
    const uint16_t unread = nondet_half();
    ASSUME(dma || unread <= size);
    tmini_ring_t ring = {.memory = ring_memory,
                         .size = size,
                         .window = dma ? size / 2 : size,
                         .tail = tail,
                         .head = tail + unread + (is_closed ? TMINI_RING_CLOSED : 0)};
    let_stop_be_ahead(&ring);
    return ring;
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

void let_bytes_come(tmini_ring_t *ring)
{
    fed = ring;
    has_come = has_come && ring == NULL;
}

bool have_bytes_come(void)
{
    return has_come;
}

/* Does what the producer may do between two accesses of the consumer. In a ring fed by the CPU, it
 * may store bytes if there is room, and close the ring, whether full or not. */
static void come(tmini_ring_t *ring)
{
    const size_t count = nondet_byte();
    if (!tmini_ring_is_dma(ring)) {
        const size_t room = ring->tail + ring->size - ring->head;
        const bool is_open = room <= ring->size;
        ASSUME(count <= (is_open ? room : 0));
        if (any_bool()) {
            ring->overrun += nondet_byte();
            ring->head += is_open ? TMINI_RING_CLOSED : 0;
        }
    }
    ring->head += count;
    ring->stop = ring->head;
}

static void let_other_side_act(void)
{
    if (fed != NULL && any_bool()) {
        has_come = true;
        come(fed);
    }
}

size_t tmini_load(const size_t *value)
{
    let_other_side_act();
    return *value;
}

void tmini_store(size_t *value, size_t stored)
{
    *value = stored;
    let_other_side_act();
}

void tmini_fence(void)
{
    let_other_side_act();
}
