/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* threads MILLIONS
 *
 * The ring between two threads, for this many million bytes put: those taken must be in order, and
 * where some are missing the ring was found closed. threads.sh runs it under ThreadSanitizer. Exit
 * status 0 if all was right, 1 if not, 2 on wrong usage. */

#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>

#include "tmini/parts/tmini_ring.h"

#define SIZE 256u

static uint8_t memory[SIZE];
static tmini_ring_t ring;
static size_t total;

/* What the n-th byte is: of a sequence that repeats after a prime number of bytes. */
static uint8_t byte_at(size_t n)
{
    return (uint8_t)(n % 251);
}

static void *put_all(void *unused)
{
    size_t next = 0;
    while (next < total) {
        for (unsigned burst = 0; burst < 200 && next < total; burst++) {
            tmini_ring_put(&ring, byte_at(next++));
        }
        sched_yield();
    }
    return unused;
}

typedef struct {
    size_t taken;
    size_t openings;
    bool may_miss;
    uint8_t expected;
    bool is_right;
} consumer_t;

/* As the parser: each byte where it lies, then all of them are given back. */
static void take(consumer_t *consumer, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const uint8_t byte = tmini_ring_peek(&ring, i);
        if (byte != consumer->expected && !consumer->may_miss) {
            consumer->is_right = false;
        }
        consumer->may_miss = false;
        consumer->expected = (uint8_t)((byte + 1u) % 251);
    }
    tmini_ring_discard(&ring, count);
    consumer->taken += count;
}

static void look(consumer_t *consumer)
{
    const size_t unread = tmini_ring_unread(&ring);
    if (unread > 0) {
        take(consumer, unread);
    } else if (tmini_ring_is_closed(&ring) && tmini_ring_unread(&ring) == 0) {
        consumer->may_miss = true;
        consumer->openings++;
        tmini_ring_open(&ring);
    } else {
        sched_yield();
    }
}

int main(int argc, char **argv)
{
    pthread_t producer;
    consumer_t consumer = {.is_right = true};
    total = argc == 2 ? (size_t)strtoul(argv[1], NULL, 10) * 1000000u : 0;
    if (total == 0 || tmini_ring_init(&ring, memory, SIZE, false) != TMINI_OK ||
        pthread_create(&producer, NULL, put_all, NULL) != 0) {
        (void)fprintf(stderr, "usage: threads MILLIONS\n");
        return 2;
    }
    while (consumer.taken + tmini_ring_overrun(&ring) < total) {
        look(&consumer);
    }
    (void)pthread_join(producer, NULL);
    printf("%zu bytes: %zu taken, %zu refused, the ring opened %zu times: %s\n", total,
           consumer.taken, tmini_ring_overrun(&ring), consumer.openings,
           consumer.is_right ? "in order" : "OUT OF ORDER");
    return consumer.is_right ? 0 : 1;
}
