/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ring, parser and driver are interrupted by the other side before or after any access of an index
 * that both use. The library is compiled here with interrupting_atomic.h. */

#include "interrupting_atomic.h"
#include "receiver.h"
#include "stream.h"
#include "tale.h"

#include "unity.h"

#include <string.h>

static uint8_t memory[256];
static uint8_t bytes[300];
static stream_t stream;
static receiver_t receiver;

static void (*handler)(void); /* Called at each access; NULL: interrupts are off. */
static unsigned accesses;     /* Since the call began. */
static unsigned chosen;       /* The access at which the handler acts. */
static bool has_come;         /* It has acted. */

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
    accesses = 0;
    stream = (stream_t){bytes, 0, sizeof bytes};
    memset(memory, 0, sizeof memory);
}

void tearDown(void)
{
    handler = NULL;
}

/* Calls the parser; `come` interrupts it. */
static tmini_frame_type_t next_with(void (*come)(void))
{
    accesses = 0;
    handler = come;
    const tmini_frame_type_t frame = tmini_parser_next(&receiver.parser);
    handler = NULL;
    return frame;
}

/* ---------------------------------------------------------------------------- receive interrupt */

static size_t fed;

/* A byte comes at every access. */
static void byte_comes(void)
{
    if (fed < stream.size) {
        tmini_ring_put(&receiver.ring, bytes[fed++]);
    }
}

void test_bytes_that_come_while_the_parser_works_are_all_parsed(void)
{
    static const uint8_t counts[5] = {1, 8, 1, 1, 20};
    (void)stream_add_packet(&stream, 0x79, 1, 0, 0);
    (void)stream_add_packet(&stream, 0x00, 8, 10, 100);
    stream_add_byte(&stream, 0xAA);
    (void)stream_add_packet(&stream, 0x79, 1, 0, 0);
    (void)stream_add_packet(&stream, 0x00, 1, 20, 10);
    (void)stream_add_packet(&stream, 0x00, 20, 100, 900);
    fed = 0;
    receiver_open(&receiver, memory, 128, 39);
    for (unsigned i = 0; i < 5;) {
        if (next_with(byte_comes) == TMINI_FRAME_PACKET) {
            tmini_packet_open(&receiver.packet, tmini_parser_frame(&receiver.parser));
            TEST_ASSERT_EQUAL_UINT8(counts[i], receiver.packet.count);
            i++;
        }
    }
    TEST_ASSERT_EQUAL_UINT(stream.size, fed);
    TEST_ASSERT_EQUAL_UINT32(1, receiver_counters(&receiver).bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(0, receiver_counters(&receiver).bytes_overrun);
}

/* At the chosen access the packet's last byte comes, then more bytes than the ring can hold. */
static void last_byte_and_an_overflow_come(void)
{
    if (accesses == chosen) {
        tmini_ring_put(&receiver.ring, bytes[12]);
        for (unsigned i = 0; i < sizeof memory; i++) {
            tmini_ring_put(&receiver.ring, 0);
        }
    }
}

/* The same, but the bytes after it are reported as lost. */
static void last_byte_and_a_gap_come(void)
{
    if (accesses == chosen) {
        tmini_ring_put(&receiver.ring, bytes[12]);
        tmini_ring_gap(&receiver.ring);
    }
}

static void packet_is_found_whenever(void (*come)(void))
{
    bool has_come = true;
    (void)stream_add_packet(&stream, 0x79, 1, 0, 0);
    for (chosen = 1; has_come; chosen++) {
        receiver_open(&receiver, memory, sizeof memory, 0);
        receiver_feed(&receiver, bytes, 12);
        tmini_frame_type_t frame = next_with(come);
        has_come = accesses >= chosen;
        if (frame == TMINI_FRAME_NONE && tmini_ring_is_closed(&receiver.ring)) {
            frame = next_with(NULL);
        }
        TEST_ASSERT_EQUAL_INT(has_come ? TMINI_FRAME_PACKET : TMINI_FRAME_NONE, frame);
    }
    TEST_ASSERT_TRUE(chosen > 3); /* At least three accesses were tried. */
}

void test_a_packet_is_found_whenever_its_last_byte_and_an_overflow_come(void)
{
    packet_is_found_whenever(last_byte_and_an_overflow_come);
}

void test_a_packet_is_found_whenever_its_last_byte_and_a_gap_come(void)
{
    packet_is_found_whenever(last_byte_and_a_gap_come);
}

/* Bytes that are not refused must be read unchanged, though the reader makes room meanwhile. */
static uint8_t expected_byte;
static size_t read_bytes;

static void reader_comes(void)
{
    while (tmini_ring_unread(&receiver.ring) > 0) {
        TEST_ASSERT_EQUAL_HEX8(expected_byte, tmini_ring_peek(&receiver.ring, 0));
        tmini_ring_discard(&receiver.ring, 1);
        expected_byte++;
        read_bytes++;
    }
}

static void reader_comes_at_the_chosen_access(void)
{
    if (accesses % 7 == chosen) {
        reader_comes();
    }
}

/* Writes `count` bytes with the values next, next + 1, …; returns how many were accepted. */
static size_t write_numbers(uint8_t next, size_t count)
{
    const size_t refused = receiver.ring.overrun;
    for (size_t i = 0; i < count; i++) {
        bytes[i] = (uint8_t)(next + i);
    }
    if (count == 1) {
        tmini_ring_put(&receiver.ring, next);
    } else {
        tmini_ring_write(&receiver.ring, bytes, count);
    }
    return count - (receiver.ring.overrun - refused);
}

void test_a_reader_on_another_core_loses_and_repeats_nothing(void)
{
    for (chosen = 0; chosen < 7; chosen++) {
        size_t taken = 0;
        receiver_open(&receiver, memory, 32, 1);
        expected_byte = 0;
        read_bytes = 0;
        handler = reader_comes_at_the_chosen_access;
        for (size_t round = 0; round < 200; round++) {
            taken += write_numbers((uint8_t)taken, round % 80);
            taken += write_numbers((uint8_t)taken, 1);
        }
        handler = NULL;
        reader_comes();
        TEST_ASSERT_EQUAL_UINT(taken, read_bytes);
        TEST_ASSERT_TRUE(taken > 400);
    }
}

/* Reading the reader's index is slow on some machines: the receive interrupt must rarely do it. */
void test_the_readers_index_is_looked_at_once_a_lap(void)
{
    receiver_open(&receiver, memory, 32, 1);
    accesses = 0;
    for (size_t i = 0; i < 320; i++) {
        tmini_ring_put(&receiver.ring, 0);
        tmini_ring_discard(&receiver.ring, 1); /* Stores the reader's index. */
    }
    TEST_ASSERT_EQUAL_UINT(2 * (320 + 320 + 10), accesses); /* Before and after each access. */
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&receiver.ring));
}

/* ------------------------------------------------------------------------------------------ DMA */

/* At the chosen access, DMA writes `lap_size` bytes at once. */
static uint8_t lap[256];
static size_t lap_size;

static void lap_comes(void)
{
    if (accesses == chosen) {
        receiver_feed(&receiver, lap, lap_size);
        has_come = true;
    }
}

/* Packets delivered as intact must be among those sent. */
static void expect_true_packets(tmini_frame_type_t frame, uint8_t count, uint8_t lap_count)
{
    for (; frame != TMINI_FRAME_NONE; frame = next_with(NULL)) {
        const bool is_intact = tmini_frame_intact(tmini_parser_frame(&receiver.parser));
        tmini_packet_open(&receiver.packet, tmini_parser_frame(&receiver.parser));
        const uint8_t got = receiver.packet.count;
        TEST_ASSERT_TRUE(!is_intact || got == count || got == lap_count);
        receiver_check_accounts(&receiver);
    }
    receiver_check_accounts(&receiver);
}

/* Prepares a lap in which DMA writes a packet of 20 samples exactly over one of 30. */
static void overtake(size_t size)
{
    stream.size = 0;
    (void)stream_add_packet(&stream, 0x00, 30, 0, 900); /* 100 bytes. */
    receiver_open_dma(&receiver, memory, 256, 39);
    receiver_feed(&receiver, bytes, stream.size);
    memset(lap, 0x22, sizeof lap);
    stream_t over = {&lap[156], 0, 100}; /* After 156 bytes the ring wraps around. */
    (void)stream_add_packet(&over, 0x00, 20, 100, 200);
    lap_size = size;
    has_come = false;
}

void test_dma_that_overtakes_the_parser_at_any_moment_makes_no_wrong_packet(void)
{
    static const size_t laps[] = {28, 29, 60, 156, 170, 199, 226, 256};
    for (size_t i = 0; i < sizeof laps / sizeof laps[0]; i++) {
        chosen = 0;
        do {
            chosen++;
            overtake(laps[i]);
            expect_true_packets(next_with(lap_comes), 30, 20);
        } while (has_come);
        TEST_ASSERT_TRUE(chosen > 5); /* At least five accesses were tried. */
    }
}

/* DMA overwrites the packet after the parser found it intact, before it is delivered. */
void test_a_packet_that_dma_overwrites_while_it_is_checked_is_not_delivered(void)
{
    unsigned discarded = 0;
    for (chosen = 1; chosen < 12; chosen++) {
        overtake(29); /* The first byte of the packet is no longer certain. */
        const tmini_frame_type_t frame = next_with(lap_comes);
        if (frame == TMINI_FRAME_NONE && has_come) {
            TEST_ASSERT_EQUAL_UINT32(1, receiver_counters(&receiver).bytes_overrun);
            TEST_ASSERT_EQUAL_UINT32(0, receiver_counters(&receiver).packets);
            TEST_ASSERT_EQUAL_UINT32(128, receiver_counters(&receiver).bytes_skipped);
            discarded++;
        }
    }
    TEST_ASSERT_TRUE(discarded >= 3);
}

void test_the_last_packet_that_half_a_ring_holds_is_delivered(void)
{
    for (chosen = 1; chosen < 12; chosen++) {
        overtake(28); /* 128 bytes are unread: all are certain. */
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, next_with(lap_comes));
        TEST_ASSERT_TRUE(tmini_frame_intact(tmini_parser_frame(&receiver.parser)));
    }
}

/* ------------------------------------------------------------------------- polls of the driver */

static tmini_event_t poll_with(void (*come)(void))
{
    accesses = 0;
    has_come = false;
    handler = come;
    const tmini_event_t event = tmini_poll(&rig.lidar);
    handler = NULL;
    return event;
}

/* Turn 1 is packets 10 to 19: a start packet, and nine of twelve samples, 46 bytes each, of which
 * the ring holds five. The distance of all samples shows their turn. */
#define PACKETS 10u
#define POINTS 109

static tmini_point_t points[POINTS];
static unsigned complete;

static void open_scanning(void)
{
    tale_begin();
    rig.config.points = points;
    rig.config.max_points = POINTS;
    tale_tell("scans");
    complete = 0;
}

static void feed_packets(unsigned first, unsigned last)
{
    for (unsigned number = first; number <= last; number++) {
        const unsigned index = number % PACKETS;
        const unsigned from = index == 0 ? 0 : 1 + 12 * (index - 1);
        encode_sample_t samples[12];
        const encode_packet_t packet = {.ct = index == 0 ? 0x79 : 0,
                                        .lsn = index == 0 ? 1 : 12,
                                        .first_q6 = (uint16_t)(from * 211),
                                        .last_q6 = (uint16_t)((index == 0 ? 0 : from + 11) * 211),
                                        .samples = samples};
        for (unsigned i = 0; i < 12; i++) {
            samples[i] = (encode_sample_t){(uint16_t)(100 + number / PACKETS), 1, 0};
        }
        rig_feed(bytes, encode_packet(bytes, &packet));
    }
}

/* Polls; returns how many scans have points of two turns. */
static unsigned mixed_scans(unsigned polls, void (*come)(void))
{
    unsigned mixed = 0;
    for (; polls > 0; polls--) {
        if (poll_with(come) == TMINI_EVENT_SCAN) {
            const tmini_scan_t *const scan = tmini_scan(&rig.lidar);
            mixed += points[0].distance_mm != points[scan->count - 1].distance_mm ? 1 : 0;
            complete += scan->complete ? 1 : 0;
        }
    }
    return mixed;
}

static unsigned pass_packets(unsigned first, unsigned last)
{
    unsigned mixed = 0;
    for (unsigned number = first; number <= last; number++) {
        feed_packets(number, number);
        mixed += mixed_scans(3, NULL);
    }
    return mixed;
}

/* The ring has no room for it. */
static void a_turn_comes(void)
{
    if (accesses == chosen) {
        feed_packets(19, 28);
        has_come = true;
    }
}

/* The ring is full of packets of turn 1, which the poll releases one by one. The first packet after
 * the overflow, of turn 2, continues them at the right angle. */
void test_an_overflow_at_any_moment_of_a_poll_mixes_no_turns(void)
{
    bool came = true;
    for (chosen = 1; came; chosen++) {
        open_scanning();
        (void)pass_packets(10, 13);
        feed_packets(14, 18);
        unsigned mixed = mixed_scans(1, a_turn_comes);
        came = has_come;
        mixed += pass_packets(29, 60);
        TEST_ASSERT_TRUE(!came || (mixed == 0 && complete >= 2));
    }
    TEST_ASSERT_TRUE(chosen > 10);
}

static unsigned next_packet;

/* A few bytes find no room. */
static void packets_come_one_by_one(void)
{
    if (accesses % 3 == chosen % 3 && next_packet < 70) {
        feed_packets(next_packet, next_packet);
        next_packet++;
    }
}

void test_overflow_after_overflow_during_polls_mixes_no_turns(void)
{
    for (chosen = 0; chosen < 3; chosen++) {
        open_scanning();
        feed_packets(9, 9); /* Work for the first poll. */
        next_packet = 10;
        TEST_ASSERT_EQUAL_UINT(0, mixed_scans(200, packets_come_one_by_one));
        TEST_ASSERT_EQUAL_UINT(70, next_packet);
    }
}

/* ---- DMA overwrites an intact reply before it is copied ---- */

static void dma_laps(void)
{
    if (accesses == chosen) {
        memset(lap, 0x77, sizeof lap);
        rig_feed(lap, 250);
        has_come = true;
    }
}

/* The reply is taken if it comes again and is not overwritten. */
void test_a_reply_that_dma_overwrites_before_it_is_copied_is_no_answer(void)
{
    static const uint8_t serial[] = {2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4};
    chosen = 0;
    do {
        tale_begin();
        tale_tell("dma samples:39 idle info >90");
        rig_feed_info();
        chosen++;
        if (poll_with(dma_laps) != TMINI_EVENT_INFO) {
            rig_feed_info();
            tale_tell("!INFO");
        }
        TEST_ASSERT_EQUAL_UINT8(151, tmini_info(&rig.lidar)->model);
        TEST_ASSERT_EQUAL_UINT8_ARRAY(serial, tmini_info(&rig.lidar)->serial, 16);
    } while (has_come);
    TEST_ASSERT_TRUE(chosen > 3);
}

/* ---- A poll's work is bounded by the bytes in the ring when it began ---- */

/* A producer that never pauses: false headers, each of which might be a packet of 80 samples. */
static void false_headers_come(void)
{
    static const uint8_t header[10] = {0xAA, 0x55, 0x00, 0x50, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00};
    if (fed < 30000) {
        rig_feed_byte(header[fed % 10]);
        fed++;
    }
}

void test_a_producer_that_never_pauses_does_not_prolong_a_poll(void)
{
    tmini_counters_t counters;
    open_scanning();
    fed = 0;
    while (fed < RIG_RX_SIZE) {
        false_headers_come();
    }
    (void)poll_with(false_headers_come);
    tmini_counters(&rig.lidar, &counters);
    TEST_ASSERT_TRUE_MESSAGE(counters.bytes_skipped <= RIG_RX_SIZE,
                             "more was looked at than lay in the ring");
}
