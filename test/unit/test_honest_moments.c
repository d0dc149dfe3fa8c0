/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Bytes that come while tmini_poll() runs, between any two accesses of an index that the receiver
 * and the driver share. The library here is compiled with interrupting_atomic.h. */

#include "interrupting_atomic.h"
#include "turns.h"

#include "unity.h"

#include <string.h>

#define BIT(event) (1u << (event))

static void (*handler)(void); /* Called at each access; NULL: interrupts are off. */
static unsigned accesses;     /* Since the poll began. */
static unsigned chosen;       /* The access at which the handler acts. */

void interrupt(void)
{
    void (*const call)(void) = handler;

    accesses++;
    if (call != NULL) {
        handler = NULL; /* Interrupts do not nest. */
        call();
        handler = call;
    }
}

void setUp(void)
{
    handler = NULL;
    turns_open_scanning(1024, false);
}

void tearDown(void)
{
    handler = NULL;
}

static tmini_event_t poll_with(void (*come)(void))
{
    accesses = 0;
    handler = come;
    const tmini_event_t event = tmini_poll(&turns.lidar);
    handler = NULL;
    return event;
}

/* ---- Bytes refused while the parser runs ---- */

/* Turn 101 comes at once; the ring has no room for most of it. */
static void a_turn_comes(void)
{
    if (accesses == chosen) {
        turns_feed_packets(0, TURNS_PACKETS - 1, 101);
        turns_feed_packets(0, 8, 102);
    }
}

/* When the poll begins, the ring is full of packets of turn 100; the poll releases them one by
 * one. */
static bool overflow_at(unsigned access)
{
    turns_open_scanning(512, false);
    (void)turns_pass(0, 5, 100);
    turns_feed_packets(6, 8, 100);
    chosen = access;
    (void)poll_with(a_turn_comes);
    const bool came = accesses >= chosen;

    turns_feed_packets(9, 9, 102);
    (void)turns_poll();
    (void)turns_pass(10, TURNS_PACKETS - 1, 102);
    (void)turns_pass(0, TURNS_PACKETS - 1, 103);
    (void)turns_pass(0, 0, 104);
    return came;
}

void test_an_overflow_at_any_moment_of_a_poll_mixes_no_turns(void)
{
    unsigned access = 1;

    while (overflow_at(access)) {
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, turns_scans.mixed, "scans of two revolutions");
        TEST_ASSERT_TRUE(turns_scans.last.complete);
        access++;
    }
    TEST_ASSERT_TRUE(access > 10);
}

/* Packets come during polls; a few bytes find no room. */
static size_t sent;

static void packets_come_one_by_one(void)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    if (accesses % 3 == chosen % 3 && sent < 60) {
        const unsigned index = (unsigned)(sent % TURNS_PACKETS);

        turns_feed(bytes, turns_packet(bytes, index, (uint16_t)(101 + sent / TURNS_PACKETS)));
        sent++;
    }
}

static void expect_one_turn(const tmini_scan_t *scan)
{
    for (unsigned i = 1; i < scan->count; i++) {
        TEST_ASSERT_EQUAL_UINT16(scan->points[0].distance_mm, scan->points[i].distance_mm);
    }
}

void test_overflow_after_overflow_during_polls_mixes_no_turns(void)
{
    for (chosen = 0; chosen < 3; chosen++) {
        turns_open_scanning(256, false);
        sent = 0;
        /* Work for the first poll. */
        turns_feed_packets(TURNS_PACKETS - 1, TURNS_PACKETS - 1, 100);
        for (unsigned i = 0; i < 200; i++) {
            if (poll_with(packets_come_one_by_one) == TMINI_EVENT_SCAN) {
                expect_one_turn(tmini_scan(&turns.lidar));
            }
        }
        TEST_ASSERT_EQUAL_UINT(60, sent);
    }
}

/* ---- DMA overwrites an intact reply before it is copied ---- */

static bool has_come;

static void a_lap_comes(void)
{
    uint8_t lap[508];

    if (accesses == chosen) {
        memset(lap, 0x77, sizeof lap);
        turns_feed(lap, sizeof lap);
        has_come = true;
    }
}

static bool info_with_a_lap_at(unsigned access)
{
    static const encode_information_t information = {
        151, 1, 2, 1, {2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4}};
    uint8_t reply[ENCODE_REPLY_MAX];

    turns_open(512, true);
    (void)tmini_stop(&turns.lidar);
    (void)turns_poll();
    turns.now_ms += 100;
    (void)turns_poll();
    (void)tmini_request_info(&turns.lidar);
    turns_feed(reply, encode_information_reply(reply, &information));
    chosen = access;
    has_come = false;
    const tmini_event_t event = poll_with(a_lap_comes);

    if (event == TMINI_EVENT_INFO) {
        const tmini_info_t *const info = tmini_info(&turns.lidar);

        TEST_ASSERT_EQUAL_UINT8(151, info->model);
        TEST_ASSERT_EQUAL_UINT8_ARRAY(information.serial, info->serial, 16);
    } else {
        turns_feed(reply, encode_information_reply(reply, &information));
        TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_INFO), turns_poll());
    }
    return has_come;
}

/* The reply is taken if it comes again and is not overwritten. */
void test_a_reply_that_dma_overwrites_before_it_is_copied_is_no_answer(void)
{
    unsigned access = 1;

    while (info_with_a_lap_at(access)) {
        access++;
    }
    TEST_ASSERT_TRUE(access > 3);
}

/* ---- A poll's work is bounded by the bytes in the ring when it began ---- */

static uint32_t fed;

/* A producer that never pauses: false headers, each of which might be a packet of 80 samples. */
static void false_headers_come(void)
{
    static const uint8_t header[10] = {0xAA, 0x55, 0x00, 0x50, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00};

    if (fed < 1000000) {
        turns_feed(&header[fed % 10], 1);
        fed++;
    }
}

void test_a_producer_that_never_pauses_does_not_prolong_a_poll(void)
{
    tmini_counters_t counters;

    turns_open_scanning(4096, false);
    fed = 0;
    while (fed < 4096) {
        false_headers_come();
    }
    tmini_counters(&turns.lidar, &counters);
    const uint32_t before = counters.bytes_skipped;

    (void)poll_with(false_headers_come);
    tmini_counters(&turns.lidar, &counters);
    TEST_ASSERT_TRUE_MESSAGE(counters.bytes_skipped - before <= 4096,
                             "more was looked at than lay in the ring");
}
