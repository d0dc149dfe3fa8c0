/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Bytes to packets and scans: what the decoder adds to parser, CT information and builder. */

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
static const tmini_scan_t *const scan = &decoder.builder.scan;

void setUp(void)
{
    memset(&decoder, 0xFF, sizeof decoder); /* Whatever it was. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, sizeof memory, false));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_decoder_init(&decoder, &ring, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&decoder.builder, points, 40, 0));
}

void tearDown(void) {}

/* A start packet at 10 Hz, or a third of a turn; it came then, or so much earlier. */
static bool come(unsigned third, uint32_t at_ms, uint16_t late_ms)
{
    const uint16_t first_q6 = (uint16_t)(third == 0 ? 0 : (third - 1) * 7680 + 64);

    stream = (stream_t){bytes, 0, sizeof bytes};
    (void)stream_add_packet(&stream, third == 0 ? 200 + 1 : 0, third == 0 ? 1 : 5, first_q6,
                            (uint16_t)(third == 0 ? 0 : third * 7680 % 23040));
    (void)tmini_ring_write(&ring, bytes, stream.size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, tmini_decoder_next(&decoder, 0));
    return tmini_decoder_take(&decoder, false, at_ms, late_ms);
}

/* All of a turn but its start packet, in 80 ms. */
static void rest_of_turn(uint32_t from_ms)
{
    for (unsigned third = 1; third <= 3; third++) {
        TEST_ASSERT_FALSE(come(third, from_ms + 25 * third, 0));
    }
}

void test_nothing_is_left_of_what_was_in_its_memory(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, tmini_decoder_next(&decoder, 0));
    TEST_ASSERT_FALSE(decoder.builder.open);
    TEST_ASSERT_EQUAL_UINT32(0, decoder.parser.counters.packets);
    TEST_ASSERT_EQUAL_UINT8(0, decoder.ct.known);
}

void test_the_packet_that_ends_a_scan_begins_the_next_at_its_own_time(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    rest_of_turn(70000);
    TEST_ASSERT_TRUE(come(0, 70100, 0));
    TEST_ASSERT_TRUE(scan->complete);
    rest_of_turn(70100);
    TEST_ASSERT_EQUAL_UINT32(70100, scan->start_ms);
    TEST_ASSERT_TRUE(come(0, 70200, 0));
    TEST_ASSERT_TRUE(scan->complete);
}

/* One and a half turns are 150 ms. */
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

/* Each packet but the first of a scan: that is no delay of the scan. */
void test_a_scan_is_as_late_as_its_first_packet(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    for (unsigned third = 1; third <= 3; third++) {
        TEST_ASSERT_FALSE(come(third, 70000 + 25 * third, 90));
    }
    TEST_ASSERT_TRUE(come(0, 70100, 90));
    TEST_ASSERT_TRUE(scan->complete);
}

/* 300 ms: 44 in 8 bits. */
void test_a_scan_may_be_late_by_more_than_a_quarter_of_a_second(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 300));
    rest_of_turn(70000);
    TEST_ASSERT_TRUE(come(0, 70100, 0));
    TEST_ASSERT_FALSE(scan->complete);
}

/* Nothing of its turn came but the start packet, and the next one's two turns later. */
void test_a_scan_that_took_too_long_has_a_gap_though_no_byte_was_lost(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    TEST_ASSERT_TRUE(come(0, 70151, 0));
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
    TEST_ASSERT_EQUAL_UINT32(1, decoder.builder.late_scans);
}

/* 65,636 ms: 100 in 16 bits. */
void test_a_scan_of_more_than_a_minute_is_not_complete(void)
{
    TEST_ASSERT_FALSE(come(0, 70000, 0));
    rest_of_turn(70000);
    TEST_ASSERT_TRUE(come(0, 70000 + 65636, 0));
    TEST_ASSERT_FALSE(scan->complete);
}
