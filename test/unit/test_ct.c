/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* CT information: the content of a revolution's CT bytes, and when it is trusted (section 7). */

#include "tmini/parts/tmini_reply.h"
#include "tmini/parts/tmini_ct.h"

#include "unity.h"

#include <string.h>

static tmini_ct_t ct_state;
static tmini_ct_info_t info;
static bool is_whole; /* Nothing lost since the last start packet. */

/* 17 packets at 6.0 Hz, worked out by hand from the table: user version 1.0, faults encoder and LD,
 * hardware 1, firmware 2.7, 2025-04-24, number 1193046 = 10 010 00 1101000 1010110 in binary. */
static const uint8_t six_hertz[17] = {0x79, 0x40, 0x34, 0x24, 0x24, 0x0E, 0x12, 0x56, 0x9A,
                                      0x2C, 0x44, 0xC0, 0xD0, 0xAC, 0x10, 0x20, 0x30};
/* Their CRC-8/MAXIM. All CRCs in this file were computed by a separate program. */
#define SIX_HERTZ_CRC 0xD8

/* The same unit at 10 Hz (11 packets) and at 12 Hz (10). */
#define TEN_HERTZ_CT 0xC9
#define TEN_HERTZ_CRC 0xDD
#define TWELVE_HERTZ_CT 0xF1
#define TWELVE_HERTZ_CRC 0xB0

void setUp(void)
{
    memset(&ct_state, 0xEE, sizeof ct_state);
    memset(&info, 0xEE, sizeof info);
    tmini_ct_init(&ct_state);
    is_whole = false;
}

void tearDown(void) {}

/* Adds a packet with `gap` skipped bytes before it; `skipped` is the last of them. What is whole is
 * decided here as the protocol says (section 7), for start packets and others. */
static tmini_ct_verdict_t verdict_on(uint8_t ct, uint16_t gap, uint8_t skipped)
{
    const tmini_frame_t frame = {.gap = gap, .last_skipped = skipped};
    const tmini_packet_t packet = {.ct = ct, .count = 1, .gap = gap, .frame = &frame};
    is_whole = (ct & 1u) != 0 || (is_whole && gap == 0);
    return tmini_ct_add(&ct_state, &packet, is_whole);
}

static void discard(void)
{
    tmini_ct_discard(&ct_state);
    is_whole = false;
}

static bool add(uint8_t ct, uint16_t gap, uint8_t skipped)
{
    return verdict_on(ct, gap, skipped) == TMINI_CT_CONFIRMED;
}

/* Point packets without skipped bytes before them; 0xD8 was skipped earlier. */
static void add_points(const uint8_t *cts, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_FALSE(add(cts[i], 0, 0xD8));
    }
}

/* A revolution from its start packet on. */
static void add_revolution(uint8_t start_ct, const uint8_t *point_cts, size_t points)
{
    (void)add(start_ct, 0, 0);
    add_points(point_cts, points);
}

static void add_six_hertz(void)
{
    add_revolution(0x79, &six_hertz[1], 16);
}

/* The next start packet, with this LastCRC before it. */
static bool end_with(uint8_t last_crc)
{
    return add(0x79, 1, last_crc);
}

static void expect_nothing_known(void)
{
    const tmini_ct_info_t nothing = {0};
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_UINT16(nothing.known, info.known);
    TEST_ASSERT_EQUAL_UINT8(0, info.user_major);
    TEST_ASSERT_EQUAL_UINT8(0, info.user_minor);
    TEST_ASSERT_EQUAL_UINT8(0, info.faults);
    TEST_ASSERT_EQUAL_UINT8(0, info.hardware);
    TEST_ASSERT_EQUAL_UINT8(0, info.firmware_major);
    TEST_ASSERT_EQUAL_UINT8(0, info.firmware_minor);
    TEST_ASSERT_EQUAL_UINT8(0, info.month);
    TEST_ASSERT_EQUAL_UINT8(0, info.day);
    TEST_ASSERT_EQUAL_UINT16(0, info.year);
    TEST_ASSERT_EQUAL_UINT32(0, info.number);
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULTS_UNKNOWN, tmini_ct_faults(&ct_state));
}

static void expect_serial(uint16_t year, uint8_t month, uint8_t day, uint32_t number)
{
    TEST_ASSERT_EQUAL_UINT16(year, info.year);
    TEST_ASSERT_EQUAL_UINT8(month, info.month);
    TEST_ASSERT_EQUAL_UINT8(day, info.day);
    TEST_ASSERT_EQUAL_UINT32(number, info.number);
}

static void expect_versions_and_faults(uint8_t faults)
{
    TEST_ASSERT_EQUAL_UINT8(1, info.user_major);
    TEST_ASSERT_EQUAL_UINT8(0, info.user_minor);
    TEST_ASSERT_EQUAL_HEX8(faults, info.faults);
    TEST_ASSERT_EQUAL_UINT(faults, tmini_ct_faults(&ct_state));
    TEST_ASSERT_EQUAL_UINT8(1, info.hardware);
    TEST_ASSERT_EQUAL_UINT8(2, info.firmware_major);
    TEST_ASSERT_EQUAL_UINT8(7, info.firmware_minor);
}

/* --------------------------------------------------------------------------------------- fields */

void test_the_crc_of_123456789_is_a1(void)
{
    static const uint8_t digits[9] = "123456789";
    uint8_t crc = 0;
    for (unsigned i = 0; i < 9; i++) {
        crc = tmini_ct_crc8(crc, digits[i]);
    }
    TEST_ASSERT_EQUAL_HEX8(0xA1, crc);
}

void test_before_the_first_packet_nothing_is_known(void)
{
    expect_nothing_known();
}

void test_a_revolution_at_6_hz_reports_everything(void)
{
    add_six_hertz();
    expect_nothing_known();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_HEX16(0x2E3A, info.known); /* Bits 1, 3, 4, 5, 9, 10, 11 and 13. */
    expect_versions_and_faults(TMINI_FAULT_ENCODER | TMINI_FAULT_LD);
    expect_serial(2025, 4, 24, 1193046);
}

void test_a_revolution_at_10_hz_does_not_show_day_and_number(void)
{
    add_revolution(TEN_HERTZ_CT, &six_hertz[1], 10);
    TEST_ASSERT_TRUE(end_with(TEN_HERTZ_CRC));
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE |
                                TMINI_KNOWN_FIRMWARE | TMINI_KNOWN_YEAR | TMINI_KNOWN_MONTH,
                            info.known);
    expect_versions_and_faults(TMINI_FAULT_ENCODER | TMINI_FAULT_LD);
    expect_serial(2025, 4, 0, 0);
}

void test_a_revolution_at_12_hz_does_not_show_month_day_and_number(void)
{
    add_revolution(TWELVE_HERTZ_CT, &six_hertz[1], 9);
    TEST_ASSERT_TRUE(end_with(TWELVE_HERTZ_CRC));
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE |
                                TMINI_KNOWN_FIRMWARE | TMINI_KNOWN_YEAR,
                            info.known);
    TEST_ASSERT_EQUAL_UINT16(2025, info.year);
    TEST_ASSERT_EQUAL_UINT8(0, info.month);
}

/* The fields that are known after a revolution of `count` packets. */
static uint16_t known_after(size_t count, uint8_t last_crc)
{
    tmini_ct_init(&ct_state);
    add_revolution(0x79, &six_hertz[1], count - 1);
    TEST_ASSERT_TRUE(end_with(last_crc));
    tmini_ct_read(&ct_state, &info);
    return info.known;
}

void test_a_field_is_known_when_the_packet_that_completes_it_has_come(void)
{
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION, known_after(2, 0x42));
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION, known_after(3, 0x25));
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULTS_UNKNOWN, tmini_ct_faults(&ct_state));
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS, known_after(4, 0x5E));
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULT_ENCODER | TMINI_FAULT_LD, tmini_ct_faults(&ct_state));
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER | TMINI_FAULT_LD, info.faults);
    TEST_ASSERT_EQUAL_UINT8(0, info.hardware);
    TEST_ASSERT_EQUAL_HEX16(TMINI_KNOWN_USER_VERSION | TMINI_KNOWN_FAULTS | TMINI_KNOWN_HARDWARE |
                                TMINI_KNOWN_FIRMWARE,
                            known_after(9, 0x72));
    TEST_ASSERT_EQUAL_UINT16(0, info.year);
}

void test_the_largest_values_fit_their_fields(void)
{
    uint8_t cts[13];
    memset(cts, 0xFE, sizeof cts);
    add_revolution(0xFF, cts, 13);
    TEST_ASSERT_TRUE(end_with(0x51));
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_UINT8(3, info.user_major);
    TEST_ASSERT_EQUAL_UINT8(31, info.user_minor);
    TEST_ASSERT_EQUAL_HEX8(0x3F, info.faults); /* The reserved bit is left out. */
    TEST_ASSERT_EQUAL_UINT(0x3F, tmini_ct_faults(&ct_state));
    TEST_ASSERT_EQUAL_UINT8(7, info.hardware);
    TEST_ASSERT_EQUAL_UINT8(15, info.firmware_major);
    TEST_ASSERT_EQUAL_UINT8(127, info.firmware_minor);
    expect_serial(2051, 15, 31, 2097151);
}

/* The number's 21 bits are 01 101 10 0110101 0101011: 891563. */
void test_each_bit_of_the_serial_number_has_its_place(void)
{
    uint8_t crc = tmini_ct_crc8(0, 0x79);
    uint8_t cts[16] = {0};
    cts[8] = 6 << 3 | 1 << 1;
    cts[9] = 12 << 4 | 5 << 1;
    cts[10] = 31 << 3 | 2 << 1;
    cts[11] = 0x35 << 1;
    cts[12] = 0x2B << 1;
    for (unsigned i = 0; i < 16; i++) {
        crc = tmini_ct_crc8(crc, cts[i]);
    }
    add_revolution(0x79, cts, 16);
    TEST_ASSERT_TRUE(end_with(crc));
    tmini_ct_read(&ct_state, &info);
    expect_serial(2026, 12, 31, 891563);
}

void test_a_healthy_lidar_is_known_to_have_no_faults(void)
{
    uint8_t cts[17];
    memcpy(cts, six_hertz, 17);
    cts[3] = 0;
    add_revolution(0x79, &cts[1], 16);
    TEST_ASSERT_TRUE(end_with(0x95));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ct_faults(&ct_state));
}

/* ---------------------------------------------------------------------------------------- trust */

void test_a_last_crc_of_aa_is_like_any_other(void)
{
    uint8_t cts[17];
    memcpy(cts, six_hertz, 17);
    cts[16] = 0x96; /* Makes the CRC 0xAA. */
    add_revolution(0x79, &cts[1], 16);
    TEST_ASSERT_TRUE(end_with(0xAA));
}

void test_every_wrong_last_crc_drops_the_revolution(void)
{
    for (unsigned crc = 0; crc <= 255; crc++) {
        if (crc != SIX_HERTZ_CRC) {
            tmini_ct_init(&ct_state);
            add_six_hertz();
            TEST_ASSERT_FALSE(end_with((uint8_t)crc));
            expect_nothing_known();
        }
    }
}

void test_without_last_crc_nothing_is_trusted(void)
{
    add_six_hertz();
    /* An earlier stray byte has the same value by chance. */
    TEST_ASSERT_FALSE(add(0x79, 0, SIX_HERTZ_CRC));
    expect_nothing_known();
}

void test_more_than_one_stray_byte_is_no_last_crc(void)
{
    add_six_hertz();
    TEST_ASSERT_FALSE(add(0x79, 2, SIX_HERTZ_CRC));
    add_six_hertz();
    TEST_ASSERT_FALSE(add(0x79, 65535, SIX_HERTZ_CRC));
    expect_nothing_known();
}

/* Section 9.1: no CT information in point packets, no LastCRC, but sometimes a byte of noise. */
void test_a_unit_without_ct_information_never_becomes_healthy(void)
{
    static const uint8_t zeros[16] = {0};
    for (unsigned noise = 0; noise <= 255; noise++) {
        add_points(zeros, 16);
        TEST_ASSERT_FALSE(add(0x79, 1, (uint8_t)noise)); /* 0x32 would be the CRC. */
    }
    expect_nothing_known();
}

void test_ct_information_that_stops_coming_confirms_nothing_sent_before(void)
{
    static const uint8_t zeros[16] = {0};
    add_six_hertz();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
    add_points(zeros, 16);
    TEST_ASSERT_FALSE(end_with(0x32)); /* By chance the right CRC. */
    TEST_ASSERT_EQUAL_UINT(0x12, tmini_ct_faults(&ct_state));
}

void test_one_point_packet_with_information_is_enough(void)
{
    uint8_t cts[16] = {0};
    uint8_t crc = tmini_ct_crc8(0, 0x79);
    cts[15] = 0x02;
    for (unsigned i = 0; i < 16; i++) {
        crc = tmini_ct_crc8(crc, cts[i]);
    }
    add_revolution(0x79, cts, 16);
    TEST_ASSERT_TRUE(end_with(crc));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ct_faults(&ct_state));
}

void test_bytes_lost_or_skipped_inside_a_revolution_spoil_it(void)
{
    for (size_t hit = 1; hit < 17; hit++) {
        tmini_ct_init(&ct_state);
        (void)add(0x79, 0, 0);
        for (size_t i = 1; i < 17; i++) {
            (void)add(six_hertz[i], i == hit ? 1 : 0, 0);
        }
        TEST_ASSERT_FALSE(end_with(SIX_HERTZ_CRC));
        expect_nothing_known();
    }
}

void test_a_lost_packet_drops_the_revolution(void)
{
    add_revolution(0x79, &six_hertz[1], 6);
    add_points(&six_hertz[8], 9); /* The eighth is lost with all its bytes. */
    TEST_ASSERT_FALSE(end_with(SIX_HERTZ_CRC));
    expect_nothing_known();
}

void test_a_lost_start_packet_drops_both_revolutions(void)
{
    add_six_hertz();
    add_points(&six_hertz[1], 16);
    TEST_ASSERT_FALSE(end_with(SIX_HERTZ_CRC));
    expect_nothing_known();
}

void test_the_revolution_after_a_dropped_one_is_trusted(void)
{
    add_six_hertz();
    TEST_ASSERT_FALSE(end_with(0x00));
    add_points(&six_hertz[1], 16);
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
}

void test_the_revolution_after_a_spoiled_one_is_trusted(void)
{
    (void)add(0x79, 0, 0);
    (void)add(0x40, 3, 0);
    TEST_ASSERT_FALSE(end_with(0x42));
    add_points(&six_hertz[1], 16);
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
}

void test_what_comes_before_the_first_start_packet_is_left_out(void)
{
    add_points(&six_hertz[1], 16);
    TEST_ASSERT_FALSE(end_with(SIX_HERTZ_CRC));
    add_points(&six_hertz[1], 16);
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
}

void test_packets_before_the_first_start_packet_are_no_revolution_even_with_last_crc(void)
{
    for (unsigned crc = 0; crc <= 255; crc++) {
        setUp();
        add_points(&six_hertz[1], 16);
        TEST_ASSERT_FALSE(end_with((uint8_t)crc));
        expect_nothing_known();
    }
}

void test_a_first_start_packet_ends_nothing(void)
{
    TEST_ASSERT_FALSE(add(0x79, 1, 0x00));
    TEST_ASSERT_FALSE(add(0x79, 1, 0x61)); /* The CRC of 79, without a point packet. */
    expect_nothing_known();
}

/* ------------------------------------------------------------------------------ what is kept */

void test_what_is_known_stays_known_when_a_revolution_is_dropped(void)
{
    add_six_hertz();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
    add_points(&six_hertz[2], 10);
    TEST_ASSERT_FALSE(end_with(0x11));
    tmini_ct_read(&ct_state, &info);
    expect_versions_and_faults(TMINI_FAULT_ENCODER | TMINI_FAULT_LD);
    TEST_ASSERT_EQUAL_UINT32(1193046, info.number);
}

void test_a_short_revolution_does_not_remove_what_a_long_one_reported(void)
{
    add_six_hertz();
    TEST_ASSERT_TRUE(add(TWELVE_HERTZ_CT, 1, SIX_HERTZ_CRC));
    add_points(&six_hertz[1], 9);
    TEST_ASSERT_TRUE(end_with(TWELVE_HERTZ_CRC));
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_UINT32(1193046, info.number);
    TEST_ASSERT_TRUE((info.known & TMINI_KNOWN_SERIAL) != 0);
}

void test_a_short_revolution_confirms_nothing_of_a_long_one_that_was_dropped(void)
{
    static const uint8_t others[16] = {0x66, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66,
                                       0x66, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66};
    add_six_hertz();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
    add_points(others, 16);
    TEST_ASSERT_FALSE(add(TWELVE_HERTZ_CT, 0, 0)); /* No LastCRC. */
    add_points(&six_hertz[1], 9);
    TEST_ASSERT_TRUE(end_with(TWELVE_HERTZ_CRC));
    tmini_ct_read(&ct_state, &info);
    expect_serial(2025, 4, 24, 1193046);
}

void test_the_faults_are_those_of_the_last_trusted_revolution(void)
{
    uint8_t cts[17];
    memcpy(cts, six_hertz, 17);
    cts[3] = 0;
    add_six_hertz();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
    TEST_ASSERT_EQUAL_UINT(0x12, tmini_ct_faults(&ct_state));
    add_points(&cts[1], 16);
    TEST_ASSERT_EQUAL_UINT(0x12,
                           tmini_ct_faults(&ct_state)); /* The new faults are not confirmed yet. */
    TEST_ASSERT_TRUE(end_with(0x95));
    TEST_ASSERT_EQUAL_UINT(0x00, tmini_ct_faults(&ct_state));
}

void test_a_discarded_revolution_is_not_continued_but_what_is_known_is_kept(void)
{
    add_six_hertz();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
    add_points(&six_hertz[1], 8);
    discard();
    add_points(&six_hertz[9], 8);
    TEST_ASSERT_FALSE(end_with(SIX_HERTZ_CRC));
    TEST_ASSERT_EQUAL_UINT(0x12, tmini_ct_faults(&ct_state));
    add_points(&six_hertz[1], 16);
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
}

/* EB is the CRC of the eight packets added here. */
void test_packets_between_a_discarded_revolution_and_a_start_packet_are_no_revolution(void)
{
    add_six_hertz();
    discard();
    add_points(&six_hertz[9], 8);
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(0x79, 1, 0xEB));
    expect_nothing_known();
}

void test_a_discarded_revolution_does_not_spoil_the_next_one(void)
{
    (void)add(0x79, 0, 0);
    (void)add(0x40, 9, 0);
    discard();
    add_six_hertz();
    TEST_ASSERT_TRUE(end_with(SIX_HERTZ_CRC));
}

/* --------------------------------------------------------------------------- long revolutions */

/* The revolution has 17 packets, then `more` with CT 10. */
static bool long_revolution_is_trusted(unsigned more, uint8_t last_crc)
{
    add_six_hertz();
    for (unsigned i = 0; i < more; i++) {
        (void)add(0x10, 0, 0);
    }
    return end_with(last_crc);
}

void test_the_crc_covers_all_packets_of_however_long_a_revolution(void)
{
    TEST_ASSERT_TRUE(long_revolution_is_trusted(238, 0x5C)); /* 255 packets. */
    TEST_ASSERT_TRUE(long_revolution_is_trusted(239, 0xE5)); /* 256. */
    TEST_ASSERT_TRUE(long_revolution_is_trusted(283, 0x68)); /* 300. */
    tmini_ct_read(&ct_state, &info);
    TEST_ASSERT_EQUAL_UINT32(1193046, info.number);
    expect_versions_and_faults(TMINI_FAULT_ENCODER | TMINI_FAULT_LD);
}

/* ---------------------------------------------------------------------------------- verdicts */

void test_a_right_last_crc_confirms_that_no_packet_was_lost(void)
{
    add_six_hertz();
    TEST_ASSERT_EQUAL_INT(TMINI_CT_CONFIRMED, verdict_on(0x79, 1, SIX_HERTZ_CRC));
}

void test_a_wrong_last_crc_says_that_a_packet_was_lost(void)
{
    add_revolution(0x79, &six_hertz[1], 15); /* The sixteenth is missing. */
    TEST_ASSERT_EQUAL_INT(TMINI_CT_REFUTED, verdict_on(0x79, 1, SIX_HERTZ_CRC));
}

void test_without_last_crc_or_ct_information_the_verdict_is_unknown(void)
{
    static const uint8_t zeros[16] = {0};
    add_six_hertz();
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(0x79, 0, SIX_HERTZ_CRC));
    add_points(zeros, 16); /* A unit without LastCRC: the byte before its start packet is noise. */
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(0x79, 1, 0x00));
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(0x00, 0, 0x00));
}

void test_a_revolution_with_a_gap_is_not_refuted_by_last_crc(void)
{
    (void)add(0x79, 0, 0);
    (void)add(0x40, 3, 0);
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(0x79, 1, 0x00));
    (void)add(0x40, 0, 0);
    (void)add(0x34, 3, 0);
    /* 42 is the CRC of 79 and 40 alone. */
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(0x79, 1, 0x42));
}
