/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The module tmini_line alone: numbers of bytes and milliseconds at their limits, and multiples of
 * 256 and 65536, which a too narrow type would store as 0. No byte is stored: only the ring's head
 * moves. test_pauses.c tests the effect on packets. */

#include "tmini_driver.h"

#include "unity.h"

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
static bool is_settled = true; /* All that came has been handled before each look. */

/* A lidar scans at this frequency; its line was examined just now. */
static void open_at(uint16_t frequency_chz)
{
    lidar = (tmini_t){0};
    is_scanning = true;
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
    timing = tmini_timing_default;
    open_at(1000);
}

void tearDown(void) {}

static bool look_after(uint32_t passed_ms, size_t count)
{
    now_ms += passed_ms;
    lidar.ring.head += count;
    if (is_settled) {
        tmini_line_settle(&lidar);
    }
    return tmini_line_look(&lidar, is_scanning);
}

/* Whether a single byte that comes after this silence is doubted. */
static bool is_doubted_after(uint32_t silent_ms)
{
    lidar.line.doubt = false;
    lidar.line.late_ms = 0;
    (void)look_after(silent_ms, 1);
    return lidar.line.doubt;
}

/* ---- Half a turn ---- */

void test_a_silence_of_half_a_turn_is_no_pause_and_a_millisecond_more_is_one(void)
{
    TEST_ASSERT_FALSE(is_doubted_after(50)); /* Half a turn at 10 Hz. */
    TEST_ASSERT_TRUE(is_doubted_after(51));
}

void test_below_5_7_hz_a_lidar_is_spinning_up_and_may_turn_at_12_hz(void)
{
    open_at(570);
    TEST_ASSERT_FALSE(is_doubted_after(87));
    TEST_ASSERT_TRUE(is_doubted_after(88));
    open_at(569);
    TEST_ASSERT_FALSE(is_doubted_after(41));
    TEST_ASSERT_TRUE(is_doubted_after(42));
}

void test_a_silence_of_any_length_is_doubted(void)
{
    TEST_ASSERT_TRUE(is_doubted_after(65536));
    TEST_ASSERT_TRUE(is_doubted_after(0x7FFFFFFF));
    TEST_ASSERT_TRUE(is_doubted_after(0x80000000));
}

/* ---- Time that bytes explain ---- */

/* 131 bytes take 9.979 ms, 132 take 10.055. */
void test_bytes_take_13_128_per_millisecond_rounded_down(void)
{
    static const struct {
        size_t count;
        uint16_t late_ms;
    } cases[] = {{13, 20}, {14, 19}, {105, 13}, {131, 11}, {132, 10}};

    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        open_at(1000);
        (void)look_after(20, cases[i].count);
        TEST_ASSERT_EQUAL_UINT16(cases[i].late_ms, lidar.line.late_ms);
    }
}

/* 860,374 bytes take 65,536 ms, which explains the whole time. */
void test_a_minute_of_bytes_explains_a_minute(void)
{
    (void)look_after(65537, 860374);
    TEST_ASSERT_FALSE(lidar.line.doubt);
}

/* The ring holds 65,536 bytes. With one more, it is unknown how many are missing. */
void test_more_bytes_than_the_ring_holds_are_doubted(void)
{
    lidar.ring.size = 65536;
    (void)look_after(5000, 65536);
    TEST_ASSERT_FALSE(lidar.line.doubt);
    (void)look_after(5000, 65537);
    TEST_ASSERT_TRUE(lidar.line.doubt);
}

void test_packets_among_doubtful_bytes_are_doubtful_beyond_65536_bytes_too(void)
{
    (void)look_after(5000, 65536);
    lidar.ring.tail = 65536;
    (void)look_after(60, 100);
    TEST_ASSERT_TRUE(tmini_line_is_doubtful(&lidar, now_ms));
    lidar.ring.tail += 50;
    TEST_ASSERT_TRUE(tmini_line_is_doubtful(&lidar, now_ms));
}

void test_65536_bytes_are_not_taken_for_none(void)
{
    TEST_ASSERT_TRUE(look_after(5000, 65536));
    TEST_ASSERT_FALSE(look_after(1, 0));
}

/* ---- Bytes that a port holds ---- */

void test_a_port_may_hold_65535_bytes(void)
{
    lidar.held_to = 13 + 65535;
    (void)look_after(1, 13);
    TEST_ASSERT_EQUAL_size_t(13 + 65535, lidar.line.arrived);
    open_at(1000);
    lidar.held_to = 13 + 65536;
    (void)look_after(1, 13);
    TEST_ASSERT_EQUAL_size_t(13, lidar.line.arrived);
}

/* An unset `held_to` (0) must not count as a place just ahead, when the index is about to wrap. */
void test_a_port_that_never_reports_what_it_holds_holds_nothing(void)
{
    lidar.line.received = lidar.ring.head = TMINI_RING_CLOSED - 100;
    (void)look_after(1, 13);
    TEST_ASSERT_EQUAL_size_t(TMINI_RING_CLOSED - 87, lidar.line.arrived);
}

void test_bytes_that_had_arrived_before_explain_nothing(void)
{
    lidar.line.arrived = 100; /* 100 bytes had arrived before, which the port no longer reports. */
    TEST_ASSERT_FALSE(is_doubted_after(50));
    lidar.line.arrived = lidar.line.received + 100;
    TEST_ASSERT_TRUE(is_doubted_after(51));
}

/* The silence may be between bytes that the port still holds. */
void test_a_doubt_reaches_to_the_last_byte_that_the_port_holds(void)
{
    lidar.held_to = 13 + 131;
    (void)look_after(60, 13);
    TEST_ASSERT_FALSE(lidar.line.doubt);
    lidar.held_to = 13 + 131 + 20;
    (void)look_after(52, 13);
    TEST_ASSERT_TRUE(lidar.line.doubt);
    TEST_ASSERT_EQUAL_size_t(13 + 131 + 20, lidar.line.doubtful_to);
}

/* 100 bytes arrive, then no more; the last 87 of them are fed later. */
void test_bytes_that_had_arrived_before_do_not_end_a_silence(void)
{
    lidar.held_to = 100;
    (void)look_after(8, 13);
    TEST_ASSERT_TRUE(look_after(30, 43));
    TEST_ASSERT_TRUE(look_after(20, 44));
    TEST_ASSERT_EQUAL_UINT32(5008, lidar.line.heard_ms);
    TEST_ASSERT_FALSE(lidar.line.doubt);
    (void)look_after(1, 1);
    TEST_ASSERT_EQUAL_UINT32(5059, lidar.line.heard_ms);
    TEST_ASSERT_TRUE(lidar.line.doubt);
}

/* ---- How late bytes may be ---- */

void test_bytes_are_late_by_a_second_at_most(void)
{
    timing.max_pause_ms = 0;
    (void)look_after(1000, 1);
    TEST_ASSERT_EQUAL_UINT16(1000, lidar.line.late_ms);
    (void)look_after(1001, 1);
    TEST_ASSERT_EQUAL_UINT16(0, lidar.line.late_ms);
}

void test_a_delay_is_kept_until_all_bytes_that_it_concerns_are_read(void)
{
    (void)look_after(20, 1);
    is_settled = false;
    (void)look_after(3, 1);
    TEST_ASSERT_EQUAL_UINT16(20, lidar.line.late_ms);
    is_settled = true;
    (void)look_after(3, 1);
    TEST_ASSERT_EQUAL_UINT16(3, lidar.line.late_ms);
}

void test_a_delay_ends_also_after_many_bytes(void)
{
    (void)look_after(6000, 70000);
    (void)look_after(20, 1);
    TEST_ASSERT_EQUAL_UINT16(20, lidar.line.late_ms);
    (void)look_after(3, 1);
    TEST_ASSERT_EQUAL_UINT16(3, lidar.line.late_ms);
}

void test_a_delay_is_kept_until_all_that_the_port_held_is_read(void)
{
    lidar.held_to = 100;
    (void)look_after(20 + 7, 1); /* 100 bytes explain 7 ms. */
    TEST_ASSERT_EQUAL_UINT16(20, lidar.line.late_ms);
    (void)look_after(3, 100);
    TEST_ASSERT_EQUAL_UINT16(20, lidar.line.late_ms);
    (void)look_after(3, 1);
    TEST_ASSERT_EQUAL_UINT16(3, lidar.line.late_ms);
}

/* At the first look 59 ms are unexplained; at the second 31, which is less than half a turn. If the
 * port held bytes at the first look, these may come only now: then 90 ms are unexplained. */
void test_what_seemed_to_be_missing_may_come_from_a_port_that_holds_bytes(void)
{
    for (unsigned held = 0; held <= 1; held++) {
        open_at(1000);
        lidar.held_to = held > 0 ? 13 : 0;
        (void)look_after(60, 13);
        TEST_ASSERT_TRUE(lidar.line.doubt);
        lidar.line.doubt = false;
        (void)look_after(40, 131);
        TEST_ASSERT_EQUAL(held > 0, lidar.line.doubt);
    }
}

/* ---- Before a lidar scans ---- */

/* Whether the first bytes are doubted, or only the bytes before them. */
static bool first_ones_are_doubted(uint32_t passed_ms, size_t count)
{
    open_at(0);
    is_scanning = false;
    now_ms += 1000000;
    (void)tmini_line_look(&lidar, is_scanning);
    (void)look_after(passed_ms, count);
    TEST_ASSERT_TRUE(lidar.line.doubt);
    TEST_ASSERT_TRUE(lidar.line.doubtful_to == count || lidar.line.doubtful_to == 0);
    return lidar.line.doubtful_to == count;
}

void test_first_bytes_in_a_fifo_come_straight_from_the_wire(void)
{
    TEST_ASSERT_FALSE(first_ones_are_doubted(1, 144)); /* They take 10 ms. */
    TEST_ASSERT_TRUE(first_ones_are_doubted(1, 145));
    TEST_ASSERT_TRUE(first_ones_are_doubted(1, 3361)); /* They take 256 ms. */
}

void test_first_bytes_that_were_not_watched_are_doubted(void)
{
    TEST_ASSERT_FALSE(first_ones_are_doubted(30, 13));
    TEST_ASSERT_TRUE(first_ones_are_doubted(31, 13));
    TEST_ASSERT_TRUE(first_ones_are_doubted(256, 13));
    TEST_ASSERT_TRUE(first_ones_are_doubted(65536, 13));
}

/* The port holds 100 bytes, which came before the silence. Only bytes after them are doubted. */
void test_a_silence_before_the_first_bytes_is_after_those_that_the_port_held(void)
{
    open_at(1000);
    is_scanning = false;
    lidar.held_to = 1 + 100;
    (void)look_after(5, 1);
    (void)look_after(83, 0);
    lidar.held_to = 0;
    (void)look_after(1, 110);
    TEST_ASSERT_TRUE(lidar.line.doubt);
    TEST_ASSERT_EQUAL_size_t(1 + 100, lidar.line.doubtful_to);
}

/* The port discarded the 100 bytes that it held, which closed the ring. Later 100 other bytes come,
 * which take 7 ms. */
void test_what_a_port_held_before_a_gap_explains_nothing_after_it(void)
{
    lidar.held_to = 1 + 100;
    (void)look_after(5, 1);
    lidar.ring.head += TMINI_RING_CLOSED;
    lidar.held_to = 0;
    (void)look_after(0, 0);
    (void)look_after(54, 100);
    TEST_ASSERT_EQUAL_UINT16(47, lidar.line.late_ms);
    TEST_ASSERT_EQUAL_UINT32(now_ms, lidar.line.heard_ms);
}

/* ---- Silence ---- */

void test_time_between_two_looks_is_50_ms_of_silence_at_most(void)
{
    static const uint32_t passed_ms[] = {50, 51, 256, 65536};

    for (unsigned i = 0; i < 4; i++) {
        open_at(1000);
        TEST_ASSERT_FALSE(look_after(passed_ms[i], 0));
        TEST_ASSERT_EQUAL_UINT16(50, lidar.line.silent_ms);
    }
}

void test_silence_counts_up_to_65535_ms(void)
{
    lidar.line.silent_ms = 65500;
    (void)look_after(50, 0);
    TEST_ASSERT_EQUAL_UINT16(65535, lidar.line.silent_ms);
}

void test_a_clock_may_step_back_by_a_second(void)
{
    (void)look_after((uint32_t)-1000, 0);
    TEST_ASSERT_EQUAL_UINT32(5000, lidar.line.now_ms);
    (void)look_after((uint32_t)-1, 0);
    TEST_ASSERT_EQUAL_UINT32(3999, lidar.line.now_ms);
}

void test_a_clock_that_steps_back_by_more_than_10_ms_may_hide_a_silence(void)
{
    (void)look_after((uint32_t)-10, 13);
    TEST_ASSERT_FALSE(lidar.line.doubt);
    (void)look_after((uint32_t)-1, 0);
    TEST_ASSERT_TRUE(lidar.line.doubt);
    TEST_ASSERT_EQUAL_size_t(13, lidar.line.doubtful_to);
    lidar.held_to = 13 + 20 + 44;
    (void)look_after(0, 20);
    TEST_ASSERT_EQUAL_size_t(13 + 20 + 44, lidar.line.doubtful_to);
    open_at(1000);
    (void)look_after((uint32_t)-1001, 0); /* More than a second does not count as a step back. */
    TEST_ASSERT_FALSE(lidar.line.doubt);
}

/* ---- A program that is behind ---- */

static bool is_behind_after(uint32_t passed_ms)
{
    (void)look_after(passed_ms, 13);
    return tmini_line_is_behind(&lidar);
}

void test_a_pause_between_polls_is_no_work(void)
{
    TEST_ASSERT_FALSE(is_behind_after(200));
    TEST_ASSERT_FALSE(is_behind_after(200));
}

void test_a_pause_counts_as_work_if_the_port_still_holds_bytes(void)
{
    tmini_feed_held(&lidar, 100);
    TEST_ASSERT_TRUE(is_behind_after(151));
    open_at(1000);
    tmini_feed_held(&lidar, 100);
    TEST_ASSERT_TRUE(is_behind_after(65536));
}

void test_a_program_is_behind_after_more_than_150_ms_of_work(void)
{
    (void)look_after(1000, 13);
    is_settled = false;
    TEST_ASSERT_FALSE(is_behind_after(149));
    TEST_ASSERT_TRUE(is_behind_after(1));
    TEST_ASSERT_TRUE(is_behind_after(65536));
    is_settled = true;
    TEST_ASSERT_FALSE(is_behind_after(1));
}

/* ---- When a packet came ---- */

/* The 70,000 bytes after it take 5332 ms. */
void test_a_packet_came_before_the_bytes_after_it(void)
{
    (void)look_after(9000, 70000);
    TEST_ASSERT_EQUAL_UINT32(14000 - 5332, tmini_line_arrival_ms(&lidar));
    lidar.ring.tail = 69900;
    TEST_ASSERT_EQUAL_UINT32(14000 - 7, tmini_line_arrival_ms(&lidar));
}

void test_a_packet_may_come_half_a_turn_after_the_one_before(void)
{
    lidar.decoder.builder.open = true;
    lidar.decoder.builder.scan.end_ms = 70000;
    TEST_ASSERT_FALSE(tmini_line_is_doubtful(&lidar, 70050));
    TEST_ASSERT_TRUE(tmini_line_is_doubtful(&lidar, 70051));
    lidar.decoder.builder.open = false;
    TEST_ASSERT_FALSE(tmini_line_is_doubtful(&lidar, 70051));
}
