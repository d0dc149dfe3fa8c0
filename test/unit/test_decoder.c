/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* From bytes to packets and scans: the part that the decoder adds to parser, CT and builder. */

#include "stream.h"

#include "tmini/parts/tmini_decoder.h"
#include "unity.h"

#include <string.h>

static uint8_t memory[512];
static uint8_t bytes[300];
static stream_t stream;
static tmini_ring_t ring;
static tmini_decoder_t decoder;
static tmini_point_t points[40];
static uint8_t ct_of_first_third;
static const tmini_scan_t *const scan = &decoder.builder.scan;

void setUp(void)
{
    ct_of_first_third = 0;
    memset(&decoder, 0xFF, sizeof decoder); /* As memory that was used before. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, sizeof memory, false));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_decoder_init(&decoder, &ring, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&decoder.builder, points, 40, 0));
}

void tearDown(void) {}

/* Third 0 is a start packet at 10 Hz, the others are a third of a turn. The packet came at `at_ms`,
 * or up to `late_ms` earlier. */
static bool come(unsigned third, uint32_t at_ms, uint16_t late_ms)
{
    const uint16_t first_q6 = (uint16_t)(third == 0 ? 0 : (third - 1) * 7680 + 64);
    const uint8_t ct = third == 1 ? ct_of_first_third : 0;

    stream = (stream_t){bytes, 0, sizeof bytes};
    (void)stream_add_packet(&stream, third == 0 ? 200 + 1 : ct, third == 0 ? 1 : 5, first_q6,
                            (uint16_t)(third == 0 ? 0 : third * 7680 % 23040));
    (void)tmini_ring_write(&ring, bytes, stream.size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, tmini_decoder_next(&decoder, 0));
    return tmini_decoder_take(&decoder, false, at_ms, late_ms);
}

/* A turn without its start packet, in 75 ms. */
static void rest_of_turn(uint32_t from_ms)
{
    for (unsigned third = 1; third <= 3; third++) {
        TEST_ASSERT_FALSE(come(third, from_ms + 25 * third, 0));
    }
}

void test_initialisation_clears_the_memory(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, tmini_decoder_next(&decoder, 0));
    TEST_ASSERT_FALSE(decoder.builder.open);
    TEST_ASSERT_EQUAL_UINT32(0, decoder.parser.counters.packets);
    TEST_ASSERT_EQUAL_UINT8(0, decoder.ct.known);
    TEST_ASSERT_EQUAL_UINT16(0, decoder.packet.first_angle_q6);
}

void test_the_packet_that_ends_a_scan_begins_the_next_at_its_own_time(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    rest_of_turn(70000);
    TEST_ASSERT_TRUE(come(0, 70100, 0));
    TEST_ASSERT_TRUE(scan->complete);
    decoder.builder.scan.upside_down = true; /* As tmini_mount_step() does. */
    rest_of_turn(70100);
    TEST_ASSERT_EQUAL_UINT32(70100, scan->start_ms);
    TEST_ASSERT_TRUE(come(0, 70200, 0));
    TEST_ASSERT_TRUE(scan->complete);
    TEST_ASSERT_FALSE(scan->upside_down);
    tmini_decoder_restart(&decoder); /* After a restart, the packet does not begin the next scan. */
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, tmini_decoder_next(&decoder, 0));
    TEST_ASSERT_FALSE(decoder.builder.open);
}

/* The limit of one and a half turns is 150 ms. */
void test_a_scan_that_may_have_begun_earlier_may_have_taken_too_long(void)
{
    for (uint16_t late_ms = 50; late_ms <= 51; late_ms++) {
        setUp();
        TEST_ASSERT_FALSE(come(0, 70000, late_ms));
        rest_of_turn(70000);
        TEST_ASSERT_TRUE(come(0, 70100, late_ms));
        TEST_ASSERT_EQUAL(late_ms == 50, scan->complete);
        rest_of_turn(70100);
        TEST_ASSERT_EQUAL_UINT32(70100, scan->start_ms);
        TEST_ASSERT_TRUE(come(0, 70200, 0));
        TEST_ASSERT_EQUAL(late_ms == 50, scan->complete);
        rest_of_turn(70200);
        TEST_ASSERT_TRUE(come(0, 70300, 0));
        TEST_ASSERT_TRUE(scan->complete);
    }
}

/* Delays of the other packets do not count. */
void test_a_scan_is_as_late_as_its_first_packet(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    for (unsigned third = 1; third <= 3; third++) {
        TEST_ASSERT_FALSE(come(third, 70000 + 25 * third, 90));
    }
    TEST_ASSERT_TRUE(come(0, 70100, 90));
    TEST_ASSERT_TRUE(scan->complete);
}

/* 300 is 44 in 8 bits. */
void test_a_scan_may_be_late_by_more_than_a_quarter_of_a_second(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 300));
    rest_of_turn(70000);
    TEST_ASSERT_TRUE(come(0, 70100, 0));
    TEST_ASSERT_FALSE(scan->complete);
}

/* Only start packets came, 1 ms more than one and a half turns apart. */
void test_a_scan_that_took_too_long_has_a_gap_though_no_byte_was_lost(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    TEST_ASSERT_TRUE(come(0, 70151, 0));
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
    TEST_ASSERT_EQUAL_UINT32(1, decoder.builder.late_scans);
}

/* 65,636 is 100 in 16 bits. */
void test_a_scan_of_more_than_a_minute_is_not_complete(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    rest_of_turn(70000);
    TEST_ASSERT_TRUE(come(0, 70000 + 65636, 0));
    TEST_ASSERT_FALSE(scan->complete);
}

/* ------------------------------------------------------------ packets from another decoder */

static tmini_decoder_t other;
static tmini_point_t others[40];

static void begin_other(void)
{
    other = (tmini_decoder_t){0};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&other.builder, others, 40, 0));
}

/* The packet comes to `decoder`, and is passed on to `other`. */
static bool hand_on(unsigned third, uint32_t at_ms)
{
    (void)come(third, at_ms, 0);
    const bool is_scan = tmini_decoder_take_packet(&other, &decoder.packet, at_ms);
    if (is_scan) {
        TEST_ASSERT_FALSE(tmini_builder_add(&other.builder, &decoder.packet, at_ms));
    }
    return is_scan;
}

static void hand_on_rest_of_turn(uint32_t from_ms)
{
    for (unsigned third = 1; third <= 3; third++) {
        TEST_ASSERT_FALSE(hand_on(third, from_ms + 25 * third));
    }
}

void test_packets_passed_on_make_the_same_scans(void)
{
    begin_other();
    TEST_ASSERT_FALSE(hand_on(0, 70000));
    hand_on_rest_of_turn(70000);
    TEST_ASSERT_EQUAL_UINT16(16, other.builder.scan.count);
    TEST_ASSERT_TRUE(hand_on(0, 70100));
    TEST_ASSERT_EQUAL_UINT16(1, other.builder.scan.count); /* The packet has begun the next scan. */
    hand_on_rest_of_turn(70100);
    TEST_ASSERT_TRUE(hand_on(0, 70200));
    TEST_ASSERT_EQUAL_UINT8(0, other.packet.gap);
    TEST_ASSERT_EQUAL_UINT8(201, other.packet.ct);
}

void test_a_doubtful_packet_passed_on_ends_the_scan(void)
{
    begin_other();
    TEST_ASSERT_FALSE(hand_on(0, 70000));
    TEST_ASSERT_FALSE(hand_on(1, 70025));
    (void)come(2, 70050, 0);
    tmini_packet_t packet = decoder.packet;
    packet.gap = TMINI_GAP_UNKNOWN;
    TEST_ASSERT_TRUE(tmini_decoder_take_packet(&other, &packet, 70050));
    TEST_ASSERT_EQUAL_UINT16(6, other.builder.scan.count);
}

/* The CT bytes 201, 2, 0 and 0 have the CRC 0xE5 (section 7, computed bit by bit). The LastCRC is
 * right, then wrong. */
void test_last_crc_judges_packets_passed_on(void)
{
    static const uint8_t last_crcs[2] = {0xE5, 0xE4};
    for (unsigned i = 0; i < 2; i++) {
        setUp();
        begin_other();
        ct_of_first_third = 2;
        TEST_ASSERT_FALSE(hand_on(0, 70000));
        hand_on_rest_of_turn(70000);
        (void)tmini_ring_write(&ring, &last_crcs[i], 1);
        (void)come(0, 70100, 0);
        TEST_ASSERT_TRUE(tmini_decoder_take_packet(&other, &decoder.packet, 70100));
        TEST_ASSERT_EQUAL_UINT8(i == 0 ? TMINI_CT_CONFIRMED : TMINI_CT_REFUTED, other.verdict);
        TEST_ASSERT_EQUAL(i == 0, other.builder.scan.complete);
    }
}

void test_without_a_builder_packets_passed_on_are_judged_too(void)
{
    other = (tmini_decoder_t){0};
    TEST_ASSERT_FALSE(hand_on(0, 70000));
    hand_on_rest_of_turn(70000);
    TEST_ASSERT_FALSE(hand_on(0, 70100));
    TEST_ASSERT_EQUAL_UINT8(201, other.packet.ct);
    TEST_ASSERT_FALSE(other.builder.open);
}
