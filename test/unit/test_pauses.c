/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Pauses of the line while the lidar scans, and the packets that become doubtful by them: those
 * before which others may be missing. A pause is too long by more than max_pause_ms, 30, if it is
 * longer than the bytes that end it explain, 12.5 a millisecond. */

#include "invariants.h"
#include "rig.h"

#include "unity.h"

#include <string.h>

static uint8_t memory[2048];

#define RING_SIZE 1024u

/* Streaming, and the pauses before that are forgotten. */
static void open_with(uint16_t max_pause_ms, bool dma)
{
    rig_open();
    rig.timing.max_pause_ms = max_pause_ms;
    rig.config.rx_buffer = memory;
    rig.config.rx_size = RING_SIZE;
    rig.config.rx_dma = dma;
    rig.config.points = NULL;
    rig.config.max_points = 0;
    rig_init();
}

static void go_streaming(void)
{
    rig_go_starting();
    for (unsigned i = 0; i < 3; i++) {
        rig.now_ms += 1;
        rig_feed_packet(0, 4, 700);
        polls_to(i == 0 ? TMINI_EVENT_STARTED : TMINI_EVENT_PACKET);
        if (i == 0) {
            polls_to(TMINI_EVENT_PACKET);
        }
        polls_to(TMINI_EVENT_NONE);
    }
}

void setUp(void)
{
    TEST_ASSERT_EQUAL_UINT16(30, tmini_timing_default.max_pause_ms);
    open_with(30, false);
    go_streaming();
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

/* Nothing comes, and someone looks each 30 ms, as rarely as will do; at last 1 ms before the end.
 * The next poll is at the end. */
static void nothing_comes_for(uint32_t ms)
{
    for (ms--; ms > 0; ms -= ms < 30 ? ms : 30) {
        rig.now_ms += ms < 30 ? ms : 30;
        polls_to(TMINI_EVENT_NONE);
    }
    rig.now_ms += 1;
}

static void feed_packets(unsigned count, uint8_t samples)
{
    for (unsigned i = 0; i < count; i++) {
        rig_feed_packet(0, samples, 1000);
    }
}

static void doubtful_are_the_first(unsigned doubtful, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        polls_to(TMINI_EVENT_PACKET);
        TEST_ASSERT_EQUAL_UINT16(i < doubtful ? TMINI_GAP_UNKNOWN : 0,
                                 tmini_packet(&rig.lidar)->gap);
    }
    polls_to(TMINI_EVENT_NONE);
}

static void two_packets_come_of_which_doubtful_are(unsigned doubtful)
{
    rig.now_ms += 2;
    feed_packets(2, 4);
    doubtful_are_the_first(doubtful, 2);
}

/* ---- How long a pause may be ---- */

/* 44 bytes explain 3 ms. */
void test_a_pause_of_30_ms_and_what_the_bytes_explain_is_none(void)
{
    for (unsigned i = 0; i < 3; i++) {
        nothing_comes_for(33);
        feed_packets(2, 4);
        doubtful_are_the_first(0, 2);
    }
}

void test_a_longer_one_makes_the_packets_around_it_doubtful_and_no_others(void)
{
    nothing_comes_for(34);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
    two_packets_come_of_which_doubtful_are(1); /* The pause may have been after those. */
    two_packets_come_of_which_doubtful_are(0);
}

/* Until it has caught up, and up to a second. */
void test_a_clock_that_steps_back_shows_no_time(void)
{
    for (unsigned i = 0; i < 3; i++) {
        rig.now_ms -= 10;
        polls_to(TMINI_EVENT_NONE);
        feed_packets(2, 4);
        doubtful_are_the_first(0, 2);
        rig.now_ms += 12;
        polls_to(TMINI_EVENT_NONE);
    }
}

/* 410 bytes explain 32 ms: 410 / 12.5. */
void test_many_bytes_explain_a_long_pause(void)
{
    nothing_comes_for(62);
    feed_packets(5, 24);
    doubtful_are_the_first(0, 5);
}

/* 487 bytes, in one packet of 38 samples and three of 37, are 38.96 ms; whole ones count. */
void test_what_bytes_explain_is_rounded_down(void)
{
    nothing_comes_for(69);
    feed_packets(1, 38);
    feed_packets(3, 37);
    doubtful_are_the_first(4, 4);
}

void test_many_bytes_do_not_explain_every_pause(void)
{
    nothing_comes_for(63);
    feed_packets(5, 24);
    doubtful_are_the_first(5, 5);
}

void test_a_limit_of_1_ms_is_one(void)
{
    open_with(1, false);
    go_streaming();
    for (unsigned i = 0; i < 5; i++) {
        polls_to(TMINI_EVENT_NONE);
        rig.now_ms += 1;
    }
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
}

/* Of the second one only the first byte, but that is enough. */
void test_a_packet_is_doubtful_if_it_begins_among_the_bytes_behind_a_pause(void)
{
    static const encode_sample_t samples[4] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 4, 640, 736, samples};
    uint8_t bytes[22];

    TEST_ASSERT_EQUAL_UINT(22, encode_packet(bytes, &packet));
    nothing_comes_for(34);
    feed_packets(1, 4);
    rig_feed(bytes, 1);
    doubtful_are_the_first(1, 1);
    rig.now_ms += 2;
    rig_feed(&bytes[1], 21);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 3);
}

/* 65,546 ms: 10 in 16 bits. */
void test_a_pause_of_more_than_a_minute_is_one(void)
{
    open_with(30, false);
    rig_go_idle();
    rig.now_ms = 65546;
    sends(START);
    begins(tmini_start(&rig.lidar));
    rig_feed_scan_reply();
    feed_packets(2, 4);
    polls_to(TMINI_EVENT_STARTED);
    doubtful_are_the_first(2, 2);
}

/* ---- Bytes that a layer below has held back ---- */

void test_after_a_pause_between_polls_the_first_packet_behind_is_doubtful_too(void)
{
    rig.now_ms += 50;
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
    two_packets_come_of_which_doubtful_are(1);
    two_packets_come_of_which_doubtful_are(0);
}

/* The wire brings 22.8 bytes a millisecond, and a UART's FIFO may hold those of 16 ms: within 17 ms
 * come 409 bytes at most, and these are 410. */
void test_more_bytes_than_the_wire_can_have_brought_were_held(void)
{
    nothing_comes_for(63);
    feed_packets(5, 24);
    doubtful_are_the_first(5, 5);
    two_packets_come_of_which_doubtful_are(1);
    two_packets_come_of_which_doubtful_are(0);
}

/* Of 62 ms these bytes explain 32: the others count for the next ones, which explain 3. */
void test_what_held_bytes_do_not_explain_counts_for_the_next_ones(void)
{
    for (unsigned more_ms = 3; more_ms <= 4; more_ms++) {
        nothing_comes_for(62);
        feed_packets(5, 24);
        doubtful_are_the_first(0, 5);
        rig.now_ms += more_ms;
        feed_packets(2, 4);
        doubtful_are_the_first(more_ms == 3 ? 0 : 2, 2);
    }
}

/* Three packets of 31 samples and one of 30. */
void test_409_bytes_the_wire_can_have_brought(void)
{
    nothing_comes_for(63);
    feed_packets(3, 31);
    feed_packets(1, 30);
    doubtful_are_the_first(4, 4);
    two_packets_come_of_which_doubtful_are(1);
}

/* 30 ms and 4 for 54 bytes, counted from the 12 that were held. */
void test_a_pause_that_has_been_judged_does_not_count_for_the_next_one(void)
{
    static const encode_sample_t samples[4] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 4, 640, 736, samples};
    uint8_t bytes[22];

    TEST_ASSERT_EQUAL_UINT(22, encode_packet(bytes, &packet));
    rig.now_ms += 50;
    rig_feed(bytes, 12);
    polls_to(TMINI_EVENT_NONE);
    nothing_comes_for(34);
    rig_feed(&bytes[12], 10);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 3);
}

/* The last look was `unseen_ms` before these packets came, of 31 and of 30 samples, after a pause
 * of more than 100 ms. */
static void come_after_a_look(uint32_t pause_ms, uint32_t unseen_ms, unsigned of_31, unsigned of_30)
{
    open_with(100, false);
    rig.config.rx_size = 2 * RING_SIZE;
    rig_init();
    go_streaming();
    nothing_comes_for(pause_ms - unseen_ms + 1);
    rig.now_ms--;
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms += unseen_ms;
    feed_packets(of_31, 31);
    feed_packets(of_30, 30);
    doubtful_are_the_first(of_31 + of_30, of_31 + of_30);
}

/* 1024 bytes take the wire 45 ms: 28 and 16 before them are too few. */
void test_1024_bytes_in_28_ms_were_held(void)
{
    come_after_a_look(183, 28, 8, 2);
    two_packets_come_of_which_doubtful_are(1);
}

/* 1115 bytes take it 48.999 ms, of which 48 count: 32 and 16. */
void test_1115_bytes_in_32_ms_may_have_come(void)
{
    come_after_a_look(190, 32, 5, 6);
    two_packets_come_of_which_doubtful_are(1);
}

/* ---- More than the ring holds ---- */

/* 1024 bytes: eight packets of 31 samples and two of 30. */
void test_a_full_ring_is_no_reason_to_doubt(void)
{
    feed_packets(8, 31);
    feed_packets(2, 30);
    doubtful_are_the_first(0, 10);
}

/* A lap that nobody has seen, within a time that still counts as watched: the newest half of the
 * ring is taken, which here holds the three packets from before it once more, and two behind
 * them. */
void test_behind_a_lap_of_dma_what_comes_at_once_is_doubtful_and_the_next(void)
{
    static const encode_sample_t samples[4] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 4, 640, 736, samples};
    tmini_counters_t counters;
    size_t position = 0;

    memset(memory, 0, sizeof memory);
    open_with(100, true);
    rig_go_starting();
    for (unsigned i = 0; i < 3; i++) {
        position += encode_packet(&memory[position], &packet);
        tmini_feed_dma(&rig.lidar, position);
        TEST_ASSERT_NOT_EQUAL(0, rig_drain());
    }
    rig.now_ms += 60;
    tmini_feed_gap(&rig.lidar);
    position += encode_packet(&memory[position], &packet);
    position += encode_packet(&memory[position], &packet);
    tmini_feed_dma(&rig.lidar, position);
    doubtful_are_the_first(2, 2); /* Not again those that have been delivered. */
    tmini_counters(&rig.lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1024, counters.bytes_overrun);
    position += encode_packet(&memory[position], &packet);
    position += encode_packet(&memory[position], &packet);
    tmini_feed_dma(&rig.lidar, position);
    doubtful_are_the_first(1, 2);
}
