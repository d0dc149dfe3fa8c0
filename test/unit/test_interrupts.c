/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ring and parser are interrupted by the other side before or after any access of an index that
 * both use. Both are compiled here with interrupting_atomic.h. */

#include "interrupting_atomic.h"
#include "receiver.h"
#include "stream.h"

#include "unity.h"

#include <string.h>

static uint8_t memory[256];
static uint8_t bytes[300];
static stream_t stream;
static receiver_t receiver;

static void (*handler)(void); /* Called at each access; NULL: interrupts are off. */
static unsigned accesses;     /* Since the call began. */
static unsigned chosen;       /* The access at which the handler acts. */

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
static bool has_come;

static void lap_comes(void)
{
    if (accesses == chosen) {
        receiver_feed(&receiver, lap, lap_size);
        has_come = true;
    }
}

static uint32_t bytes_accounted_for(void)
{
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    return counters.bytes_in_packets + counters.bytes_in_replies + counters.bytes_skipped +
           counters.bytes_overrun + (uint32_t)tmini_parser_pending(&receiver.parser);
}

/* Packets delivered as intact must be among those sent. */
static void expect_true_packets(tmini_frame_type_t frame, uint8_t count, uint8_t lap_count)
{
    for (; frame != TMINI_FRAME_NONE; frame = next_with(NULL)) {
        const bool is_intact = tmini_frame_intact(tmini_parser_frame(&receiver.parser));
        tmini_packet_open(&receiver.packet, tmini_parser_frame(&receiver.parser));
        const uint8_t got = receiver.packet.count;
        TEST_ASSERT_TRUE(!is_intact || got == count || got == lap_count);
        TEST_ASSERT_EQUAL_UINT32(receiver.received, bytes_accounted_for());
    }
    TEST_ASSERT_EQUAL_UINT32(receiver.received, bytes_accounted_for());
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
