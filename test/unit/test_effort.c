/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The work of one call of the parser or the driver is bounded, whatever has arrived. The rings here
 * are large and full of the bytes that cost most. */

#include "rig.h"
#include "tmini_driver.h"

#include "tmini/parts/tmini_parser.h"
#include "unity.h"

/* The header of a packet of 80 samples, 250 bytes. Repeated, it makes candidates that are complete
 * and plausible, but wrong: the parser examines 250 bytes to skip ten. */
static const uint8_t header[10] = {0xAA, 0x55, 0x00, 80, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00};
#define HEADERS 400u
#define CANDIDATES 376u /* (400 * 10 - 250) / 10 + 1 of them are complete. */

static uint8_t memory[8192];
static tmini_ring_t ring;
static tmini_parser_t parser;

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    rig_verify();
}

static void open_parser(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, sizeof memory, false));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_parser_init(&parser, &ring, 0));
}

static tmini_parser_counters_t parser_counters(void)
{
    tmini_parser_counters_t counters;
    tmini_parser_counters(&parser, &counters);
    return counters;
}

/* One call examines 1536 bytes and at most one packet more. Of the candidate that exceeds the
 * limit, it skips only the first byte. */
void test_a_call_looks_at_no_more_bytes_than_it_may(void)
{
    open_parser();
    for (unsigned i = 0; i < HEADERS; i++) {
        (void)tmini_ring_write(&ring, header, sizeof header);
    }
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_MORE, tmini_parser_next(&parser));
    const uint32_t errors = parser_counters().checksum_errors;
    TEST_ASSERT_TRUE(errors >= 5 && errors <= 6);
    TEST_ASSERT_EQUAL_UINT32(10 * errors - 9, parser_counters().bytes_skipped);
    unsigned calls = 1;
    while (tmini_parser_next(&parser) == TMINI_FRAME_MORE) {
        calls++;
    }
    TEST_ASSERT_TRUE(calls > 40);
    TEST_ASSERT_EQUAL_UINT32(CANDIDATES, parser_counters().checksum_errors);
}

void test_garbage_without_a_candidate_is_passed_in_bounded_steps_too(void)
{
    open_parser();
    for (size_t i = 0; i < sizeof memory; i++) {
        tmini_ring_put(&ring, 0);
    }
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_MORE, tmini_parser_next(&parser));
    TEST_ASSERT_EQUAL_UINT32(1536, parser_counters().bytes_skipped);
    while (tmini_parser_next(&parser) == TMINI_FRAME_MORE) {
    }
    TEST_ASSERT_EQUAL_UINT32(8192, parser_counters().bytes_skipped);
}

/* Each candidate costs 14 and two skipped bytes: 1536 / 16. */
void test_candidates_without_a_packet_are_bounded_too(void)
{
    open_parser();
    for (size_t i = 0; i < sizeof memory; i++) {
        tmini_ring_put(&ring, (i & 1u) == 0 ? 0xAA : 0x55); /* LSN would be 85. */
    }
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_MORE, tmini_parser_next(&parser));
    TEST_ASSERT_EQUAL_UINT32(2 * 96, parser_counters().bytes_skipped);
    while (tmini_parser_next(&parser) == TMINI_FRAME_MORE) {
    }
    TEST_ASSERT_TRUE(parser_counters().bytes_skipped >= sizeof memory - 10);
    TEST_ASSERT_EQUAL_UINT32(0, parser_counters().checksum_errors);
}

/* 99 candidates cost 14 and one skipped byte each. For the last one and the garbage after it, 51 of
 * 1536 are left. */
void test_garbage_after_candidates_is_bounded_with_them(void)
{
    open_parser();
    for (size_t i = 0; i < sizeof memory; i++) {
        tmini_ring_put(&ring, i < 100 ? 0xAA : 0);
    }
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_MORE, tmini_parser_next(&parser));
    TEST_ASSERT_EQUAL_UINT32(99 + 51, parser_counters().bytes_skipped);
}

void test_a_call_is_bounded_by_what_others_have_left(void)
{
    open_parser();
    for (size_t i = 0; i < sizeof memory; i++) {
        tmini_ring_put(&ring, 0);
    }
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_MORE, tmini_parser_next_after(&parser, 1488));
    TEST_ASSERT_EQUAL_UINT32(48, parser_counters().bytes_skipped);
}

static tmini_counters_t poll_counters(void)
{
    tmini_counters_t counters;
    tmini_counters(&rig.lidar, &counters);
    return counters;
}

static void open_driver(void)
{
    rig.config.rx_buffer = memory;
    rig.config.rx_size = sizeof memory;
    rig_init();
}

/* A packet of one sample costs 44 and twice its 13 bytes: 1536 / 70, rounded up. */
static void check_that_short_packets_are_bounded(void)
{
    const uint32_t before = poll_counters().packets;
    for (unsigned i = 0; i < 200; i++) {
        rig_feed_packet(0, 1, 1000);
    }
    polls_to(TMINI_EVENT_MORE);
    TEST_ASSERT_EQUAL_UINT32(22, poll_counters().packets - before);
    while (tmini_poll(&rig.lidar) == TMINI_EVENT_MORE) {
    }
    TEST_ASSERT_EQUAL_UINT32(200, poll_counters().packets - before);
}

void test_packets_that_were_not_asked_for_are_bounded(void)
{
    open_driver();
    check_that_short_packets_are_bounded();
}

void test_packets_of_a_scan_are_bounded(void)
{
    open_driver();
    rig_go_scanning();
    rig_feed_start_packet(1000);
    TEST_ASSERT_EQUAL_UINT(0, rig_drain());
    check_that_short_packets_are_bounded();
}

/* A packet of 32 samples costs 44 and twice its 106 bytes: six of them cost 1536. */
void test_a_poll_ends_when_its_effort_is_exactly_used_up(void)
{
    open_driver();
    for (unsigned i = 0; i < 7; i++) {
        rig_feed_packet(0, 32, 1000);
    }
    polls_to(TMINI_EVENT_MORE);
    TEST_ASSERT_EQUAL_UINT32(6, poll_counters().packets);
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT32(7, poll_counters().packets);
}

/* Ten packets of 4 samples cost 88 each, which leaves 656 for the garbage after them. */
void test_packets_and_the_garbage_after_them_share_a_polls_effort(void)
{
    open_driver();
    for (unsigned i = 0; i < 10; i++) {
        rig_feed_point_packet(1000);
    }
    for (unsigned i = 0; i < 4096; i++) {
        rig_feed_byte(0);
    }
    polls_to(TMINI_EVENT_MORE);
    TEST_ASSERT_EQUAL_UINT32(10, poll_counters().packets);
    TEST_ASSERT_EQUAL_UINT32(656, poll_counters().bytes_skipped);
}

static uint32_t checksum_errors(void)
{
    return poll_counters().checksum_errors;
}

void test_a_poll_that_has_more_to_do_says_so_and_goes_on_with_the_next(void)
{
    open_driver();
    for (unsigned i = 0; i < HEADERS; i++) {
        rig_feed(header, sizeof header);
    }
    polls_to(TMINI_EVENT_MORE);
    TEST_ASSERT_TRUE(checksum_errors() > 0 && checksum_errors() < 20);
    unsigned polls = 1;
    while (tmini_poll(&rig.lidar) == TMINI_EVENT_MORE) {
        polls++;
    }
    TEST_ASSERT_TRUE(polls > 20);
    TEST_ASSERT_EQUAL_UINT32(CANDIDATES, checksum_errors());
}

void test_a_question_withdrawn_does_not_end_what_a_poll_has_left_over(void)
{
    open_driver();
    for (unsigned i = 0; i < 60; i++) {
        rig_feed_packet(0, 1, 1000);
    }
    polls_to(TMINI_EVENT_MORE);
    tmini_withdraw(&rig.lidar, TMINI_EVENT_INFO);
    (void)rig_drain();
    TEST_ASSERT_EQUAL_UINT32(60, poll_counters().packets);
}
