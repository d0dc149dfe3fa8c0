/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The work of one call of the parser or the driver is bounded, whatever has arrived. The rings here
 * are large and full of the bytes that cost most. */

#include "tale.h"
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

void setUp(void) {}

void tearDown(void)
{
    tale_end();
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

/* ---- The driver's polls ---- */

/* "large": the receive buffer has 8192 bytes; "forget-info": nothing is to be told of information
 * any more. */
static bool tell(char *word)
{
    if (row_is(word, "large")) {
        rig.config.rx_buffer = memory;
        rig.config.rx_size = sizeof memory;
    } else if (row_is(word, "forget-info")) {
        tmini_withdraw(&rig.lidar, TMINI_EVENT_INFO);
    } else {
        return false;
    }
    return true;
}

static const row_t tales[] IN_FLASH = {
    /* A packet of one sample costs 44 and twice its 13 bytes: 1536 / 70, rounded up. */
    ROW(packets_that_were_not_asked_for_are_bounded,
        "large 200( <P:1 ) !MORE packets:22 drain packets:200"),
    ROW(packets_of_a_scan_are_bounded,
        "large scans <S drain packets:2 200( <P:1 ) !MORE packets:24 drain packets:202"),
    /* A packet of 32 samples costs 44 and twice its 106 bytes: six of them cost 1536. */
    ROW(a_poll_ends_when_its_effort_is_exactly_used_up,
        "large 7( <P:32 ) !MORE packets:6 !NONE packets:7"),
    /* A packet of 7 samples costs 106, and that of 13 bytes which ended the scan 57: 1541. */
    ROW(the_packet_that_ended_a_scan_counts_when_it_is_decoded_again,
        "large scans <P <S 30( <P:7 ) !SCAN !MORE packets:17 drain"),
    /* Ten packets of 4 samples cost 88 each, which leaves 656 for the garbage after them. */
    ROW(packets_and_the_garbage_after_them_share_a_polls_effort,
        "large 10( <P ) 16( <zeros:256 ) !MORE packets:10 skipped:656 drain"),
    ROW(a_poll_that_has_more_to_do_says_so_and_goes_on_with_the_next, /* 376 are complete. */
        "large 400( <x:AA550050010001000000 ) 20( !MORE ) drain errors:376 ~100 drain"),
    ROW(a_question_withdrawn_does_not_end_what_a_poll_has_left_over,
        "large 60( <P:1 ) !MORE forget-info drain packets:60"),
};

void test_tales(void)
{
    tale_words = tell;
    run_rows(tales, tale_tell_row);
}
