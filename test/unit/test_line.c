/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The module tmini_line alone: numbers of bytes and milliseconds at their limits, and multiples of
 * 256 and 65536, which a too narrow type would store as 0. No byte is stored: only the ring's head
 * moves. test_pauses.c tests the effect on packets. */

#include "rows.h"
#include "tmini_driver.h"

#include "unity.h"

#include <stdlib.h>

static tmini_t lidar;
static tmini_timing_t timing;
static uint32_t now_ms;

static uint32_t read_clock(void *context)
{
    (void)context;
    return now_ms;
}

static const tmini_port_t port = {.now_ms = read_clock};

static bool is_scanning;
static bool is_settled; /* All that came has been handled before each look. */
static bool is_heard;   /* By the last look. */

/* A lidar scans at this frequency; its line was examined just now. */
static void open_at(uint16_t frequency_chz)
{
    lidar = (tmini_t){0};
    is_scanning = true;
    is_settled = true;
    timing = tmini_timing_default;
    lidar.link.port = &port;
    lidar.link.timing = &timing;
    lidar.ring.size = (size_t)1 << 24;
    lidar.decoder.parser.frame.ring = &lidar.ring;
    lidar.decoder.builder.scan.frequency_chz = frequency_chz;
    now_ms = 5000;
    lidar.line = (tmini_line_t){.now_ms = now_ms, .heard_ms = now_ms};
}

void setUp(void)
{
    open_at(1000);
}

static void look_after(uint32_t passed_ms, size_t count)
{
    now_ms += passed_ms;
    lidar.ring.head += count;
    if (is_settled) {
        tmini_line_settle(&lidar);
    }
    is_heard = tmini_line_look(&lidar, is_scanning);
}

/* Words of the rows, the first of which begin again:
 *
 *     chz:570 10-hz   a lidar scans at this frequency, at 10 Hz; first: after a long silence, one
 *                     that does not scan
 *     idle            it does not scan
 *     look:20:13      a look 20 ms later, when 13 more bytes have come; heard:1: it heard some
 *     after:51        the same with a single byte, of which earlier ones are forgotten
 *     no-doubt        earlier doubts are forgotten
 *     unsettled settled       whether all that came is handled before each look
 *     ring:65536 limit:0      the ring's size; max_pause_ms
 *     held-to:100 held:100    the port holds bytes up to this place; this many
 *     arrive:100      100 bytes beyond those fed have arrived before
 *     read:100        bytes up to this place have been read
 *     gap             closes the ring
 *     silence:65500   has been counted
 *     open:70000 close        a scan is open, whose last packet came then; no scan is
 *     packet:70050:0  a packet that came then is not doubtful; packet:70051:1: it is
 *     doubt:1 late:20 …       see tell_word() */

static void tell_word(char *word)
{
    const char *const text = row_text(word);
    const uint32_t number = (uint32_t)strtoul(text, NULL, 0);
    const row_number_t numbers[] = {
        {"heard", is_heard},
        {"doubt", lidar.line.doubtful_to != 0},
        {"doubtful-to", lidar.line.doubtful_to % TMINI_RING_CLOSED},
        {"late", lidar.line.late_ms},
        {"arrived", lidar.line.received + lidar.line.held},
        {"heard-ms", lidar.line.heard_ms},
        {"now-ms", lidar.line.now_ms},
        {"silent", lidar.line.silent_ms},
        {"behind", tmini_line_is_behind(&lidar)},
        {"arrival", tmini_line_arrival_ms(&lidar)},
    };
    if (row_is(word, "chz")) {
        open_at((uint16_t)number);
    } else if (row_is(word, "10-hz")) {
        open_at(1000);
    } else if (row_is(word, "first")) {
        open_at(0);
        is_scanning = false;
        look_after(1000000, 0);
    } else if (row_is(word, "idle")) {
        is_scanning = false;
    } else if (row_is(word, "look")) {
        look_after(number, row_number(text));
    } else if (row_is(word, "after")) {
        lidar.line.doubtful_to = 0;
        lidar.line.late_ms = 0;
        look_after(number, 1);
    } else if (row_is(word, "no-doubt")) {
        lidar.line.doubtful_to = 0;
    } else if (row_is(word, "unsettled") || row_is(word, "settled")) {
        is_settled = word[0] == 's';
    } else if (row_is(word, "ring")) {
        lidar.ring.size = number;
    } else if (row_is(word, "limit")) {
        timing.max_pause_ms = (uint16_t)number;
    } else if (row_is(word, "held-to")) {
        lidar.held_to = number;
    } else if (row_is(word, "held")) {
        tmini_feed_held(&lidar, number);
    } else if (row_is(word, "arrive")) {
        lidar.line.held = (uint16_t)number;
    } else if (row_is(word, "read")) {
        lidar.ring.tail = number;
    } else if (row_is(word, "gap")) {
        lidar.ring.head += TMINI_RING_CLOSED;
    } else if (row_is(word, "silence")) {
        lidar.line.silent_ms = (uint16_t)number;
    } else if (row_is(word, "open") || row_is(word, "close")) {
        lidar.decoder.builder.open = word[0] == 'o';
        lidar.decoder.builder.scan.end_ms = number;
    } else if (row_is(word, "packet")) {
        TEST_ASSERT_EQUAL_MESSAGE(row_number(text), tmini_line_is_doubtful(&lidar, number), word);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

static const row_t rows[] IN_FLASH = {
    /* ---- Half a turn ---- */
    ROW(a_silence_of_half_a_turn_is_no_pause_and_a_millisecond_more_is_one,
        "after:50 doubt:0 after:51 doubt:1"),
    ROW(below_5_7_hz_a_lidar_is_spinning_up_and_may_turn_at_12_hz,
        "chz:570 after:87 doubt:0 after:88 doubt:1 chz:569 after:41 doubt:0 after:42 doubt:1"),
    ROW(a_silence_of_any_length_is_doubted,
        "after:65536 doubt:1 after:0x7FFFFFFF doubt:1 after:0x80000000 doubt:1"),
    /* ---- Time that bytes explain ---- */
    ROW(bytes_take_13_128_per_millisecond_rounded_down, /* 131 take 9.979 ms, 132 take 10.055. */
        "look:20:13 late:20 10-hz look:20:14 late:19 10-hz look:20:105 late:13 10-hz look:20:131 "
        "late:11 10-hz look:20:132 late:10"),
    ROW(a_minute_of_bytes_explains_a_minute, "look:65537:860374 doubt:0"), /* 65,536 ms. */
    ROW(more_bytes_than_the_ring_holds_are_doubted, /* It is unknown how many are missing. */
        "ring:65536 look:5000:65536 doubt:0 look:5000:65537 doubt:1"),
    ROW(packets_among_doubtful_bytes_are_doubtful_beyond_65536_bytes_too,
        "look:5000:65536 read:65536 look:60:100 packet:10060:1 read:65586 packet:10060:1"),
    ROW(more_than_65535_bytes_are_not_taken_for_none, "look:5000:65536 heard:1 look:1:0 heard:0"),
    /* ---- Bytes that a port holds ---- */
    ROW(a_port_may_hold_65535_bytes,
        "held-to:65548 look:1:13 arrived:65548 10-hz held-to:65549 look:1:13 arrived:13"),
    ROW(bytes_that_had_arrived_before_explain_nothing,
        "arrive:100 after:50 doubt:0 arrive:100 after:51 doubt:1"),
    /* 100 had arrived before, and 180 have now: 80 new ones take 6 ms. */
    ROW(of_the_bytes_fed_and_held_only_those_that_are_new_explain_time,
        "arrive:100 held-to:180 look:20:130 late:14"),
    ROW(what_a_port_holds_explains_time_once_it_feeds, /* 100 bytes explain 7 of 80 ms. */
        "held-to:100 look:40:0 look:40:100 doubt:1"),
    ROW(a_doubt_reaches_to_the_last_byte_that_the_port_holds, /* The silence may be before it. */
        "held-to:144 look:60:13 doubt:0 held-to:164 look:52:13 doubt:1 doubtful-to:164"),
    ROW(bytes_that_had_arrived_before_do_not_end_a_silence, /* 100 arrive; 87 are fed later. */
        "held-to:100 look:8:13 look:30:43 heard:1 look:20:44 heard:1 heard-ms:5008 doubt:0 "
        "look:1:1 heard-ms:5059 doubt:1"),
    /* ---- How late bytes may be ---- */
    ROW(bytes_are_late_by_a_second_at_most, "limit:0 look:1000:1 late:1000 look:1001:1 late:0"),
    ROW(a_delay_is_kept_until_all_bytes_that_it_concerns_are_read,
        "look:20:1 unsettled look:3:1 late:20 settled look:3:1 late:3"),
    ROW(a_delay_ends_also_after_many_bytes, "look:6000:70000 look:20:1 late:20 look:3:1 late:3"),
    ROW(a_delay_is_kept_until_all_that_the_port_held_is_read, /* 100 bytes explain 7 ms. */
        "held-to:100 look:27:1 late:20 look:3:100 late:20 look:3:1 late:3"),
    /* At first 59 ms are unexplained; later 31, which is less than half a turn. If the port held
     * bytes at the first look, these may come only now: then 90 ms are unexplained. */
    ROW(what_seemed_to_be_missing_may_come_from_a_port_that_holds_bytes,
        "look:60:13 doubt:1 no-doubt look:40:131 doubt:0 10-hz held-to:13 look:60:13 doubt:1 "
        "no-doubt look:40:131 doubt:1"),
    /* ---- Before a lidar scans: all bytes are doubted, or only those before them ---- */
    ROW(first_bytes_in_a_fifo_come_straight_from_the_wire, /* They take 10 ms; the last 256. */
        "first look:1:144 doubt:1 doubtful-to:0 first look:1:145 doubt:1 doubtful-to:145 first "
        "look:1:3361 doubt:1 doubtful-to:3361"),
    ROW(first_bytes_that_were_not_watched_are_doubted,
        "first look:30:13 doubt:1 doubtful-to:0 first look:31:13 doubt:1 doubtful-to:13 first "
        "look:256:13 doubtful-to:13 first look:65536:13 doubtful-to:13"),
    ROW(a_silence_before_the_first_bytes_is_after_those_that_the_port_held,
        "idle held-to:101 look:5:1 look:83:0 held-to:0 look:1:110 doubt:1 doubtful-to:101"),
    /* The port discarded 100 bytes, which closed the ring. 100 other bytes take 7 ms. */
    ROW(what_a_port_held_before_a_gap_explains_nothing_after_it,
        "held-to:101 look:5:1 gap held-to:0 look:0:0 look:54:100 late:47 heard-ms:5059"),
    /* ---- Silence ---- */
    ROW(time_between_two_looks_is_50_ms_of_silence_at_most,
        "look:50:0 heard:0 silent:50 10-hz look:51:0 silent:50 10-hz look:256:0 silent:50 10-hz "
        "look:65536:0 heard:0 silent:50"),
    ROW(silence_counts_up_to_65535_ms, "silence:65500 look:50:0 silent:65535"),
    ROW(a_clock_that_wraps_to_0_goes_on, "look:4294962295:0 look:1:0 now-ms:1 look:-8:0 now-ms:1"),
    ROW(a_clock_may_step_back_by_a_second, "look:-1000:0 now-ms:5000 look:-1:0 now-ms:3999"),
    /* More than a second does not count as a step back. */
    ROW(a_clock_that_steps_back_by_more_than_10_ms_may_hide_a_silence,
        "look:-10:13 doubt:0 look:-1:0 doubt:1 doubtful-to:13 held-to:77 look:0:20 doubtful-to:77 "
        "10-hz look:-1001:0 doubt:0 10-hz look:5332:70000 doubt:0 look:-11:13 doubtful-to:70013"),
    /* ---- A program that is behind ---- */
    ROW(a_pause_between_polls_is_no_work, "2( look:200:13 behind:0 )"),
    ROW(a_pause_counts_as_work_if_the_port_still_holds_bytes,
        "held:14 look:151:13 behind:1 10-hz held:100 look:65536:13 behind:1"),
    ROW(a_program_is_behind_after_more_than_150_ms_of_work,
        "look:1000:13 unsettled look:149:13 behind:0 look:1:13 behind:1 look:65536:13 behind:1 "
        "settled look:1:13 behind:0"),
    /* ---- When a packet came ---- */
    ROW(a_packet_came_before_the_bytes_after_it, /* 70,000 bytes take 5332 ms, 100 take 7. */
        "look:9000:70000 arrival:8668 read:69900 arrival:13993"),
    ROW(a_packet_came_before_the_bytes_that_the_port_holds, /* 132 bytes take 10 ms. */
        "held-to:145 look:20:13 read:13 arrival:5010"),
    ROW(a_packet_may_come_half_a_turn_after_the_one_before,
        "open:70000 packet:70050:0 packet:70051:1 close packet:70051:0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* An unset `held_to` (0) must not count as a place just ahead, when the index is about to wrap. */
void test_a_port_that_never_reports_what_it_holds_holds_nothing(void)
{
    lidar.line.received = lidar.ring.head = TMINI_RING_CLOSED - 100;
    look_after(1, 13);
    TEST_ASSERT_EQUAL_UINT16(0, lidar.line.held);
}
