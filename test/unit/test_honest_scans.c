/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Whatever happens to the line, the receiver or the program: no scan has points of two revolutions,
 * and no scan with missing points is called complete. */

#include "turns.h"

#include "unity.h"

#include <string.h>

#define BIT(event) (1u << (event))
#define TURN_MS 164u

void setUp(void)
{
    turns_open_scanning(1024, false);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0, turns_scans.mixed, "scans of two revolutions");
}

/* The first `count` packets of a turn come. */
static void pass_part(unsigned count, uint16_t distance_mm)
{
    (void)turns_pass(0, count - 1, distance_mm);
}

static void pass_whole_turn(uint16_t distance_mm)
{
    (void)turns_pass(0, TURNS_PACKETS - 1, distance_mm);
}

/* No bytes come, and the program polls every millisecond. */
static void be_silent(uint32_t ms)
{
    for (; ms > 0; ms--) {
        turns.now_ms++;
        (void)turns_poll();
    }
}

static uint32_t overrun_bytes(void)
{
    tmini_counters_t counters;

    tmini_counters(&turns.lidar, &counters);
    return counters.bytes_overrun;
}

void test_on_a_healthy_line_every_turn_is_a_complete_scan(void)
{
    for (uint16_t turn = 1; turn <= 4; turn++) {
        pass_whole_turn(turn);
    }
    TEST_ASSERT_EQUAL_UINT(3, turns_scans.complete);
    TEST_ASSERT_EQUAL_UINT16(TURNS_POINTS, turns_scans.last.count);
}

/* ---- The line is silent in mid-scan, then continues at the right angle of another turn ---- */

/* After the silence comes the rest of the turn that is `turns_later` turns later. */
static void continue_after(unsigned turns_later)
{
    pass_part(7, 100);
    be_silent(turns_later * TURN_MS);
    (void)turns_pass(7, TURNS_PACKETS - 1, (uint16_t)(100 + turns_later));
    pass_whole_turn(200);
    (void)turns_pass(0, 0, 300);
}

void test_a_silence_of_whole_turns_ends_the_scan(void)
{
    for (unsigned later = 1; later <= 5; later++) {
        turns_open_scanning(1024, false);
        continue_after(later);
        TEST_ASSERT_EQUAL_UINT(0, turns_scans.mixed);
        TEST_ASSERT_EQUAL_UINT(4, turns_scans.count); /* Three partial scans and a whole one. */
        TEST_ASSERT_EQUAL_UINT(1, turns_scans.complete);
    }
}

void test_a_scan_that_a_silence_has_ended_is_not_complete_and_has_a_gap(void)
{
    pass_part(7, 100);
    be_silent(TURN_MS);
    (void)turns_pass(7, 7, 101);
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.count);
    TEST_ASSERT_FALSE(turns_scans.last.complete);
    TEST_ASSERT_EQUAL_UINT16(1, turns_scans.last.gaps);
    TEST_ASSERT_EQUAL_UINT16(1 + 6 * 40, turns_scans.last.count);
}

/* The silence is shorter than a turn, but the angles do not jump. */
void test_a_silence_of_nearly_a_whole_turn_ends_the_scan(void)
{
    pass_part(7, 100);
    be_silent(TURN_MS - 2);
    (void)turns_pass(7, TURNS_PACKETS - 1, 101);
    (void)turns_pass(0, 0, 102);
    TEST_ASSERT_EQUAL_UINT(3, turns_scans.count);
    TEST_ASSERT_EQUAL_UINT(0, turns_scans.complete);
}

/* From packet 3 of a turn to packet 12 of the next: the angles differ by 0.5 turns, the times by
 * 1.5. */
void test_a_silence_of_one_turn_and_a_half_ends_the_scan(void)
{
    pass_part(4, 100);
    be_silent(TURN_MS + TURN_MS / 2);
    (void)turns_pass(12, TURNS_PACKETS - 1, 101);
    (void)turns_pass(0, 0, 102);
    TEST_ASSERT_EQUAL_UINT(0, turns_scans.complete);
}

/* The plug has a bad contact during a packet: its two halves are of different turns. */
void test_a_silence_within_a_packet_ends_the_scan(void)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    pass_part(7, 100);
    turns_feed(bytes, turns_packet(bytes, 7, 100) / 2);
    be_silent(TURN_MS);
    const size_t size = turns_packet(bytes, 7, 101);
    turns_feed(&bytes[size / 2], size - size / 2);
    (void)turns_pass(8, TURNS_PACKETS - 1, 101);
    (void)turns_pass(0, 0, 102);
    TEST_ASSERT_EQUAL_UINT(0, turns_scans.complete);
}

/* For a whole turn only the beginning of each packet comes, without a silence or many skipped
 * bytes. Then the next turn continues at the right angle. */
void test_packets_cut_to_a_few_bytes_for_a_turn_end_the_scan(void)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    pass_part(7, 100);
    for (unsigned index = 7; index < TURNS_PACKETS + 7; index++) {
        (void)turns_packet(bytes, index % TURNS_PACKETS, 100);
        turns_feed(bytes, 9);
        be_silent(9);
    }
    (void)turns_pass(7, TURNS_PACKETS - 1, 101);
    (void)turns_pass(0, 0, 102);
    TEST_ASSERT_EQUAL_UINT(0, turns_scans.complete);
}

void test_a_silence_between_two_turns_costs_only_their_two_scans(void)
{
    pass_whole_turn(100);
    be_silent(3 * TURN_MS);
    pass_whole_turn(101);
    pass_whole_turn(102);
    (void)turns_pass(0, 0, 103);
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.complete);
    TEST_ASSERT_TRUE(turns_scans.last.complete);
}

/* ---- The ring overflows while the program is busy ---- */

/* Three turns come without a poll; then the stream continues without a jump of the angle. */
static void be_busy_for_turns(size_t rx_size)
{
    turns_open_scanning(rx_size, false);
    pass_part(7, 100);
    turns_feed_packets(7, TURNS_PACKETS - 1, 100);
    turns_feed_packets(0, TURNS_PACKETS - 1, 101);
    turns_feed_packets(0, TURNS_PACKETS - 1, 102);
    turns_feed_packets(0, 8, 103);
    (void)turns_poll();
    (void)turns_pass(9, TURNS_PACKETS - 1, 103);
    pass_whole_turn(104);
    (void)turns_pass(0, 0, 105);
}

void test_an_overflow_of_any_ring_mixes_no_turns(void)
{
    for (size_t size = 256; size <= 4096; size *= 2) {
        be_busy_for_turns(size);
        TEST_ASSERT_EQUAL_UINT(0, turns_scans.mixed);
        TEST_ASSERT_TRUE(overrun_bytes() > 0);
        TEST_ASSERT_TRUE(turns_scans.last.complete);
    }
}

/* The second overflow must not hide the first one: the angles of turn 102 continue those of the two
 * packets of turn 101 before it. */
void test_two_overflows_less_than_a_ring_apart_are_both_remembered(void)
{
    turns_open_scanning(512, false);
    (void)turns_pass(0, 14, 100);
    turns_feed_packets(15, TURNS_PACKETS - 1, 100);
    turns_feed_packets(0, 7, 101); /* The first overflow, after 101's second packet. */
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_SCAN, tmini_poll(&turns.lidar));
    turns_feed_packets(2, 8, 102); /* There is room for two of these: the second overflow. */
    (void)turns_poll();
    (void)turns_pass(9, TURNS_PACKETS - 1, 102);
    (void)turns_pass(0, TURNS_PACKETS - 1, 103);
    (void)turns_pass(0, 0, 104);
    TEST_ASSERT_EQUAL_UINT(0, turns_scans.mixed);
    TEST_ASSERT_TRUE(turns_scans.last.complete);
}

/* ---- DMA goes on while the CPU stands still ---- */

static unsigned next_index; /* Index of the lidar's next packet in its turn. */
static uint16_t next_turn;  /* The turn of that packet. */

static size_t next_packet(uint8_t *bytes)
{
    const size_t size = turns_packet(bytes, next_index, next_turn);

    turns.now_ms += 10;
    next_index = (next_index + 1) % TURNS_PACKETS;
    next_turn = (uint16_t)(next_turn + (next_index == 0 ? 1 : 0));
    return size;
}

/* DMA writes this many laps and a little more without a served interrupt. Then the loss is reported
 * before the position is published, as by a port that finds the interrupts of both halves
 * pending. */
static void lose_laps(unsigned laps)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    for (size_t written = 0; written < laps * turns.config.rx_size;) {
        const size_t size = next_packet(bytes);

        for (size_t i = 0; i < size; i++, written++) {
            turns.rx[turns.dma_position] = bytes[i];
            turns.dma_position = (turns.dma_position + 1) % turns.config.rx_size;
        }
    }
    tmini_feed_gap(&turns.lidar);
    tmini_feed_dma(&turns.lidar, turns.dma_position);
}

/* After the first packets of a turn, laps are lost; then three turns follow. */
static void go_on_after(unsigned laps, unsigned first_packets)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    turns_open_scanning(1024, true);
    pass_part(first_packets, 100);
    next_index = first_packets;
    next_turn = 100;
    lose_laps(laps);
    (void)turns_poll();
    for (unsigned i = 0; i < 3 * TURNS_PACKETS; i++) {
        turns_feed(bytes, next_packet(bytes));
        (void)turns_poll();
    }
}

void test_laps_that_dma_went_round_meanwhile_mix_no_turns(void)
{
    for (unsigned laps = 1; laps <= 9; laps++) {
        for (unsigned first_packets = 1; first_packets < TURNS_PACKETS; first_packets++) {
            go_on_after(laps, first_packets);
            TEST_ASSERT_EQUAL_UINT(0, turns_scans.mixed);
            TEST_ASSERT_TRUE(turns_scans.last.complete);
        }
    }
}

/* ---- A complete scan has all points of a full turn ---- */

/* Samples 2 degrees apart, so that few packets make an arc. */
static void pass_arc(uint8_t ct, uint8_t count, uint32_t first_q6)
{
    encode_sample_t samples[40] = {{0}};
    uint8_t bytes[TURNS_PACKET_MAX];
    const encode_packet_t packet = {ct, count, (uint16_t)(first_q6 % 23040),
                                    (uint16_t)((first_q6 + 128u * (count - 1u)) % 23040), samples};

    for (unsigned i = 0; i < count; i++) {
        samples[i] = (encode_sample_t){500, 9, 0};
    }
    turns.now_ms += 10;
    turns_feed(bytes, encode_packet(bytes, &packet));
    (void)turns_poll();
}

void test_an_arc_between_two_start_packets_is_not_complete(void)
{
    pass_arc(0x79, 1, 42 * 64);
    pass_arc(0x00, 16, 44 * 64); /* To 74 degrees. */
    pass_arc(0x00, 8, 76 * 64);  /* To 90 degrees. */
    pass_arc(0x79, 1, 93 * 64);
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.count);
    TEST_ASSERT_EQUAL_UINT16(25, turns_scans.last.count);
    TEST_ASSERT_FALSE(turns_scans.last.complete);
}

/* The start packet is lost, and the next packet has a single sample (section 9.6), less than two
 * degrees after the old turn's end. */
void test_a_lone_packet_after_a_lost_start_packet_is_not_of_the_old_turn(void)
{
    pass_whole_turn(100);
    pass_arc(0x00, 1, TURNS_STEP_Q6);
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.count);
    TEST_ASSERT_EQUAL_UINT16(TURNS_POINTS, turns_scans.last.count);
    TEST_ASSERT_FALSE(turns_scans.last.complete);
    (void)turns_pass(1, TURNS_PACKETS - 1, 500); /* The distance of the lone sample. */
    (void)turns_pass(0, 0, 501);
    TEST_ASSERT_EQUAL_UINT(2, turns_scans.count);
    TEST_ASSERT_FALSE(turns_scans.last.complete);
}

/* As on a real unit: the first packet is a start packet at 85.7 degrees; the next start is at 0. */
void test_a_first_turn_that_begins_late_is_not_complete(void)
{
    pass_arc(0x31, 1, 5485);
    for (unsigned i = 0; i < 8; i++) {
        pass_arc(0x00, 16, 5485 + 128 + 2048 * i);
    }
    pass_arc(0x00, 8, 5485 + 128 + 2048 * 8);
    pass_arc(0x31, 1, 0);
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.count);
    TEST_ASSERT_EQUAL_UINT16(1 + 8 * 16 + 8, turns_scans.last.count);
    TEST_ASSERT_FALSE(turns_scans.last.complete);
}

/* Without the last packet's six samples, 3.3 degrees are missing, which might be jitter. But
 * LastCRC shows that a packet is missing (section 7). */
static void pass_turn_without_its_last_packet(uint16_t distance_mm)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    (void)turns_pass(0, TURNS_PACKETS - 2, distance_mm);
    (void)turns_packet(bytes, TURNS_PACKETS - 1, distance_mm); /* Sent, and lost. */
}

void test_a_guarded_turn_is_complete(void)
{
    turns.ct_information = true;
    pass_whole_turn(100);
    pass_whole_turn(101);
    (void)turns_pass(0, 0, 102);
    TEST_ASSERT_EQUAL_UINT(2, turns_scans.complete);
}

void test_a_small_packet_whose_loss_the_guard_proves_is_missing(void)
{
    turns.ct_information = true;
    pass_whole_turn(100);
    pass_turn_without_its_last_packet(101);
    (void)turns_pass(0, 0, 102);
    TEST_ASSERT_EQUAL_UINT(2, turns_scans.count);
    TEST_ASSERT_EQUAL_UINT16(TURNS_POINTS - 6, turns_scans.last.count);
    TEST_ASSERT_FALSE(turns_scans.last.complete);
    TEST_ASSERT_EQUAL_UINT16(1, turns_scans.last.gaps);
}

/* ---- A pause between polls costs nothing ---- */

/* A layer below holds the second half of a packet while the program is busy for this time. The
 * program then polls before that layer has passed on the bytes. */
static void pause_within_a_packet(uint32_t pause_ms)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    turns_open_scanning(4096, false);
    pass_part(7, 100);
    const size_t size = turns_packet(bytes, 7, 100);
    turns_feed(bytes, 60);
    (void)turns_poll();
    turns.now_ms += pause_ms;
    (void)turns_poll();
    turns_feed(&bytes[60], size - 60);
    turns_feed_packets(8, TURNS_PACKETS - 1, 100);
    turns_feed_packets(0, 0, 101);
    turns.now_ms -= TURN_MS - 70; /* The bytes came during the pause. */
    (void)turns_poll();
}

void test_a_pause_between_polls_costs_no_packet(void)
{
    for (uint32_t pause_ms = 100; pause_ms <= 250; pause_ms += 25) {
        tmini_counters_t counters;

        pause_within_a_packet(pause_ms);
        tmini_counters(&turns.lidar, &counters);
        TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_skipped);
    }
}

/* The pause is as long as the rest of the turn takes, so the scan is complete. */
void test_a_pause_between_polls_costs_no_scan(void)
{
    pause_within_a_packet(115);
    TEST_ASSERT_EQUAL_UINT(1, turns_scans.complete);
}

/* ---- A stream that steps backwards ---- */

/* After 360 degrees back in small steps, a scan must still end after one turn forwards. */
void test_a_stream_that_steps_backwards_does_not_widen_a_scan(void)
{
    uint32_t at_q6 = 100 * 23040;

    pass_arc(0x79, 1, at_q6);
    for (unsigned i = 0; i < 240; i++, at_q6 -= 192) {
        pass_arc(0x00, 1, at_q6);
    }
    turns_scans.count = 0;
    for (unsigned i = 0; i < 124; i++, at_q6 += 192) { /* 372 degrees. */
        pass_arc(0x00, 1, at_q6);
    }
    TEST_ASSERT_TRUE(turns_scans.count > 0 || turns_scans.last.count > 0);
}
