/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Pauses of the line while the lidar scans make packets doubtful: others may be missing before
 * them. The bytes that end a pause explain part of it, 1 ms per 13.1 bytes. It is too long if the
 * rest is more than half a turn (41 ms at 12 Hz) and more than max_pause_ms. */

#include "invariants.h"
#include "rig.h"

#include "unity.h"

#include <string.h>

static uint8_t memory[2048];

#define RING_SIZE 1024u

/* A streaming driver with the ring of this test. */
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

/* No bytes come. Polls every 30 ms, the longest interval that counts as watching the line, and 1 ms
 * before the end. The next poll is at the end. */
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
void test_41_ms_more_than_the_bytes_explain_are_no_pause(void)
{
    for (unsigned i = 0; i < 3; i++) {
        nothing_comes_for(44);
        feed_packets(2, 4);
        doubtful_are_the_first(0, 2);
        two_packets_come_of_which_doubtful_are(0);
    }
}

void test_a_longer_pause_makes_only_the_packets_around_it_doubtful(void)
{
    nothing_comes_for(45);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
    two_packets_come_of_which_doubtful_are(1); /* The pause may have been before this packet. */
    two_packets_come_of_which_doubtful_are(0);
}

/* No time passes until the clock has caught up, if it steps back by at most a second. */
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

/* The step may hide a pause before the bytes that come meanwhile, or before the next packet. */
void test_a_clock_that_steps_back_by_more_than_10_ms_makes_packets_doubtful(void)
{
    rig.now_ms -= 11;
    polls_to(TMINI_EVENT_NONE);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
    rig.now_ms += 12;
    two_packets_come_of_which_doubtful_are(1);
    two_packets_come_of_which_doubtful_are(0);
}

/* 410 bytes explain 31 ms. */
void test_many_bytes_explain_a_long_pause(void)
{
    nothing_comes_for(72);
    feed_packets(5, 24);
    doubtful_are_the_first(0, 5);
}

void test_many_bytes_do_not_explain_every_pause(void)
{
    nothing_comes_for(73);
    feed_packets(5, 24);
    doubtful_are_the_first(5, 5);
}

/* 170 bytes take 12.95 ms, of which 12 count. */
void test_what_bytes_explain_is_rounded_down(void)
{
    nothing_comes_for(54);
    feed_packets(2, 25);
    doubtful_are_the_first(2, 2);
}

/* With this max_pause_ms, `pause_ms` is not too long, but 1 ms more is. */
static void longest_pause_is(uint16_t max_pause_ms, uint32_t pause_ms)
{
    for (unsigned longer = 0; longer < 2; longer++) {
        open_with(max_pause_ms, false);
        go_streaming();
        nothing_comes_for(pause_ms + longer + 3);
        feed_packets(2, 4);
        doubtful_are_the_first(2 * longer, 2);
    }
}

void test_a_limit_below_half_a_turn_counts_as_half_a_turn(void)
{
    longest_pause_is(1, 41);
    longest_pause_is(41, 41);
    longest_pause_is(42, 42);
    longest_pause_is(249, 249);
}

void test_without_a_limit_no_pause_is_doubted(void)
{
    open_with(0, false);
    go_streaming();
    nothing_comes_for(900);
    feed_packets(2, 4);
    doubtful_are_the_first(0, 2);
}

/* Only the first byte of the second packet is among them, which is enough. */
void test_a_packet_is_doubtful_if_it_begins_among_the_bytes_after_a_pause(void)
{
    static const encode_sample_t samples[4] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 4, 640, 736, samples};
    uint8_t bytes[22];

    TEST_ASSERT_EQUAL_UINT(22, encode_packet(bytes, &packet));
    nothing_comes_for(45);
    feed_packets(1, 4);
    rig_feed(bytes, 1);
    doubtful_are_the_first(1, 1);
    rig.now_ms += 2;
    rig_feed(&bytes[1], 21);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 3);
}

/* 65,546 is 10 in 16 bits. */
void test_after_a_start_only_the_first_packet_is_doubtful_if_the_line_was_watched(void)
{
    for (uint32_t unseen_ms = 30; unseen_ms <= 31; unseen_ms++) {
        open_with(30, false);
        rig_go_idle();
        rig.now_ms = 65546;
        begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
        answers_and_gets(600, START);
        passes(1000); /* It looks a millisecond before the end. */
        rig.now_ms += unseen_ms - 1;
        rig_feed_scan_reply();
        feed_packets(2, 4);
        polls_to(TMINI_EVENT_STARTED);
        doubtful_are_the_first(unseen_ms == 30 ? 1 : 2, 2);
    }
}

/* ---- Bytes that a layer below has held back ---- */

void test_after_a_pause_between_polls_the_first_packet_after_it_is_doubtful_too(void)
{
    rig.now_ms += 50;
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
    two_packets_come_of_which_doubtful_are(1);
    two_packets_come_of_which_doubtful_are(0);
}

/* 44 bytes explain 3 ms. A pause is judged alone, and together with the one before it. */
void test_unexplained_time_counts_again_with_the_next_pause(void)
{
    for (unsigned more_ms = 3; more_ms <= 4; more_ms++) {
        nothing_comes_for(44);
        feed_packets(2, 4);
        doubtful_are_the_first(0, 2);
        rig.now_ms += more_ms;
        feed_packets(2, 4);
        doubtful_are_the_first(more_ms == 3 ? 0 : 2, 2);
        two_packets_come_of_which_doubtful_are(more_ms == 3 ? 0 : 1);
    }
}

/* ---- Bytes that the port reports to hold ---- */

/* 544 bytes explain 41 ms. */
void test_bytes_that_the_port_holds_explain_a_pause_as_well(void)
{
    for (unsigned longer = 0; longer < 2; longer++) {
        nothing_comes_for(82 + longer);
        feed_packets(2, 4);
        tmini_feed_held(&rig.lidar, 500);
        doubtful_are_the_first(2 * longer, 2);
    }
}

/* 500 bytes were held when 410 of them were fed. The others, fed later, explain no time again: only
 * the 44 bytes after them do, 3 ms. */
void test_held_bytes_explain_a_pause_only_once(void)
{
    for (unsigned longer = 0; longer < 2; longer++) {
        tmini_feed_held(&rig.lidar, 500);
        feed_packets(5, 24);
        (void)rig_drain();
        nothing_comes_for(44 + longer);
        feed_packets(2, 4);
        doubtful_are_the_first(0, 2);
        feed_packets(1, 12);
        doubtful_are_the_first(0, 1);
        feed_packets(2, 4);
        doubtful_are_the_first(2 * longer, 2);
    }
}

/* More than 65,535 bytes ahead, the place counts as passed. */
void test_held_bytes_more_than_65535_ahead_explain_nothing(void)
{
    tmini_feed_held(&rig.lidar, 65535 + 44);
    nothing_comes_for(900);
    feed_packets(2, 4);
    doubtful_are_the_first(0, 2);
    tmini_feed_held(&rig.lidar, 65536 + 44);
    nothing_comes_for(45);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 2);
}

/* 45 ms are allowed from the 12 late bytes on: 41, and 4 for the 54 bytes. */
void test_a_pause_that_has_been_judged_does_not_count_for_the_next_one(void)
{
    static const encode_sample_t samples[4] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 4, 640, 736, samples};
    uint8_t bytes[22];

    TEST_ASSERT_EQUAL_UINT(22, encode_packet(bytes, &packet));
    rig.now_ms += 50;
    rig_feed(bytes, 12);
    polls_to(TMINI_EVENT_NONE);
    nothing_comes_for(45);
    rig_feed(&bytes[12], 10);
    feed_packets(2, 4);
    doubtful_are_the_first(2, 3);
}

/* ---- More than the ring holds ---- */

/* 1024 bytes: eight packets of 31 samples and two of 30. */
void test_a_full_ring_is_no_reason_to_doubt(void)
{
    feed_packets(8, 31);
    feed_packets(2, 30);
    doubtful_are_the_first(0, 10);
}

/* DMA makes laps that are reported before the next poll. The ring then contains the three packets
 * delivered before, and two new ones. */
static void go_round_unseen(unsigned laps)
{
    static const encode_sample_t samples[4] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 4, 640, 736, samples};
    tmini_counters_t counters;
    size_t position = 0;

    memset(memory, 0, sizeof memory);
    open_with(100, true);
    rig_go_idle();
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    position = encode_frequency_reply(memory, 600);
    tmini_feed_dma(&rig.lidar, position);
    polls_and_sends(START);
    for (unsigned i = 0; i < 3; i++) {
        position += encode_packet(&memory[position], &packet);
        tmini_feed_dma(&rig.lidar, position);
        TEST_ASSERT_NOT_EQUAL(0, rig_drain());
    }
    rig.now_ms += 60;
    for (unsigned lap = 0; lap < laps; lap++) {
        tmini_feed_gap(&rig.lidar);
    }
    position += encode_packet(&memory[position], &packet);
    position += encode_packet(&memory[position], &packet);
    tmini_feed_dma(&rig.lidar, position);
    doubtful_are_the_first(2, 2); /* Delivered packets are not delivered again. */
    tmini_counters(&rig.lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(laps * 1024, counters.bytes_overrun);
    position += encode_packet(&memory[position], &packet);
    position += encode_packet(&memory[position], &packet);
    tmini_feed_dma(&rig.lidar, position);
    doubtful_are_the_first(1, 2);
}

void test_after_laps_of_dma_the_bytes_at_hand_and_the_next_packet_are_doubtful(void)
{
    go_round_unseen(1);
    go_round_unseen(2);
    go_round_unseen(5);
}
