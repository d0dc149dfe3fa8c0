/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Commands that get lost, and replies to earlier commands. */

#include "known_packets.h"
#include "turns.h"

#include "tmini/parts/tmini_parser.h"
#include "unity.h"

#include <string.h>

#define BIT(event) (1u << (event))

enum { GET_FREQUENCY = 0x0D, START = 0x60, STOP = 0x65 };

void setUp(void)
{
    turns_open(1024, false);
}

void tearDown(void) {}

/* Polls every millisecond; returns a bit for each event. */
static unsigned pass_ms(uint32_t ms)
{
    unsigned events = 0;

    for (; ms > 0; ms--) {
        turns.now_ms++;
        events |= turns_poll();
    }
    return events;
}

static unsigned writes_of(uint8_t code)
{
    unsigned count = 0;

    for (unsigned i = 0; i < turns.writes && i < sizeof turns.written; i++) {
        count += turns.written[i] == code ? 1 : 0;
    }
    return count;
}

static void feed_frequency(uint32_t frequency_chz)
{
    uint8_t reply[ENCODE_REPLY_MAX];

    turns_feed(reply, encode_frequency_reply(reply, frequency_chz));
}

/* ---- A stop that the lidar does not receive ---- */

/* The start has been acknowledged; the motor spins up. */
static void go_spinning_up(void)
{
    uint8_t reply[ENCODE_REPLY_MAX];

    (void)tmini_start(&turns.lidar);
    (void)pass_ms(100);
    turns_feed(reply, encode_frequency_reply(reply, 600));
    (void)pass_ms(5);
    turns_feed(reply, encode_scan_reply(reply));
    (void)pass_ms(5);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_STARTING, tmini_state(&turns.lidar));
}

void test_a_stop_that_is_lost_in_spin_up_is_sent_again_when_the_lidar_streams(void)
{
    unsigned events = 0;

    go_spinning_up();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&turns.lidar));
    const unsigned stops = writes_of(STOP);
    events = pass_ms(200); /* The motor still spins up; the line is quiet. */
    TEST_ASSERT_TRUE((events & BIT(TMINI_EVENT_STOPPED)) != 0);
    events = 0;
    for (uint16_t turn = 1; turn < 10 && writes_of(STOP) == stops; turn++) {
        events |= turns_pass(0, TURNS_PACKETS - 1, turn);
    }
    TEST_ASSERT_TRUE_MESSAGE(writes_of(STOP) > stops, "no second stop");
    TEST_ASSERT_TRUE_MESSAGE((events & BIT(TMINI_EVENT_UNWANTED_SCANNING)) != 0, "not reported");
    events = pass_ms(200);
    TEST_ASSERT_TRUE_MESSAGE((events & BIT(TMINI_EVENT_STOPPED)) != 0, "not stopped");
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_IDLE, tmini_state(&turns.lidar));
}

void test_a_lidar_that_will_not_stop_is_stopped_again_and_again(void)
{
    go_spinning_up();
    (void)tmini_stop(&turns.lidar);
    (void)pass_ms(200);
    for (uint16_t turn = 1; turn < 60; turn++) { /* 10 s. */
        (void)turns_pass(0, TURNS_PACKETS - 1, turn);
    }
    TEST_ASSERT_TRUE(writes_of(STOP) >= 4);
    TEST_ASSERT_EQUAL_UINT(1, writes_of(START));
}

/* ---- Replies to earlier commands ---- */

static void go_idle(void)
{
    (void)tmini_stop(&turns.lidar);
    TEST_ASSERT_TRUE((pass_ms(200) & BIT(TMINI_EVENT_STOPPED)) != 0);
}

/* Scanning, then stopped: the stop cuts off the last packet. After it the reply to an earlier query
 * may come. */
static void stop_in_mid_packet(bool stale_reply)
{
    uint8_t bytes[TURNS_PACKET_MAX + 1];

    turns_open_scanning(1024, false);
    (void)turns_pass(0, 3, 100);
    (void)tmini_stop(&turns.lidar);
    (void)turns_packet(bytes, 4, 100);
    turns_feed(bytes, 60);
    if (stale_reply) {
        feed_frequency(800);
    }
    TEST_ASSERT_TRUE((pass_ms(60) & BIT(TMINI_EVENT_STOPPED)) != 0);
}

void test_a_stale_reply_after_a_packet_cut_off_by_the_stop_is_no_answer(void)
{
    unsigned events = 0;

    stop_in_mid_packet(true);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_frequency(&turns.lidar));
    events = pass_ms(120); /* The lidar replies late. */
    if ((events & BIT(TMINI_EVENT_FREQUENCY)) == 0) {
        feed_frequency(600);
        events |= pass_ms(2000);
    }
    TEST_ASSERT_TRUE((events & BIT(TMINI_EVENT_FREQUENCY)) != 0);
    TEST_ASSERT_EQUAL_UINT16(600, tmini_frequency_chz(&turns.lidar));
}

void test_a_stop_that_cuts_a_packet_does_not_delay_the_next_answer(void)
{
    unsigned events = 0;

    stop_in_mid_packet(false);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_frequency(&turns.lidar));
    events = pass_ms(3);
    feed_frequency(600);
    events |= pass_ms(1);
    TEST_ASSERT_TRUE((events & BIT(TMINI_EVENT_FREQUENCY)) != 0);
    TEST_ASSERT_EQUAL_UINT16(600, tmini_frequency_chz(&turns.lidar));
}

/* The vendor specifies 6 to 12 Hz (section 1); 65535 is 655.35 Hz. */
void test_an_impossible_frequency_is_not_accepted(void)
{
    static const uint32_t impossible[] = {0, 99, 65535, 131072, 0xFFFFFFFF};

    for (unsigned i = 0; i < sizeof impossible / sizeof impossible[0]; i++) {
        unsigned events = 0;

        turns_open(1024, false);
        go_idle();
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_frequency(&turns.lidar));
        for (unsigned tries = 0; tries < 12 && (events & BIT(TMINI_EVENT_COMMAND_FAILED)) == 0;
             tries++) {
            (void)pass_ms(3);
            feed_frequency(impossible[i]);
            events |= pass_ms(1000);
        }
        TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_COMMAND_FAILED), events);
        TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&turns.lidar));
    }
}

/* Programs for similar lidars send `A5 98`; real units answer it, perhaps late (section 9). */
void test_a_late_reply_to_a_command_that_this_driver_never_sends_disturbs_no_answer(void)
{
    static const uint8_t late[11] = {0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00, 0x10};
    unsigned events = 0;

    go_idle();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_frequency(&turns.lidar));
    turns_feed(late, sizeof late);
    events = pass_ms(10);
    TEST_ASSERT_EQUAL_HEX(0, events);
    feed_frequency(1000);
    events = pass_ms(1);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FREQUENCY), events);
    TEST_ASSERT_EQUAL_UINT16(1000, tmini_frequency_chz(&turns.lidar));
}

void test_a_late_reply_among_packets_costs_none_of_them(void)
{
    static const uint8_t late[11] = {0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00, 0x10};
    tmini_counters_t counters;

    turns_open_scanning(1024, false);
    (void)turns_pass(0, 5, 100);
    turns_feed(late, sizeof late);
    (void)turns_pass(6, TURNS_PACKETS - 1, 100);
    (void)turns_pass(0, 0, 101);
    tmini_counters(&turns.lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(sizeof late, counters.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT16(TURNS_POINTS, turns_scans.last.count);
}

/* ---- The parser alone ---- */

/* A ring of 64 bytes cannot hold this reply. Waiting for it must not stop the packets. */
void test_a_reply_longer_than_the_ring_is_not_waited_for(void)
{
    static const uint8_t header[7] = {0xA5, 0x5A, 100, 0x00, 0x00, 0x00, 0x04};
    static const tmini_reply_header_t awaited = {.type = 4, .mode = 0, .length = 100};
    uint8_t memory[64];
    tmini_ring_t ring;
    tmini_parser_t parser;
    unsigned packets = 0;

    (void)tmini_ring_init(&ring, memory, sizeof memory, false);
    (void)tmini_parser_init(&parser, &ring, 10);
    (void)tmini_parser_await(&parser, &awaited);
    tmini_ring_write(&ring, header, sizeof header);
    for (unsigned i = 0; i < 10; i++) {
        tmini_ring_write(&ring, start_packet, sizeof start_packet);
        while (tmini_parser_next(&parser) == TMINI_FRAME_PACKET) {
            packets++;
        }
    }
    TEST_ASSERT_EQUAL_UINT(10, packets);
}
