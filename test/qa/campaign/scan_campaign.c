/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* campaign SCANS [SEED [MODE [TRIAL]]]
 *
 * Checks that no scan reports anything wrong. Runs the library in virtual time with a line that
 * falls silent in mid-scan, with programs that are busy for too long, and with receivers that
 * lose bytes. Checks SCANS scans in each mode (or in the given one): see campaign_oracle.h. Exit
 * status: 0 no scan was wrong, 1 some were, 2 wrong usage. The same seed gives the same run;
 * TRIAL runs only that trial. */

#include "campaign_oracle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SILENCE_MS 300u /* Longer than the parser waits for the rest of a packet. */

typedef struct {
    const char *name;
    const char *what;
    bool interrupts_line;
    bool costs_nothing; /* Each revolution without losses must be delivered as complete. */
    void (*draw)(host_config_t *host, random_t *random);
} campaign_mode_t;

static line_t line;
static host_t host;

/* ---- Random settings: those of all modes, then those of each mode ---- */

static uint32_t one_of(random_t *random, const uint32_t *values, size_t count)
{
    return values[random_below(random, (uint32_t)count)];
}

static line_config_t draw_line(random_t *random)
{
    static const uint32_t frequencies[] = {600, 800, 1000, 1200};
    const bool at_zero = random_below(random, 2) == 0;
    return (line_config_t){.frequency_chz = one_of(random, frequencies, 4),
                           .start_angle_q6 = at_zero ? 0 : random_below(random, 23040),
                           .revolutions = random_between(random, 10, LINE_REVOLUTIONS),
                           .ct_information = random_below(random, 2) == 0,
                           .spins_up = random_below(random, 8) == 0};
}

/* A controller that keeps up. */
static host_config_t draw_host(random_t *random)
{
    static const uint32_t accesses_ns[] = {50, 200, 1000, 3000};
    const feed_t feed = (feed_t)random_below(random, FEED_KINDS);
    return (host_config_t){.feed = feed,
                           .rx_size = feed == FEED_DMA ? 2048 : 1024,
                           .max_points = HOST_POINTS,
                           .poll_us = random_between(random, 200, 20000),
                           .access_ns = one_of(random, accesses_ns, 4),
                           .block_us = random_between(random, 500, 10000),
                           .asks_room = random_below(random, 2) == 0,
                           .reports_held = random_below(random, 2) == 0,
                           .block_size = 2048,
                           .preempt_us = 5000,
                           .preempt_one_in = 20,
                           .clock_ppm = (int32_t)random_between(random, 0, 60000) - 30000,
                           .max_pause_ms = 30,
                           .reports_twice = random_below(random, 2) == 0};
}

static void draw_nothing(host_config_t *config, random_t *random)
{
    (void)config, (void)random;
}

/* The program is busy for up to nine tenths of the time that the layer below can bridge; this layer
 * reports its bytes. */
static void draw_bridged(host_config_t *config, random_t *random)
{
    config->feed = FEED_BLOCKS;
    config->poll_us = random_between(random, 200, 10000);
    config->block_us = random_between(random, 200, 2000);
    config->asks_room = true;
    config->reports_held = true;
    config->block_size = random_below(random, 2) == 0 ? 2048 : 8192;
    config->handle_one_in = random_between(random, 1, 20);
    config->handler_us = 600000;
    config->is_bridged = true;
}

/* The clock is set back at some time in the line's first 1.5 s. */
static void draw_set_back(host_config_t *config, random_t *random)
{
    config->poll_us = random_between(random, 200, 10000);
    config->back_ms = random_between(random, 1, 1000);
    config->back_at_us = random_between(random, 100000, 1500000);
}

static void draw_overflow(host_config_t *config, random_t *random)
{
    const uint32_t smallest = config->feed == FEED_DMA ? 9 : 8;
    config->rx_size = (size_t)1 << random_between(random, smallest, 13);
    config->handle_one_in = random_between(random, 1, 4);
    config->handler_us = random_between(random, 1, 6) * 100000;
    if (config->feed == FEED_BLOCKS && random_below(random, 3) == 0) {
        config->block_size = 128; /* A UART's FIFO, emptied too late. */
        config->block_us = random_between(random, 5000, 15000);
    }
}

static void draw_stalls(host_config_t *config, random_t *random)
{
    config->feed = FEED_DMA;
    config->rx_size = (size_t)1 << random_between(random, 9, 13);
    config->stall_laps = 9;
    config->false_gap_one_in = random_below(random, 2) == 0 ? 100 : 0;
    config->stall_one_in = random_between(random, 50, 400);
    config->preempt_one_in = random_between(random, 20, 400);
}

/* The task that hands over bytes is delayed again and again. */
static void draw_hold_ups(host_config_t *config, random_t *random)
{
    config->feed = FEED_BLOCKS;
    config->rx_size = (size_t)1 << random_between(random, 10, 16);
    config->poll_us = 1000;
    config->block_us = 1000;
    config->block_size = 4096;
    config->hold_one_in = random_between(random, 20, 400);
}

/* The program polls rarely, and the ring is large. */
static void draw_rare_polls(host_config_t *config, random_t *random)
{
    static const uint32_t polls_us[] = {100000, 350000, 500000, 700000, 1100000};
    config->poll_us = one_of(random, polls_us, 5);
    config->rx_size = (size_t)1 << random_between(random, 13, 16);
}

static void draw_limits(host_config_t *config, random_t *random)
{
    static const uint32_t limits_ms[] = {0, 70, 250};
    config->max_pause_ms = (uint16_t)one_of(random, limits_ms, 3);
    config->rx_size = (size_t)1 << random_between(random, 11, 16);
    if (random_below(random, 3) == 0) {
        draw_hold_ups(config, random);
    }
}

/* A layer below holds all bytes, and the program fetches them only from time to time. */
static void draw_held(host_config_t *config, random_t *random)
{
    config->feed = FEED_BLOCKS;
    config->rx_size = 8192;
    config->block_us = 0;
    config->block_size = 8192;
    config->poll_us = random_between(random, 100000, 250000);
}

static void draw_everything(host_config_t *config, random_t *random)
{
    if (random_below(random, 4) == 0) {
        draw_stalls(config, random);
    }
    draw_overflow(config, random);
    if (random_below(random, 4) == 0) {
        draw_held(config, random);
    } else if (random_below(random, 4) == 0) {
        draw_hold_ups(config, random);
    } else if (random_below(random, 4) == 0) {
        draw_limits(config, random);
    }
    if (random_below(random, 8) == 0) {
        config->max_points = random_between(random, 1, 500);
    }
}

static const campaign_mode_t modes[] = {
    {"healthy", "nothing goes wrong", false, true, draw_nothing},
    {"held", "nothing goes wrong; 100 to 250 ms between polls, bytes held below", false, true,
     draw_held},
    {"bridged",
     "nothing goes wrong; the program is busy for as long as a layer below can hold bytes", false,
     true, draw_bridged},
    {"pause", "the line falls silent for 0 to 5 turns", true, false, draw_nothing},
    {"hold-up", "the same; polled each millisecond, and what comes is held up for 20 to 95 ms",
     true, false, draw_hold_ups},
    {"rare", "the same; polled each 100 to 1100 ms, ring of 8192 to 65536", true, false,
     draw_rare_polls},
    {"limits", "the same; max_pause_ms of 0, 70 or 250", true, false, draw_limits},
    {"waiting", "the same, while a layer below holds bytes and reports them", true, false,
     draw_bridged},
    {"set back", "the same, and once the clock steps back by up to a second", true, false,
     draw_set_back},
    {"overflow", "the program is busy for 1 to 600 ms, ring of 256 to 8192", false, false,
     draw_overflow},
    {"stall", "DMA goes on for 0 to 9 laps while the CPU stands still", false, false, draw_stalls},
    {"mixed", "all of it at once", true, false, draw_everything},
};

#define MODES (sizeof modes / sizeof modes[0])

/* ---- A trial ---- */

static void poll_until_nothing(oracle_t *oracle)
{
    tmini_event_t event;
    while ((event = host_poll(&host)) != TMINI_EVENT_NONE) {
        if (event == TMINI_EVENT_SCAN) {
            oracle_judge_scan(oracle, &host, tmini_scan(&host.lidar));
            host_handle_scan(&host);
        }
    }
    if (host_was_undisturbed(&host)) {
        oracle_judge_account(oracle, &host);
    }
}

static void say_what_is_tried(void)
{
    static const char *const feeds[FEED_KINDS] = {"bytes", "blocks", "DMA"};
    const host_config_t *const config = &host.config;
    printf("%u revolutions at %u.%u Hz%s%s\n", line.config.revolutions,
           line.config.frequency_chz / 100, line.config.frequency_chz / 10 % 10,
           line.config.ct_information ? ", CT information" : "",
           line.config.spins_up ? ", spinning up" : "");
    for (uint32_t i = 1; i < line.size; i++) {
        if (line.at_us[i] - line.at_us[i - 1] > 15000) {
            const line_packet_t *const before = &line.packets[line.owner[i - 1]];
            const line_packet_t *const after = &line.packets[line.owner[i]];
            printf("silent from %u to %u ms: revolution %u to %u\n", line.at_us[i - 1] / 1000,
                   line.at_us[i] / 1000, before->revolution, after->revolution);
        }
    }
    printf("fed by %s%s%s, ring %zu, polled every %u us, blocks of %u every %u us\n",
           feeds[config->feed], config->asks_room ? " that wait for room" : "",
           config->reports_held ? " and are reported" : "", config->rx_size, config->poll_us,
           config->block_size, config->block_us);
    printf(
        "busy for up to %u us: one scan in %u; pre-empted for up to %u us: one poll in %u; stalled "
        "one in %u, held up one in %u; clock %+d ppm, back by %u ms at %u ms, max_pause_ms %u\n",
        config->handler_us, config->handle_one_in, config->preempt_us, config->preempt_one_in,
        config->stall_one_in, config->hold_one_in, (int)config->clock_ppm, config->back_ms,
        config->back_at_us / 1000, config->max_pause_ms);
}

static void run_trial(const campaign_mode_t *mode, uint64_t seed, uint64_t trial, bool speaks,
                      verdicts_t *verdicts)
{
    random_t random;
    oracle_t oracle;
    random_seed(&random, seed * 1000003u + trial);
    const line_config_t line_config = draw_line(&random);
    host_config_t host_config = draw_host(&random);
    mode->draw(&host_config, &random);
    host_config.reports_held |= host_config.asks_room; /* tmini_feed() requires this. */
    line_make(&line, &line_config, &random);
    if (mode->interrupts_line) {
        line_interrupt(&line, &random);
    }
    host_begin(&host, &host_config, &line, &random);
    oracle_begin(&oracle, verdicts, trial, &line, speaks);
    if (speaks) {
        say_what_is_tried();
    }
    while (!host_has_received_all(&host)) {
        poll_until_nothing(&oracle); /* Also before the program fetches bytes: a useless poll. */
        host_fetch(&host);
        poll_until_nothing(&oracle);
        host_rest(&host);
    }
    host.config.access_ns = 0;
    host.config.preempt_one_in = 0;
    for (uint32_t ms = 0; ms < SILENCE_MS + host_config.back_ms; ms += 10) {
        host_fetch(&host);
        poll_until_nothing(&oracle);
        host_wait_us(&host, 10000);
    }
    oracle_end(&oracle, &host);
}

/* ---- Reports ---- */

static bool lied(const campaign_mode_t *mode, const verdicts_t *verdicts)
{
    uint64_t wrongs = 0;
    for (unsigned wrong = 0; wrong < WRONG_KINDS; wrong++) {
        /* With all at once, half a packet may be held for longer than frame_timeout_ms. */
        const bool is_unjudged = (wrong == WRONG_COST && !mode->costs_nothing) ||
                                 (wrong == WRONG_LOSS && mode->draw == draw_everything);
        if (!is_unjudged) {
            wrongs += verdicts->wrongs[wrong];
        }
    }
    return wrongs > 0;
}

static void report(const campaign_mode_t *mode, const verdicts_t *verdicts)
{
    printf("%s: %s\n", mode->name, mode->what);
    printf("  %llu trials, %llu scans (%llu complete), %llu points, %llu bytes, "
           "%llu overrun, %llu losses reported\n",
           (unsigned long long)verdicts->trials, (unsigned long long)verdicts->scans,
           (unsigned long long)verdicts->complete, (unsigned long long)verdicts->points,
           (unsigned long long)verdicts->bytes, (unsigned long long)verdicts->overrun,
           (unsigned long long)verdicts->gaps_reported);
    printf("  %llu revolutions came whole for certain; %llu holes of less than 4 degrees left no "
           "trace\n",
           (unsigned long long)verdicts->untouched, (unsigned long long)verdicts->invisible);
    printf("  %llu intact points, %llu of them in exactly one scan: %.4f %%; %llu withheld\n",
           (unsigned long long)verdicts->intact, (unsigned long long)verdicts->in_one,
           verdicts->intact > 0 ? 100.0 * (double)verdicts->in_one / (double)verdicts->intact : 0.0,
           (unsigned long long)verdicts->withheld);
    for (unsigned mixed = 0; mixed < MIXED_STRANGE; mixed++) {
        if (verdicts->mixed[mixed] > 0) {
            printf("  %8llu incomplete scans of two revolutions: %s\n",
                   (unsigned long long)verdicts->mixed[mixed], oracle_mixed_name((mixed_t)mixed));
        }
    }
    for (unsigned wrong = 0; wrong < WRONG_KINDS; wrong++) {
        printf("  %8llu %s", (unsigned long long)verdicts->wrongs[wrong], oracle_name(wrong));
        if (verdicts->wrongs[wrong] > 0) {
            printf(" (first in trial %llu)", (unsigned long long)verdicts->first_trial[wrong]);
        }
        printf("\n");
    }
    (void)fflush(stdout);
}

static bool run_mode(const campaign_mode_t *mode, uint64_t scans, uint64_t seed, const char *only)
{
    verdicts_t verdicts = {0};
    if (only != NULL) {
        run_trial(mode, seed, strtoull(only, NULL, 10), true, &verdicts);
    } else {
        for (uint64_t trial = 0; verdicts.scans < scans; trial++) {
            run_trial(mode, seed, trial, false, &verdicts);
        }
    }
    report(mode, &verdicts);
    return !lied(mode, &verdicts);
}

int main(int argc, char **argv)
{
    const uint64_t scans = argc > 1 ? strtoull(argv[1], NULL, 10) : 0;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    bool found = false;
    bool honest = true;
    for (size_t i = 0; scans > 0 && i < MODES; i++) {
        if (argc <= 3 || strcmp(argv[3], modes[i].name) == 0 || strcmp(argv[3], "all") == 0) {
            found = true;
            honest &= run_mode(&modes[i], scans, seed, argc > 4 ? argv[4] : NULL);
        }
    }
    if (!found) {
        (void)fprintf(stderr, "usage: campaign SCANS [SEED [MODE [TRIAL]]]\n");
        return 2;
    }
    return honest ? 0 : 1;
}
