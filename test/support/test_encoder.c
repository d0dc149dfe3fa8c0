/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compares the encoder with known bytes of the manual and of real units (docs/protocol.md). */

#include "encoder.h"
#include "known_packets.h"
#include "rows.h"

#include "unity.h"

#include <string.h>

static uint8_t out[ENCODE_OTHER_MAX];

/* The manual's packet: distances and flags worked out by hand from S2 and S3. */
static const encode_sample_t manual_samples[19] = {
    {11842, 1, 0}, {11819, 1, 0}, {11710, 1, 0}, {11618, 1, 0}, {11158, 1, 0},
    {10992, 1, 0}, {10881, 1, 0}, {10846, 1, 0}, {10829, 1, 0}, {11121, 1, 0},
    {11213, 1, 0}, {11166, 1, 0}, {11083, 1, 0}, {0, 1, 2},     {11096, 0, 2},
    {11096, 1, 0}, {11004, 1, 0}, {11106, 1, 0}, {11135, 1, 2}};

static encode_turn_t a_turn(void)
{
    encode_turn_t turn = {0};
    turn.frequency_dhz = 60;
    turn.user_major = 1;
    turn.user_minor = 3;
    turn.health = 0x22;
    turn.hardware = 1;
    turn.firmware_major = 2;
    turn.firmware_minor = 7;
    turn.year = 2025;
    turn.month = 4;
    turn.day = 24;
    turn.serial = 1193046; /* 10.010.00.1101000.1010110 in binary */
    return turn;
}

/* `out` has these bytes, in hexadecimal digits, which are as many as were encoded. */
static void expect_bytes(const char *digits, size_t encoded)
{
    uint8_t expected[32];
    TEST_ASSERT_EQUAL_size_t(row_bytes(digits, expected), encoded);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, out, encoded);
}

void setUp(void)
{
    memset(out, 0xEE, sizeof out);
}

void test_the_manuals_packet_is_encoded_byte_for_byte(void)
{
    const encode_packet_t packet = {0x20, 19, 21706, 49, manual_samples};
    TEST_ASSERT_EQUAL_size_t(67, encode_packet(out, &packet));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(manual_packet, out, 67);
}

void test_the_manuals_checksum_is_e85a(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xE85A, encode_checksum(manual_packet));
}

/* Worked out by hand: 300 mm (0x012C), intensity 5, flag 2, at 1 degree (0x0081). Of two bytes the
 * sample is 0x012C << 2 | 2. Checksums: 55AA ^ 0100 ^ 0081 ^ 0081 = 54AA; ^ 04B2 = 5018; and
 * 54AA ^ 0005 ^ 012C = 5583. */
void test_packets_of_other_units(void)
{
    const encode_sample_t sample = {300, 5, 2};
    const encode_packet_t packet = {0x00, 1, 64, 64, &sample};
    expect_bytes("AA550001810081001850B204", encode_other_packet(out, &packet, 2));
    expect_bytes("AA55000181008100835505002C01", encode_other_packet(out, &packet, 4));
}

void test_a_real_units_start_packet_is_encoded_byte_for_byte(void)
{
    const encode_sample_t sample = {149, 21, 0};
    const encode_packet_t packet = {0x75, 1, 31, 31, &sample};
    TEST_ASSERT_EQUAL_size_t(13, encode_packet(out, &packet));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(start_packet, out, 13);
}

void test_the_example_sample_of_section_5_is_64_e5_6f(void)
{
    encode_sample(out, (encode_sample_t){7161, 100, 1});
    expect_bytes("64E56F", 3);
}

void test_the_largest_sample_fills_all_its_bits(void)
{
    encode_sample(out, (encode_sample_t){16383, 255, 3});
    expect_bytes("FFFFFF", 3);
}

void test_an_angle_has_its_check_bit_set(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x0001, encode_angle(0));
    TEST_ASSERT_EQUAL_HEX16(0xA995, encode_angle(21706));
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, encode_angle(32767));
}

void test_sealing_makes_a_changed_packet_valid_again(void)
{
    uint8_t packet[] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F, 0x00, 0, 0, 0x14, 0x54, 0x02};
    encode_seal(packet);
    TEST_ASSERT_EQUAL_HEX8(0x9F, packet[8]);
    TEST_ASSERT_EQUAL_HEX8(0x56, packet[9]);
}

void test_a_packet_may_have_255_samples(void)
{
    static const encode_sample_t samples[255];
    const encode_packet_t packet = {0, 255, 0, 0, samples};
    TEST_ASSERT_EQUAL_size_t(775, encode_packet(out, &packet));
    TEST_ASSERT_EQUAL_HEX8(0xAA, out[8]); /* AA ^ CT 0 ^ 01 ^ 01 */
    TEST_ASSERT_EQUAL_HEX8(0xAA, out[9]); /* 55 ^ LSN FF */
}

void test_the_scan_reply_is_that_of_the_manual(void)
{
    expect_bytes("A55A0500004081", encode_scan_reply(out));
}

/* The reply of a real T-mini Plus: firmware 1.2 with the minor byte first, hardware 1. */
void test_device_information_is_a_real_units_reply(void)
{
    const encode_information_t information = {
        151, 1, 2, 1, {2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4}};
    expect_bytes("A55A14000000049702010102000205000402040000000900010904",
                 encode_information_reply(out, &information));
}

void test_health_has_status_and_a_little_endian_error_code(void)
{
    expect_bytes("A55A0300000006223412", encode_health_reply(out, 0x22, 0x1234));
}

void test_six_hertz_is_600_hundredths(void)
{
    expect_bytes("A55A040000000458020000", encode_frequency_reply(out, 600));
}

void test_a_reply_of_any_mode_and_length_can_be_made(void)
{
    expect_bytes("A55A563412C099", encode_reply(out, 3, 0x99, NULL, 0x123456));
}

void test_a_length_never_spills_into_the_mode(void)
{
    expect_bytes("A55AFFFFFF7F81", encode_reply(out, 1, 0x81, NULL, 0xFFFFFFFF));
}

void test_the_crc_of_123456789_is_a1(void)
{
    uint8_t crc = 0;
    for (uint8_t digit = '1'; digit <= '9'; digit++) {
        crc = encode_crc8(crc, digit);
    }
    TEST_ASSERT_EQUAL_HEX8(0xA1, crc);
}

void test_ct_bytes_follow_the_table_of_section_7(void)
{
    const encode_turn_t turn = a_turn();
    TEST_ASSERT_EQUAL_HEX8(0x79, encode_ct(&turn, 0)); /* 60 << 1 | 1 */
    TEST_ASSERT_EQUAL_HEX8(0x46, encode_ct(&turn, 1)); /* 1 << 6 | 3 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0x44, encode_ct(&turn, 3)); /* 0x22 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0x24, encode_ct(&turn, 4)); /* 1 << 5 | 2 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0x0E, encode_ct(&turn, 5)); /* 7 << 1 */
}

/* 1193046 = 0x123456: bits 20..19 are 2, 18..16 are 2, 15..14 are 0, 13..7 are 0x68, 6..0 0x56. */
void test_the_serial_number_is_spread_over_indices_9_to_13(void)
{
    const encode_turn_t turn = a_turn();
    TEST_ASSERT_EQUAL_HEX8(0x2C, encode_ct(&turn, 9));  /* 5 << 3 | 2 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0x44, encode_ct(&turn, 10)); /* 4 << 4 | 2 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0xC0, encode_ct(&turn, 11)); /* 24 << 3 | 0 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0xD0, encode_ct(&turn, 12)); /* 0x68 << 1 */
    TEST_ASSERT_EQUAL_HEX8(0xAC, encode_ct(&turn, 13)); /* 0x56 << 1 */
}

void test_only_index_0_has_bit_0_set(void)
{
    const encode_turn_t turn = a_turn();
    for (uint32_t index = 1; index < 300; index++) {
        TEST_ASSERT_EQUAL_HEX8(0, encode_ct(&turn, index) & 1u);
    }
}
