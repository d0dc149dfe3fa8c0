/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The reference decoder on byte sequences worked out by hand. */

#include "corrupt.h"
#include "encoder.h"
#include "reference_decoder.h"

#include "unity.h"

#include <string.h>

/* Section 5: the manual's packet. */
static const uint8_t manual_packet[67] = {
    0xAA, 0x55, 0x20, 0x13, 0x95, 0xA9, 0x63, 0x00, 0x5A, 0xE8, 0x01, 0x08, 0xB9, 0x01,
    0xAC, 0xB8, 0x01, 0xF8, 0xB6, 0x01, 0x88, 0xB5, 0x01, 0x58, 0xAE, 0x01, 0xC0, 0xAB,
    0x01, 0x04, 0xAA, 0x01, 0x78, 0xA9, 0x01, 0x34, 0xA9, 0x01, 0xC4, 0xAD, 0x01, 0x34,
    0xAF, 0x01, 0x78, 0xAE, 0x01, 0x2C, 0xAD, 0x01, 0x02, 0x00, 0x00, 0x62, 0xAD, 0x01,
    0x60, 0xAD, 0x01, 0xF0, 0xAB, 0x01, 0x88, 0xAD, 0x01, 0xFE, 0xAD};

/* Section 9.14: a start packet of a real unit. */
static const uint8_t start_packet[13] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                                         0x00, 0x9E, 0x56, 0x15, 0x54, 0x02};

static const uint8_t frequency_reply[11] = {0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00,
                                            0x04, 0x58, 0x02, 0x00, 0x00};
static const uint8_t scan_reply[7] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};

static uint8_t bytes[400];
static size_t size;
static reference_options_t options;
static reference_item_t items[20];
static size_t item_count;

static void add(const uint8_t *more, size_t count)
{
    memcpy(bytes + size, more, count);
    size += count;
}

static void add_byte(uint8_t byte)
{
    add(&byte, 1);
}

static void record(void *context, const reference_item_t *item)
{
    (void)context;
    items[item_count++] = *item;
}

static reference_counts_t decode(void)
{
    return reference_decode(bytes, size, &options, record, NULL);
}

static void expect_item(size_t index, bool is_packet, size_t offset, size_t length)
{
    TEST_ASSERT_TRUE(index < item_count);
    TEST_ASSERT_EQUAL(is_packet, items[index].is_packet);
    TEST_ASSERT_EQUAL_size_t(offset, items[index].offset);
    TEST_ASSERT_EQUAL_size_t(length, items[index].length);
    TEST_ASSERT_EQUAL_PTR(bytes + offset, items[index].bytes);
}

void setUp(void)
{
    size = 0;
    item_count = 0;
    options.max_samples = 80;
    options.awaited = NULL;
}

void tearDown(void) {}

void test_an_empty_array_holds_nothing(void)
{
    const reference_counts_t counts = decode();
    const reference_counts_t nothing = {0};

    TEST_ASSERT_EQUAL_MEMORY(&nothing, &counts, sizeof counts);
}

void test_the_manuals_packet_is_found_with_its_header_fields(void)
{
    add(manual_packet, 67);
    decode();
    TEST_ASSERT_EQUAL_size_t(1, item_count);
    expect_item(0, true, 0, 67);
    TEST_ASSERT_EQUAL_HEX8(0x20, items[0].ct);
    TEST_ASSERT_EQUAL_UINT8(19, items[0].lsn);
    TEST_ASSERT_EQUAL_HEX16(0xA995, items[0].fsa);
    TEST_ASSERT_EQUAL_HEX16(0x0063, items[0].lsa);
    TEST_ASSERT_FALSE(items[0].starts_revolution);
}

void test_packets_in_a_row_are_all_found_and_counted(void)
{
    reference_counts_t counts;

    add(manual_packet, 67);
    add_byte(0x42); /* LastCRC */
    add(start_packet, 13);
    add(manual_packet, 67);
    counts = decode();
    TEST_ASSERT_EQUAL_size_t(3, item_count);
    expect_item(1, true, 68, 13);
    expect_item(2, true, 81, 67);
    TEST_ASSERT_TRUE(items[1].starts_revolution);
    TEST_ASSERT_EQUAL_UINT64(3, counts.packets);
    TEST_ASSERT_EQUAL_UINT64(1, counts.start_packets);
    TEST_ASSERT_EQUAL_UINT64(39, counts.points);
    TEST_ASSERT_EQUAL_UINT64(0, counts.checksum_errors);
    TEST_ASSERT_EQUAL_UINT64(148, counts.bytes);
    TEST_ASSERT_EQUAL_UINT64(147, counts.bytes_in_packets);
    TEST_ASSERT_EQUAL_UINT64(0, counts.bytes_in_replies);
    TEST_ASSERT_EQUAL_UINT64(1, counts.bytes_skipped);
}

void test_a_last_crc_of_aa_does_not_hide_the_start_packet(void)
{
    add_byte(0xAA);
    add(start_packet, 13);
    decode();
    expect_item(0, true, 1, 13);
}

void test_a_wrong_checksum_costs_one_byte_not_the_declared_length(void)
{
    reference_counts_t counts;

    add(manual_packet, 67);
    bytes[2] = 0x22;
    size = 40; /* the rest was lost, and a good packet follows inside the declared length */
    add(start_packet, 13);
    add(manual_packet, 67);
    counts = decode();
    TEST_ASSERT_EQUAL_size_t(2, item_count);
    expect_item(0, true, 40, 13);
    expect_item(1, true, 53, 67);
    TEST_ASSERT_EQUAL_UINT64(1, counts.checksum_errors);
    TEST_ASSERT_EQUAL_UINT64(40, counts.bytes_skipped);
}

void test_an_incomplete_candidate_at_the_end_is_searched_byte_by_byte(void)
{
    reference_counts_t counts;

    add(manual_packet, 20);
    add(start_packet, 13);
    counts = decode();
    TEST_ASSERT_EQUAL_size_t(1, item_count);
    expect_item(0, true, 20, 13);
    TEST_ASSERT_EQUAL_UINT64(0, counts.checksum_errors);
    TEST_ASSERT_EQUAL_UINT64(20, counts.bytes_skipped);
}

static void expect_rejected_without_checksum_error(void)
{
    const reference_counts_t counts = decode();

    TEST_ASSERT_EQUAL_UINT64(0, counts.packets);
    TEST_ASSERT_EQUAL_UINT64(0, counts.checksum_errors);
    TEST_ASSERT_EQUAL_UINT64(size, counts.bytes_skipped);
}

void test_lsn_0_is_no_packet(void)
{
    static const uint8_t packet[] = {0xAA, 0x55, 0x00, 0x00, 0x01, 0x00, 0x01, 0x00, 0xAA, 0x55};

    add(packet, sizeof packet);
    expect_rejected_without_checksum_error();
}

void test_an_lsn_beyond_the_limit_is_no_packet(void)
{
    add(manual_packet, 67);
    options.max_samples = 18;
    expect_rejected_without_checksum_error();
}

void test_an_lsn_at_the_limit_is_a_packet(void)
{
    add(manual_packet, 67);
    options.max_samples = 19;
    decode();
    expect_item(0, true, 0, 67);
}

void test_a_check_bit_of_0_is_no_packet_even_with_a_right_checksum(void)
{
    add(start_packet, 13);
    bytes[4] = 0x3E;
    bytes[8] = 0x9F;
    expect_rejected_without_checksum_error();
    bytes[4] = 0x3F;
    bytes[6] = 0x3E;
    expect_rejected_without_checksum_error();
}

void test_a_start_packet_of_two_samples_is_no_packet_even_with_a_right_checksum(void)
{
    static const uint8_t packet[] = {0xAA, 0x55, 0x75, 0x02, 0x3F, 0x00, 0x3F, 0x00,
                                     0xDF, 0x57, 0,    0,    0,    0,    0,    0};

    TEST_ASSERT_EQUAL_HEX16(0x57DF, encode_checksum(packet));
    add(packet, sizeof packet);
    expect_rejected_without_checksum_error();
}

void test_a_point_packet_of_one_sample_is_a_packet(void)
{
    add(start_packet, 13);
    bytes[2] = 0x74;
    bytes[8] = 0x9F;
    decode();
    TEST_ASSERT_EQUAL_size_t(1, item_count);
    TEST_ASSERT_FALSE(items[0].starts_revolution);
}

void test_a_reply_that_is_not_awaited_is_skipped(void)
{
    reference_counts_t counts;

    add(frequency_reply, 11);
    counts = decode();
    TEST_ASSERT_EQUAL_UINT64(0, counts.replies);
    TEST_ASSERT_EQUAL_UINT64(11, counts.bytes_skipped);
}

void test_the_awaited_reply_is_delivered_once(void)
{
    static const reference_reply_t awaited = {0, 0x04, 4};
    reference_counts_t counts;

    options.awaited = &awaited;
    add_byte(0xA5);
    add(frequency_reply, 11);
    add(frequency_reply, 11);
    counts = decode();
    TEST_ASSERT_EQUAL_size_t(1, item_count);
    expect_item(0, false, 1, 11);
    TEST_ASSERT_EQUAL_UINT64(1, counts.replies);
    TEST_ASSERT_EQUAL_UINT64(11, counts.bytes_in_replies);
    TEST_ASSERT_EQUAL_UINT64(12, counts.bytes_skipped);
}

static void expect_not_taken(reference_reply_t awaited)
{
    options.awaited = &awaited;
    TEST_ASSERT_EQUAL_UINT64(0, decode().replies);
}

void test_a_reply_of_another_mode_type_or_length_is_not_taken(void)
{
    static const reference_reply_t other_length = {0, 0x04, 20};
    static const reference_reply_t other_type = {0, 0x06, 4};
    static const reference_reply_t other_mode = {1, 0x04, 4};

    add(frequency_reply, 11);
    expect_not_taken(other_length);
    expect_not_taken(other_type);
    expect_not_taken(other_mode);
}

void test_an_incomplete_reply_is_not_taken(void)
{
    static const reference_reply_t awaited = {0, 0x04, 4};

    add(frequency_reply, 10);
    expect_not_taken(awaited);
}

void test_the_length_of_a_continuous_reply_is_ignored(void)
{
    static const reference_reply_t awaited = {1, 0x81, 99};

    options.awaited = &awaited;
    add(scan_reply, 7);
    add(start_packet, 13);
    decode();
    TEST_ASSERT_EQUAL_size_t(2, item_count);
    expect_item(0, false, 0, 7);
    expect_item(1, true, 7, 13);
}

void test_a_packet_inside_a_reply_that_is_not_awaited_is_found(void)
{
    static const uint8_t header[] = {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04};

    add(header, 7);
    add(start_packet, 13);
    decode();
    expect_item(0, true, 7, 13);
}

/* 339.15625 degrees are 21706/64, 0.765625 are 49/64: 1383/64 clockwise in 18 steps. */
void test_the_manuals_angles_wrap_past_360_degrees(void)
{
    TEST_ASSERT_EQUAL_UINT16(21706, reference_point(manual_packet, 0).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(21783, reference_point(manual_packet, 1).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(23012, reference_point(manual_packet, 17).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(49, reference_point(manual_packet, 18).angle_q6);
}

/* 21706 + 9 * 1383 / 18 = 22397.5. */
void test_halves_are_rounded_up(void)
{
    TEST_ASSERT_EQUAL_UINT16(22398, reference_point(manual_packet, 9).angle_q6);
}

void test_the_manuals_samples_have_their_distances_intensities_and_flags(void)
{
    TEST_ASSERT_EQUAL_UINT16(11842, reference_point(manual_packet, 0).distance_mm);
    TEST_ASSERT_EQUAL_UINT16(11135, reference_point(manual_packet, 18).distance_mm);
    TEST_ASSERT_EQUAL_UINT8(1, reference_point(manual_packet, 0).intensity);
    TEST_ASSERT_EQUAL_UINT8(0, reference_point(manual_packet, 14).intensity);
    TEST_ASSERT_EQUAL_UINT8(0, reference_point(manual_packet, 0).flag);
    TEST_ASSERT_EQUAL_UINT8(2, reference_point(manual_packet, 13).flag);
    TEST_ASSERT_EQUAL_UINT8(2, reference_point(manual_packet, 18).flag);
}

/* Section 9.6: FSA 0.266 degrees, LSA 0.156 degrees, one sample. */
void test_the_angle_of_a_lone_sample_is_fsa(void)
{
    static const uint8_t packet[13] = {0xAA, 0x55, 0x00, 0x01, 0x23, 0x00, 0x15};

    TEST_ASSERT_EQUAL_UINT16(17, reference_point(packet, 0).angle_q6);
}

/* FSA 0xB401 is 23040/64 = 360 degrees, LSA 0xB40D is 360.09375 degrees. */
void test_angles_of_360_degrees_and_more_are_reduced(void)
{
    static const uint8_t packet[] = {0xAA, 0x55, 0x00, 0x03, 0x01, 0xB4, 0x0D, 0xB4, 0, 0,
                                     0,    0,    0,    0,    0,    0,    0,    0,    0};

    TEST_ASSERT_EQUAL_UINT16(0, reference_point(packet, 0).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(3, reference_point(packet, 1).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(6, reference_point(packet, 2).angle_q6);
}

/* FSA 359.984375, LSA 0: the middle is 23039.5, which rounds to 23040, which is 0. */
void test_rounding_up_to_360_degrees_gives_0(void)
{
    static const uint8_t packet[] = {0xAA, 0x55, 0x00, 0x03, 0xFF, 0xB3, 0x01, 0x00, 0, 0,
                                     0,    0,    0,    0,    0,    0,    0,    0,    0};

    TEST_ASSERT_EQUAL_UINT16(23039, reference_point(packet, 0).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(0, reference_point(packet, 1).angle_q6);
    TEST_ASSERT_EQUAL_UINT16(0, reference_point(packet, 2).angle_q6);
}

void test_every_byte_is_accounted_for_whatever_the_damage(void)
{
    random_t random;

    for (uint64_t seed = 0; seed < 2000; seed++) {
        reference_counts_t counts;

        random_seed(&random, seed);
        size = 0;
        add(manual_packet, 67);
        add(start_packet, 13);
        add(manual_packet, 67);
        size = corrupt_some(&random, (unsigned)(seed % 8u), bytes, size, sizeof bytes);
        TEST_ASSERT_TRUE(size <= sizeof bytes);
        counts = reference_decode(bytes, size, &options, NULL, NULL);
        TEST_ASSERT_EQUAL_UINT64(counts.bytes, counts.bytes_in_packets + counts.bytes_skipped);
    }
}
