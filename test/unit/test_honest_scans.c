/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Whatever happens to the line, the receiver or the program: no scan has points of two revolutions,
 * and no scan with missing points is called complete. The campaign (test/qa/campaign) does all this
 * at random. */

#include "rows.h"
#include "turns.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static uint8_t bytes[TURNS_PACKET_MAX + 1];

void setUp(void)
{
    turns_open_scanning(1024, false);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0, turns_scans.mixed, "scans of two revolutions");
}

/* Words of the rows. Turns are named by numbers, packets by their index in a turn, from 0 to 18.
 *
 *     open:4096       from the beginning, with a ring of this size; ct: with CT information
 *     clock:-50       the clock is set
 *     T:100           turn 100 comes; T:101:7-18: of turn 101 packets 7 to 18; T:102:0: the first
 *     busy:100 …      the same, while the program does not poll; poll; poll-scan: once
 *     lost:101:18     this packet is sent and lost
 *     half:100:7 rest:101:7   the first half of this packet comes, or the second
 *     cut:100         for a turn from packet 7 on, the first 9 bytes of each packet come
 *     silent:164      no bytes come for this time, and the program polls every millisecond
 *     scans:4 …       see tell_word(); of the last scan: count, gaps, whole */

static void be_silent(uint32_t ms)
{
    for (; ms > 0; ms--) {
        turns.now_ms++;
        (void)turns_poll();
    }
}

/* "T:101:7-18" */
static void tell_packets(const char *word, unsigned *first, unsigned *last)
{
    const char *const text = row_text(row_text(word));
    char *rest;
    *first = (unsigned)strtoul(text, &rest, 10);
    *last = rest[0] == '-'    ? (unsigned)strtoul(rest + 1, NULL, 10)
            : text[0] != '\0' ? *first
                              : TURNS_PACKETS - 1;
}

static void cut_turn(uint16_t turn)
{
    for (unsigned index = 7; index < TURNS_PACKETS + 7; index++) {
        (void)turns_packet(bytes, index % TURNS_PACKETS, turn);
        turns_feed(bytes, 9);
        be_silent(9);
    }
}

static void tell_word(char *word)
{
    tmini_counters_t counters;
    tmini_counters(&turns.lidar, &counters);
    const row_number_t numbers[] = {
        {"scans", turns_scans.count},         {"complete", turns_scans.complete},
        {"count", turns_scans.last.count},    {"gaps", turns_scans.last.gaps},
        {"whole", turns_scans.last.complete}, {"overruns", counters.bytes_overrun > 0},
        {"end-ms", turns_scans.last.end_ms},  {"age", tmini_scan_age_ms(&turns.lidar)},
    };
    const uint16_t turn = (uint16_t)row_number(word);
    unsigned first;
    unsigned last;
    tell_packets(word, &first, &last);
    if (row_is(word, "open")) {
        TEST_ASSERT_EQUAL_UINT(0, turns_scans.mixed);
        turns_open_scanning(row_number(word), false);
    } else if (row_is(word, "ct")) {
        turns.ct_information = true;
    } else if (row_is(word, "clock")) {
        turns.now_ms = row_number(word);
    } else if (row_is(word, "T")) {
        (void)turns_pass(first, last, turn);
    } else if (row_is(word, "busy")) {
        turns_feed_packets(first, last, turn);
    } else if (row_is(word, "poll")) {
        (void)turns_poll();
    } else if (row_is(word, "poll-scan")) {
        TEST_ASSERT_EQUAL_INT(TMINI_EVENT_SCAN, tmini_poll(&turns.lidar));
    } else if (row_is(word, "lost")) {
        (void)turns_packet(bytes, first, turn);
    } else if (row_is(word, "half")) {
        turns_feed(bytes, turns_packet(bytes, first, turn) / 2);
    } else if (row_is(word, "rest")) {
        const size_t size = turns_packet(bytes, first, turn);
        turns_feed(&bytes[size / 2], size - size / 2);
    } else if (row_is(word, "cut")) {
        cut_turn(turn);
    } else if (row_is(word, "silent")) {
        be_silent(row_number(word));
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

#define BEGINS "open:1024 T:100:0-6 " /* The first seven packets of turn 100. */
/* Three partial scans and a whole one. */
#define LATER(turn, ms) BEGINS "silent:" ms " T:" turn ":7-18 T:200 T:300:0 scans:4 complete:1 "
/* Three turns come without a poll; then the stream continues without a jump of the angle. */
#define BUSY(size)                                                                                \
    "open:" size " T:100:0-6 busy:100:7-18 busy:101 busy:102 busy:103:0-8 poll T:103:9-18 T:104 " \
    "T:105:0 overruns:1 whole:1 "

static const row_t rows[] IN_FLASH = {
    ROW(on_a_healthy_line_every_turn_is_a_complete_scan, "T:1 T:2 T:3 T:4 complete:3 count:658"),
    ROW(a_scan_that_ends_when_the_clock_wraps_around_has_an_age, /* A later packet took 9 ms. */
        "clock:-334 T:1 T:2 busy:3:0-1 poll poll whole:1 end-ms:0 age:8"),
    /* ---- The line is silent in mid-scan, then goes on at the right angle of another turn ---- */
    ROW(a_silence_of_whole_turns_ends_the_scan, /* A turn takes 164 ms. */
        LATER("101", "164") LATER("102", "328") LATER("103", "492") LATER("105", "820")),
    ROW(a_scan_that_a_silence_has_ended_is_not_complete_and_has_a_gap,
        BEGINS "silent:164 T:101:7 scans:1 whole:0 gaps:1 count:241"),
    ROW(a_silence_of_nearly_a_whole_turn_ends_the_scan, /* The angles do not jump. */
        BEGINS "silent:162 T:101:7-18 T:102:0 scans:3 complete:0"),
    ROW(a_silence_of_one_turn_and_a_half_ends_the_scan, /* The angles differ by half a turn. */
        "T:100:0-3 silent:246 T:101:12-18 T:102:0 complete:0"),
    ROW(a_silence_within_a_packet_ends_the_scan, /* Its two halves are of different turns. */
        BEGINS "half:100:7 silent:164 rest:101:7 T:101:8-18 T:102:0 complete:0"),
    ROW(packets_cut_to_a_few_bytes_for_a_turn_end_the_scan, /* No silence; few bytes are skipped. */
        BEGINS "cut:100 T:101:7-18 T:102:0 complete:0"),
    ROW(a_silence_between_two_turns_costs_only_their_two_scans,
        "T:100 silent:492 T:101 T:102 T:103:0 complete:1 whole:1"),
    /* ---- The ring overflows while the program is busy ---- */
    ROW(an_overflow_of_any_ring_mixes_no_turns,
        BUSY("256") BUSY("512") BUSY("1024") BUSY("2048") BUSY("4096")),
    /* The second overflow must not hide the first, after turn 101's second packet: the angles of
     * turn 102 continue those of the two packets of turn 101 before it. */
    ROW(two_overflows_less_than_a_ring_apart_are_both_remembered,
        "open:512 T:100:0-14 busy:100:15-18 busy:101:0-7 poll-scan busy:102:2-8 poll "
        "T:102:9-18 T:103 T:104:0 whole:1"),
    /* ---- LastCRC guards a turn ---- */
    ROW(a_guarded_turn_is_complete, "ct T:100 T:101 T:102:0 complete:2"),
    ROW(a_small_packet_whose_loss_the_guard_proves_is_missing, /* 3.3 degrees might be jitter. */
        "ct T:100 T:101:0-17 lost:101:18 T:102:0 scans:2 count:652 whole:0 gaps:1"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* ---- A pause between polls costs nothing ---- */

/* A layer below holds the second half of a packet while the program is busy for this time. The
 * program then polls before that layer has passed on the bytes. */
static void pause_within_a_packet(uint32_t pause_ms)
{
    tmini_counters_t counters;
    row_tell("open:4096 T:100:0-6", tell_word);
    const size_t size = turns_packet(bytes, 7, 100);
    turns_feed(bytes, 60);
    (void)turns_poll();
    turns.now_ms += pause_ms;
    (void)turns_poll();
    turns_feed(&bytes[60], size - 60);
    row_tell("busy:100:8-18 busy:101:0", tell_word);
    turns.now_ms -= 94; /* The bytes came during the pause. */
    (void)turns_poll();
    tmini_counters(&turns.lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_skipped);
}

void test_a_pause_between_polls_costs_no_packet_and_no_scan(void)
{
    for (uint32_t pause_ms = 100; pause_ms <= 250; pause_ms += 25) {
        pause_within_a_packet(pause_ms);
    }
    pause_within_a_packet(115); /* As long as the rest of the turn takes. */
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.complete);
}
