/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign_host.h"

#include "interrupting_atomic.h"

#include <stdlib.h>
#include <string.h>

#define NEVER UINT64_MAX
#define IDLE_LINE_US 90u /* Two byte times. */
#define BYTE_US 76u      /* Mean time per byte of a scanning lidar (section 1). */

static host_t *polling; /* Set while tmini_poll() runs, but not while an interrupt does. */

static uint64_t now_us(const host_t *host)
{
    return host->now_ns / 1000u;
}

static uint64_t arrival_us(const host_t *host, uint32_t byte)
{
    return byte < host->line->size ? host->begun_us + host->line->at_us[byte] : NEVER;
}

static bool happens(host_t *host, uint32_t one_in)
{
    return one_in > 0 && random_below(host->random, one_in) == 0;
}

static void report_gap(host_t *host)
{
    host->gaps_reported++;
    for (uint32_t times = host->config.reports_twice ? 2 : 1; times > 0; times--) {
        tmini_feed_gap(&host->lidar);
    }
}

/* Hands a block over. The library may refuse the end of it. */
static void feed(host_t *host, uint32_t from, uint32_t count)
{
    const size_t stored = tmini_feed(&host->lidar, &host->line->bytes[from], count);
    line_lose(host->line, from + (uint32_t)stored, from + count);
    host->reported += count;
}

/* ---- One interrupt per byte ---- */

static void receive_byte(host_t *host)
{
    const size_t refused = tmini_ring_overrun(&host->lidar.ring);
    tmini_feed_byte(&host->lidar, host->line->bytes[host->next]);
    if (tmini_ring_overrun(&host->lidar.ring) != refused) {
        line_lose(host->line, host->next, host->next + 1);
    }
    host->next++;
    host->reported++;
}

static uint64_t receive_bytes(host_t *host)
{
    const uint64_t until_us = now_us(host);
    while (arrival_us(host, host->next) <= until_us) {
        receive_byte(host);
    }
    return arrival_us(host, host->next);
}

/* ---- A layer below, which an overflow closes until it is empty ---- */

static uint32_t room(const host_t *host)
{
    return host->config.asks_room ? (uint32_t)tmini_feed_room(&host->lidar) : UINT32_MAX;
}

static void lose_what_overflowed(host_t *host)
{
    line_lose(host->line, host->fed, host->next);
    host->fed = host->next;
    host->closed_at = 0;
    report_gap(host);
}

static uint32_t held_bytes(const host_t *host)
{
    return (host->closed_at > 0 ? host->closed_at : host->next) - host->fed;
}

/* Bytes without room stay in the layer below, and may be reported. */
static void hand_over(host_t *host)
{
    const uint32_t fits = room(host);
    const uint32_t count = held_bytes(host) < fits ? held_bytes(host) : fits;
    feed(host, host->fed, count);
    host->fed += count;
    if (host->closed_at > 0 && held_bytes(host) == 0) {
        lose_what_overflowed(host);
    }
    if (host->config.reports_held) {
        tmini_feed_held(&host->lidar, held_bytes(host));
    }
}

static void hold_bytes(host_t *host, uint64_t until_us)
{
    while (arrival_us(host, host->next) <= until_us) {
        if (host->closed_at == 0 && held_bytes(host) == host->config.block_size) {
            host->closed_at = host->next;
        }
        host->next++;
    }
}

static uint64_t receive_blocks(host_t *host)
{
    const uint64_t until_us = now_us(host);
    while (host->config.block_us > 0 && host->block_due_us <= until_us) {
        hold_bytes(host, host->block_due_us);
        hand_over(host);
        host->block_due_us += happens(host, host->config.hold_one_in)
                                  ? random_between(host->random, 20000, 95000)
                                  : host->config.block_us;
    }
    hold_bytes(host, until_us);
    return host->config.block_us > 0 ? host->block_due_us : NEVER;
}

/* ---- Circular DMA ---- */

/* As in a port: if the flags of both halves are pending, a lap may have been lost. */
static void serve_dma(host_t *host)
{
    if (!host->half && !host->full && !host->idle) {
        return;
    }
    if ((host->half && host->full) || happens(host, host->config.false_gap_one_in)) {
        report_gap(host);
    }
    host->half = false;
    host->full = false;
    host->idle = false;
    host->published = host->position;
    tmini_feed_dma(&host->lidar, host->position);
    host->reported = (uint32_t)tmini_feed_position(&host->lidar); /* A gap counts as a lap. */
}

static void write_byte(host_t *host)
{
    host->rx[host->position++] = host->line->bytes[host->next++];
    host->half |= host->position == host->config.rx_size / 2;
    if (host->position == host->config.rx_size) {
        host->position = 0;
        host->full = true;
    }
}

static uint64_t receive_dma(host_t *host)
{
    const uint64_t until_us = now_us(host);
    for (;;) {
        const uint64_t byte_us = arrival_us(host, host->next);
        const uint64_t idle_us = host->next > 0 && host->published != host->position
                                     ? arrival_us(host, host->next - 1) + IDLE_LINE_US
                                     : NEVER;
        if (idle_us < byte_us && idle_us <= until_us && !host->idle) {
            host->idle = true;
        } else if (byte_us <= until_us) {
            write_byte(host);
        } else {
            return byte_us < idle_us || host->idle ? byte_us : idle_us;
        }
        if (!host->stalled) {
            serve_dma(host);
        }
    }
}

/* ---- Time ---- */

static void receive(host_t *host)
{
    static uint64_t (*const receivers[FEED_KINDS])(host_t * host) = {
        [FEED_BYTES] = receive_bytes, [FEED_BLOCKS] = receive_blocks, [FEED_DMA] = receive_dma};
    const uint64_t due_us = host->started ? receivers[host->config.feed](host) : NEVER;

    host->due_ns = due_us < NEVER / 1000u ? due_us * 1000u : NEVER;
}

void host_wait_us(host_t *host, uint64_t us)
{
    host->now_ns += us * 1000u;
    receive(host);
}

/* The CPU stops while DMA receives any number of bytes, often nearly whole laps. */
static void stall(host_t *host)
{
    const uint32_t lap = (uint32_t)host->config.rx_size;
    const uint32_t laps = random_between(host->random, 0, host->config.stall_laps);
    const uint32_t more = random_below(host->random, 2) == 0 ? random_below(host->random, lap)
                                                             : random_below(host->random, 64);
    const uint32_t last = host->next + laps * lap + more;
    const uint64_t end_us = arrival_us(host, last < host->line->size ? last : host->line->size - 1);
    host->stalled = true;
    if (end_us > now_us(host)) {
        host_wait_us(host, end_us - now_us(host));
    }
    host->stalled = false;
    serve_dma(host);
    receive(host);
}

static bool may_stall(host_t *host)
{
    return host->config.feed == FEED_DMA && host->started && host->next < host->line->size &&
           happens(host, host->config.stall_one_in);
}

static void preempt(host_t *host)
{
    if (may_stall(host)) {
        stall(host);
    } else {
        host_wait_us(host, random_between(host->random, 1, host->config.preempt_us));
    }
}

void interrupt(void)
{
    host_t *const host = polling;
    if (host == NULL) {
        return;
    }
    host->accesses++;
    host->now_ns += host->config.access_ns;
    if (host->now_ns < host->due_ns && host->accesses != host->preempted_at) {
        return;
    }
    polling = NULL; /* An interrupt cannot be interrupted. */
    if (host->accesses == host->preempted_at) {
        preempt(host);
    } else {
        receive(host);
    }
    polling = host;
}

/* ---- The port ---- */

static uint32_t read_clock(void *context)
{
    const host_t *const host = context;
    const host_config_t *const config = &host->config;
    const bool is_back = host->started && now_us(host) - host->begun_us >= config->back_at_us;
    return (uint32_t)(now_us(host) * (uint64_t)(1000000 + config->clock_ppm) / 1000000000u) -
           (is_back ? config->back_ms : 0);
}

static int take_command(void *context, const uint8_t *bytes, size_t count)
{
    host_t *const host = context;
    if (count == 2 && bytes[1] == 0x60 && !host->started) {
        host->started = true;
        host->begun_us = now_us(host);
        host->block_due_us = host->begun_us + 1;
        host->due_ns = 0;
    }
    return (int)count;
}

static const tmini_port_t port = {.write = take_command, .now_ms = read_clock};

/* ---- The program ---- */

void host_begin(host_t *host, const host_config_t *config, line_t *line, random_t *random)
{
    const tmini_config_t library = {.port = &port,
                                    .port_context = host,
                                    .rx_buffer = host->rx,
                                    .rx_size = config->rx_size,
                                    .rx_dma = config->feed == FEED_DMA,
                                    .points = host->points,
                                    .max_points = config->max_points,
                                    .recovery = TMINI_RECOVERY_OFF,
                                    .timing = &host->timing};
    memset(host, 0, offsetof(host_t, points));
    memset(&host->now_ns, 0, sizeof *host - offsetof(host_t, now_ns));
    host->config = *config;
    host->timing = tmini_timing_default;
    host->timing.max_pause_ms = config->max_pause_ms;
    host->line = line;
    host->random = random;
    host->now_ns = (uint64_t)random_u32(random) * 1000000u; /* The clock may wrap around. */
    if (tmini_init(&host->lidar, &library) != TMINI_OK) {
        abort();
    }
    (void)tmini_start(&host->lidar);
    while (!host->started) {
        (void)tmini_poll(&host->lidar);
        host->now_ns += 1000000u;
    }
}

tmini_event_t host_poll(host_t *host)
{
    tmini_event_t event;
    host->reported_before_poll = host->reported;
    host->accesses = 0;
    host->preempted_at = 0;
    if (happens(host, host->config.preempt_one_in)) {
        host->preempted_at = random_between(host->random, 1, 200);
    }
    polling = host;
    event = tmini_poll(&host->lidar);
    polling = NULL;
    host->was_lost |= event == TMINI_EVENT_LOST;
    return event;
}

void host_fetch(host_t *host)
{
    if (host->config.feed == FEED_BLOCKS && host->config.block_us == 0) {
        hand_over(host);
    }
}

bool host_was_undisturbed(const host_t *host)
{
    return host->reported == host->reported_before_poll;
}

void host_rest(host_t *host)
{
    if (may_stall(host)) {
        stall(host);
    }
    host_wait_us(host, host->config.poll_us);
}

void host_handle_scan(host_t *host)
{
    if (happens(host, host->config.handle_one_in)) {
        const uint32_t free = host->config.block_size - held_bytes(host);
        const uint32_t bridged_us = free * 9 / 10 * BYTE_US;
        const uint32_t most_us = host->config.is_bridged && bridged_us < host->config.handler_us
                                     ? bridged_us
                                     : host->config.handler_us;
        host_wait_us(host, random_between(host->random, 1000, most_us > 1000 ? most_us : 1000));
    }
}

bool host_has_received_all(const host_t *host)
{
    const bool held = host->config.feed == FEED_BLOCKS && host->fed < host->next;
    const bool unpublished = host->config.feed == FEED_DMA && host->published != host->position;
    return host->next >= host->line->size && !held && !unpublished;
}
