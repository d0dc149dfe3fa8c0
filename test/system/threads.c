/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* threads RECORDING [TURNS]
 *
 * Uses the public functions from two threads, as from two cores: one feeds a recording, byte by
 * byte and in blocks; the other polls and reads the scans. In every second pass through the
 * recording the feeder does not wait for room, and the other thread pauses at the beginning, so
 * that the ring is closed and opened. threads.sh builds it, with the library, under
 * ThreadSanitizer. Exit status 0 if scans came and bytes were refused. */

#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>

#include "tmini/tmini.h"

/* More bytes than the ring and one poll can take. */
#define BYTES_AT_REST 4096

static uint8_t recording[100000];
static size_t size;
static size_t turns = 6;

static uint8_t rx[512];
static tmini_point_t points[800];
static tmini_t lidar;

/* Atomic but relaxed, so that only the library's own barriers order memory accesses. */
static int is_fed;
static int is_at_rest;

static void set(int *flag, int value)
{
    __atomic_store_n(flag, value, __ATOMIC_RELAXED);
}

static int is_set(const int *flag)
{
    return __atomic_load_n(flag, __ATOMIC_RELAXED);
}

static uint32_t now_ms(void *context)
{
    static uint32_t calls; /* Only the polling thread uses it. */
    (void)context;
    return calls++ / 64;
}

static const tmini_port_t port = {.now_ms = now_ms};

static void wait_for_room(size_t wanted)
{
    while (tmini_feed_room(&lidar) < wanted) {
        sched_yield();
    }
}

static void *feed(void *unused)
{
    for (size_t at = 0; at < turns * size;) {
        const size_t from = at % size;
        const size_t count = from + 40 < size && at % 80 == 0 ? 40 : 1;
        const bool is_waiting = at / size % 2 == 0;
        set(&is_at_rest, !is_waiting && from < BYTES_AT_REST);
        if (is_waiting) {
            wait_for_room(count);
        }
        if (count == 1) {
            tmini_feed_byte(&lidar, recording[from]);
        } else {
            (void)tmini_feed(&lidar, recording + from, count);
        }
        at += count;
    }
    set(&is_fed, 1);
    return unused;
}

static unsigned long brightness(const tmini_scan_t *scan)
{
    unsigned long sum = 0;
    for (size_t i = 0; i < scan->count; i++) {
        sum += scan->points[i].intensity;
    }
    return sum;
}

int main(int argc, char **argv)
{
    static const tmini_config_t config = {.port = &port,
                                          .rx_buffer = rx,
                                          .rx_size = sizeof rx,
                                          .points = points,
                                          .max_points = 800,
                                          .listen_only = true};
    unsigned scans = 0;
    unsigned long sum = 0;
    pthread_t feeder;
    FILE *const file = argc >= 2 ? fopen(argv[1], "rb") : NULL;
    if (file == NULL) {
        return 2;
    }
    turns = argc > 2 ? strtoul(argv[2], NULL, 10) : turns;
    size = fread(recording, 1, sizeof recording, file);
    fclose(file);
    if (tmini_init(&lidar, &config) != TMINI_OK || tmini_start(&lidar) != TMINI_OK ||
        pthread_create(&feeder, NULL, feed, NULL) != 0) {
        return 1;
    }
    while (!is_set(&is_fed)) {
        if (is_set(&is_at_rest)) {
            sched_yield();
        } else if (tmini_poll(&lidar) == TMINI_EVENT_SCAN) {
            scans++;
            sum += brightness(tmini_scan(&lidar));
        }
    }
    pthread_join(feeder, NULL);
    tmini_counters_t counters;
    tmini_counters(&lidar, &counters);
    printf("%u scans, brightness %lu, %lu bytes refused\n", scans, sum,
           (unsigned long)counters.bytes_overrun);
    return scans > 0 && counters.bytes_overrun > 0 ? 0 : 1;
}
