/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Makes the table of intact points on damaged lines in docs/results.md. A point is intact if the
 * reference decoder finds its packet in the bytes that reached the ring, after the first start
 * packet. Each line prints a row: how many intact points are in exactly one scan. */

#include "random.h"
#include "reference_decoder.h"
#include "turns.h"

#include "unity.h"

#include <stdio.h>

#define TURNS_MAX 200u
#define STREAM_MAX (TURNS_MAX * 2200u)
#define POINTS_MAX (TURNS_MAX * TURNS_POINTS)
#define LIDAR_US 76u /* From byte to byte: 13.1 kB/s (section 1). */
#define FAST_US 50u  /* 20 kB/s. */

static uint8_t line[STREAM_MAX]; /* The bytes sent. */
static size_t line_size;
static uint8_t stored[STREAM_MAX]; /* Those that the ring has stored since the last refusal. */
static size_t stored_size;

static reference_point_t expected[POINTS_MAX]; /* All intact points, in order. */
static size_t expected_count;
static bool has_started; /* A start packet has come. */

static tmini_point_t delivered[2 * POINTS_MAX];
static size_t delivered_count;
static unsigned complete; /* Complete scans. */

static random_t random;

void setUp(void)
{
    random_seed(&random, 1);
    line_size = stored_size = expected_count = delivered_count = complete = 0;
    has_started = false;
    turns_open(1024, false);
    (void)tmini_start(&turns.lidar);
    (void)turns_poll();
    turns.now_ms += 100;
    (void)turns_poll(); /* The line is quiet: the lidar is asked, and started. */
    turns_feed(line, encode_frequency_reply(line, 600));
    (void)turns_poll();
    line_size = encode_scan_reply(line);
}

void tearDown(void) {}

static void send_turns(unsigned count)
{
    for (unsigned turn = 1; turn <= count; turn++) {
        for (unsigned index = 0; index < TURNS_PACKETS; index++) {
            line_size += turns_packet(&line[line_size], index, (uint16_t)turn);
        }
    }
}

/* ---- What is expected ---- */

static void expect_points(void *context, const reference_item_t *item)
{
    (void)context;
    has_started |= item->is_packet && item->starts_revolution;
    for (unsigned i = 0; has_started && i < item->lsn; i++) {
        expected[expected_count++] = reference_point(item->bytes, i);
    }
}

/* Call it when the ring refuses bytes, and at the end. */
static void expect_stored(void)
{
    static const reference_reply_t reply = {.mode = 1, .type = 0x81};
    const reference_options_t options = {.max_samples = 80, .awaited = &reply};

    (void)reference_decode(stored, stored_size, &options, expect_points, NULL);
    stored_size = 0;
}

/* ---- What is delivered ---- */

static void keep_points(const tmini_scan_t *scan)
{
    for (unsigned i = 0; i < scan->count; i++) {
        delivered[delivered_count++] = scan->points[i];
    }
}

static void poll(void)
{
    tmini_event_t event;

    while ((event = tmini_poll(&turns.lidar)) != TMINI_EVENT_NONE) {
        if (event == TMINI_EVENT_SCAN) {
            keep_points(tmini_scan(&turns.lidar));
            complete += tmini_scan(&turns.lidar)->complete ? 1 : 0;
        }
    }
}

static void store(uint8_t byte)
{
    if (tmini_feed(&turns.lidar, &byte, 1) == 1) {
        stored[stored_size++] = byte;
    } else {
        expect_stored();
    }
}

/* Per 10,000 bytes: how many are lost, and how many get a flipped bit. */
typedef struct {
    uint32_t drops;
    uint32_t flips;
} damage_t;

static bool happens(uint32_t in_10000)
{
    return in_10000 > 0 && random_below(&random, 10000) < in_10000;
}

/* Sends the line. At its end, the points of the unfinished scan count as delivered. */
static void receive(uint32_t byte_us, uint32_t poll_us, damage_t damage)
{
    const uint32_t since_ms = turns.now_ms;
    uint32_t next_poll_us = poll_us;

    for (size_t i = 0; i < line_size; i++) {
        const uint8_t flip = happens(damage.flips) ? (uint8_t)(1u << random_below(&random, 8)) : 0;

        for (; next_poll_us <= i * byte_us; next_poll_us += poll_us) {
            turns.now_ms = since_ms + next_poll_us / 1000;
            poll();
        }
        if (!happens(damage.drops)) {
            store(line[i] ^ flip);
        }
    }
    poll();
    expect_stored();
    keep_points(&turns.lidar.decoder.builder.scan);
}

/* ---- How many of the expected points were delivered ---- */

static bool is_same(const reference_point_t *sent, const tmini_point_t *point)
{
    return sent->angle_q6 == point->angle_q6 && sent->distance_mm == point->distance_mm &&
           sent->intensity == point->intensity && sent->flag == point->flag;
}

/* Fails if another point was delivered, or one twice. */
static size_t found_in_order(void)
{
    size_t searched = 0;

    for (size_t i = 0; i < delivered_count; i++) {
        while (searched < expected_count && !is_same(&expected[searched], &delivered[i])) {
            searched++;
        }
        TEST_ASSERT_TRUE_MESSAGE(searched < expected_count, "a point that is not expected");
        searched++;
    }
    return delivered_count;
}

static void all_intact_points_came(const char *what)
{
    const size_t found = found_in_order();

    printf("%-44s %7u intact points, %7u in one scan (%.3f %%); %u complete scans\n", what,
           (unsigned)expected_count, (unsigned)found,
           100.0 * (double)found / (double)expected_count, complete);
    TEST_ASSERT_EQUAL_UINT(expected_count, found);
}

/* ---- The table ---- */

/* 22 turns of 658 points. In one turn, the point of the start packet is not intact. */
void test_a_flipped_bit_in_a_start_packet_costs_one_point(void)
{
    send_turns(22);
    const size_t start = 7 + 10 * ((line_size - 7) / 22);

    TEST_ASSERT_EQUAL_HEX8(0xAA, line[start]);
    line[start + 8] ^= 1;
    receive(LIDAR_US, 2000, (damage_t){0, 0});
    TEST_ASSERT_EQUAL_UINT(22 * TURNS_POINTS - 1, expected_count);
    all_intact_points_came("one bit in one start packet");
    /* All but the two turns next to it and the last one, which has not ended. */
    TEST_ASSERT_EQUAL_UINT(19, complete);
}

void test_damaged_lines_lose_no_intact_point(void)
{
    static const struct {
        damage_t damage;
        const char *what;
    } lines[] = {{{10, 0}, "drops 1e-3"},
                 {{30, 0}, "drops 3e-3"},
                 {{0, 10}, "flips 1e-3"},
                 {{0, 30}, "flips 3e-3"}};

    for (unsigned i = 0; i < 4; i++) {
        setUp();
        send_turns(TURNS_MAX);
        receive(LIDAR_US, 2000, lines[i].damage);
        all_intact_points_came(lines[i].what);
    }
}

/* 1200 bytes come between two polls. */
void test_a_ring_that_overflows_between_polls(void)
{
    send_turns(TURNS_MAX);
    receive(FAST_US, 60000, (damage_t){0, 0});
    all_intact_points_came("20 kB/s, ring 1024, polled every 60 ms");
    TEST_ASSERT_TRUE(expected_count > POINTS_MAX / 2);
}

/* The lidar begins with a start packet, so its first turn is complete. */
void test_the_first_turn_after_a_start_is_there_at_any_poll_interval(void)
{
    for (uint32_t poll_ms = 1; poll_ms <= 5; poll_ms++) {
        char what[60];

        setUp();
        send_turns(3);
        receive(LIDAR_US, poll_ms * 1000, (damage_t){0, 0});
        TEST_ASSERT_EQUAL_UINT(3 * TURNS_POINTS, expected_count);
        (void)snprintf(what, sizeof what, "after a start, polls of %u ms", (unsigned)poll_ms);
        all_intact_points_came(what);
        TEST_ASSERT_EQUAL_UINT(2, complete); /* The third turn has not ended. */
    }
}
