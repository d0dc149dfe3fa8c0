/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compares the encoder with known bytes of the manual and of real units (docs/protocol.md). */

#include "encoder.h"
#include "known_packets.h"
#include "rows.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static uint8_t out[ENCODE_OTHER_MAX];

/* The manual's packet: distances and flags worked out by hand from S2 and S3. */
static const encode_sample_t manual_samples[19] = {
    {11842, 1, 0}, {11819, 1, 0}, {11710, 1, 0}, {11618, 1, 0}, {11158, 1, 0},
    {10992, 1, 0}, {10881, 1, 0}, {10846, 1, 0}, {10829, 1, 0}, {11121, 1, 0},
    {11213, 1, 0}, {11166, 1, 0}, {11083, 1, 0}, {0, 1, 2},     {11096, 0, 2},
    {11096, 1, 0}, {11004, 1, 0}, {11106, 1, 0}, {11135, 1, 2}};

static const encode_turn_t turn = {.frequency_dhz = 60,
                                   .user_major = 1,
                                   .user_minor = 3,
                                   .health = 0x22,
                                   .hardware = 1,
                                   .firmware_major = 2,
                                   .firmware_minor = 7,
                                   .year = 2025,
                                   .month = 4,
                                   .day = 24,
                                   .serial = 1193046}; /* 10.010.00.1101000.1010110 in binary */

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

void test_a_real_units_start_packet_is_encoded_byte_for_byte(void)
{
    const encode_sample_t sample = {149, 21, 0};
    const encode_packet_t packet = {0x75, 1, 31, 31, &sample};
    TEST_ASSERT_EQUAL_size_t(13, encode_packet(out, &packet));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(start_packet, out, 13);
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

void test_the_crc_of_123456789_is_a1(void)
{
    uint8_t crc = 0;
    for (uint8_t digit = '1'; digit <= '9'; digit++) {
        crc = encode_crc8(crc, digit);
    }
    TEST_ASSERT_EQUAL_HEX8(0xA1, crc);
}

void test_only_index_0_has_bit_0_set(void)
{
    for (uint32_t index = 1; index < 300; index++) {
        TEST_ASSERT_EQUAL_HEX8(0, encode_ct(&turn, index) & 1u);
    }
}

/* ---- Rows: what is encoded, with numbers, and its bytes ---- */

/* Returns how many bytes there are. */
static size_t encode(const char *word, const uint32_t *n)
{
    static const encode_information_t information = {
        151, 1, 2, 1, {2, 0, 2, 5, 0, 4, 2, 4, 0, 0, 0, 9, 0, 1, 9, 4}};
    static const encode_sample_t sample = {300, 5, 2};
    static const encode_packet_t packet = {0x00, 1, 64, 64, &sample};
    if (row_is(word, "sample")) {
        encode_sample(out, (encode_sample_t){(uint16_t)n[0], (uint8_t)n[1], (uint8_t)n[2]});
        return 3;
    }
    if (row_is(word, "angle")) {
        encode_u16(out, encode_angle((uint16_t)n[0]));
        return 2;
    }
    if (row_is(word, "ct")) {
        out[0] = encode_ct(&turn, n[0]);
        return 1;
    }
    return row_is(word, "other")         ? encode_other_packet(out, &packet, (uint8_t)n[0])
           : row_is(word, "scan")        ? encode_scan_reply(out)
           : row_is(word, "information") ? encode_information_reply(out, &information)
           : row_is(word, "health")      ? encode_health_reply(out, (uint8_t)n[0], (uint16_t)n[1])
           : row_is(word, "frequency")   ? encode_frequency_reply(out, n[0])
           : row_is(word, "reply") ? encode_reply(out, (uint8_t)n[0], (uint8_t)n[1], NULL, n[2])
                                   : 0;
}

/* "name:1:2=AA55" */
static void tell(char *word)
{
    uint8_t expected[32];
    uint32_t numbers[3] = {0};
    char *digits = strchr(word, '=');
    char *at = word + strcspn(word, ":=");
    for (unsigned i = 0; i < 3 && *at == ':'; i++) {
        numbers[i] = (uint32_t)strtoul(at + 1, &at, 0);
    }
    *digits = '\0';
    const size_t size = row_bytes(digits + 1, expected);
    TEST_ASSERT_EQUAL_size_t_MESSAGE(size, encode(word, numbers), word);
    TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(expected, out, size, word);
}

static const row_t rows[] IN_FLASH = {
    /* Worked out by hand: 300 mm (0x012C), intensity 5, flag 2, at 1 degree (0x0081). Of two bytes
     * the sample is 0x012C << 2 | 2. Checksums: 55AA ^ 0100 ^ 0081 ^ 0081 = 54AA; ^ 04B2 = 5018;
     * and 54AA ^ 0005 ^ 012C = 5583. */
    ROW(packets_of_other_units_have_other_samples,
        "other:2=AA550001810081001850B204 other:4=AA55000181008100835505002C01"),
    ROW(the_example_sample_of_section_5_is_64_e5_6f, "sample:7161:100:1=64E56F"),
    ROW(the_largest_sample_fills_all_its_bits, "sample:16383:255:3=FFFFFF"),
    ROW(an_angle_has_its_check_bit_set, "angle:0=0100 angle:21706=95A9 angle:32767=FFFF"),
    ROW(the_scan_reply_is_that_of_the_manual, "scan=A55A0500004081"),
    /* The reply of a real T-mini Plus: firmware 1.2 with the minor byte first, hardware 1. */
    ROW(device_information_is_a_real_units_reply,
        "information=A55A14000000049702010102000205000402040000000900010904"),
    ROW(health_has_status_and_a_little_endian_error_code,
        "health:0x22:0x1234=A55A0300000006223412"),
    ROW(six_hertz_is_600_hundredths, "frequency:600=A55A040000000458020000"),
    ROW(a_reply_of_any_mode_and_length_can_be_made, "reply:3:0x99:0x123456=A55A563412C099"),
    ROW(a_length_never_spills_into_the_mode, "reply:1:0x81:0xFFFFFFFF=A55AFFFFFF7F81"),
    /* 60 << 1 | 1; 1 << 6 | 3 << 1; 0x22 << 1; 1 << 5 | 2 << 1; 7 << 1. */
    ROW(ct_bytes_follow_the_table_of_section_7, "ct:0=79 ct:1=46 ct:3=44 ct:4=24 ct:5=0E"),
    /* 1193046 = 0x123456: bits 20..19 are 2, 18..16 are 2, 15..14 are 0, 13..7 are 0x68, 6..0 0x56.
     * 5 << 3 | 2 << 1; 4 << 4 | 2 << 1; 24 << 3 | 0 << 1; 0x68 << 1; 0x56 << 1. */
    ROW(the_serial_number_is_spread_over_indices_9_to_13,
        "ct:9=2C ct:10=44 ct:11=C0 ct:12=D0 ct:13=AC"),
};

void test_rows(void)
{
    tell_rows(rows, tell);
}
