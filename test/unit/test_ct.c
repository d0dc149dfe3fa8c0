/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* CT information: the content of a revolution's CT bytes, and when it is trusted (section 7). */

#include "rows.h"

#include "tmini/parts/tmini_ct.h"
#include "tmini/parts/tmini_reply.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static tmini_ct_t state;
static bool is_whole; /* Nothing has been lost since the last start packet. */

/* 17 packets at 6.0 Hz, worked out by hand from the table: user version 1.0, faults encoder and LD,
 * hardware 1, firmware 2.7, 2025-04-24, number 1193046 = 10 010 00 1101000 1010110 in binary. Their
 * CRC-8/MAXIM is D8. All CRCs in this file were computed by a separate program. */
static const uint8_t unit[17] = {0x79, 0x40, 0x34, 0x24, 0x24, 0x0E, 0x12, 0x56, 0x9A,
                                 0x2C, 0x44, 0xC0, 0xD0, 0xAC, 0x10, 0x20, 0x30};

void setUp(void)
{
    memset(&state, 0xEE, sizeof state);
    tmini_ct_init(&state);
    is_whole = false;
}

/* Adds a packet with `gap` skipped bytes before it; `skipped` is the last of them. What is whole is
 * decided here as the protocol says (section 7), for start packets and others. */
static tmini_ct_verdict_t verdict_on(uint8_t ct, uint16_t gap, uint8_t skipped)
{
    const tmini_frame_t frame = {.gap = gap, .last_skipped = skipped};
    const tmini_packet_t packet = {.ct = ct, .count = 1, .gap = gap, .frame = &frame};
    is_whole = (ct & 1u) != 0 || (is_whole && gap == 0);
    return tmini_ct_add(&state, &packet, is_whole);
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows:
 *
 *     <79             a packet of this CT comes; it says nothing about the turn before
 *     +79:D8 -79:D8   it comes after this byte, and confirms or refutes the turn before
 *     <40:00*3        3 bytes were skipped before it, the last of which is 00
 *     unit:1:16       packets of the unit above from index 1 to 16
 *     discard         the turn was interrupted
 *     known:0x2 …     see expect_number() */

static void tell_packet(const char *word)
{
    char *rest;
    const uint8_t ct = (uint8_t)strtoul(word + 1, &rest, 16);
    const bool has_gap = rest[0] == ':';
    const uint8_t skipped = (uint8_t)(has_gap ? strtoul(rest + 1, &rest, 16) : 0);
    const uint16_t gap = (uint16_t)(rest[0] == '*' ? strtoul(rest + 1, NULL, 10) : has_gap);
    const tmini_ct_verdict_t expected = word[0] == '+'   ? TMINI_CT_CONFIRMED
                                        : word[0] == '-' ? TMINI_CT_REFUTED
                                                         : TMINI_CT_UNKNOWN;
    TEST_ASSERT_EQUAL_INT_MESSAGE(expected, verdict_on(ct, gap, skipped), word);
}

static void expect_number(const char *word)
{
    tmini_ct_info_t info;
    memset(&info, 0xEE, sizeof info);
    tmini_ct_read(&state, &info);
    const row_number_t numbers[] = {
        {"known", info.known},
        {"user", info.user_major},
        {"user-minor", info.user_minor},
        {"faults", tmini_ct_faults(&state)},
        {"info-faults", info.faults},
        {"hardware", info.hardware},
        {"firmware", info.firmware_major},
        {"firmware-minor", info.firmware_minor},
        {"year", info.year},
        {"month", info.month},
        {"day", info.day},
        {"number", info.number},
    };
    TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
}

static void tell_word(char *word)
{
    if (strchr("<+-", word[0]) != NULL) {
        tell_packet(word);
    } else if (row_is(word, "unit")) {
        for (size_t i = row_number(word); i <= row_number(row_text(word)); i++) {
            TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, verdict_on(unit[i], 0, 0xD8));
        }
    } else if (row_is(word, "discard")) {
        tmini_ct_discard(&state);
        is_whole = false;
    } else {
        expect_number(word);
    }
}

#define TURN "<79 unit:1:16 "
#define NOTHING                                                                         \
    "known:0 user:0 user-minor:0 info-faults:0 hardware:0 firmware:0 firmware-minor:0 " \
    "year:0 month:0 day:0 number:0 faults:0x100 "
#define VERSIONS "user:1 user-minor:0 hardware:1 firmware:2 firmware-minor:7 "
#define FAULTS "faults:0x12 info-faults:0x12 "

static const row_t rows[] IN_FLASH = {
    /* ---- Fields ---- */
    ROW(before_the_first_packet_nothing_is_known, NOTHING),
    ROW(a_turn_at_6_hz_reports_everything, /* Bits 1, 3, 4, 5, 9, 10, 11 and 13. */
        TURN "known:0 +79:D8 known:0x2E3A " VERSIONS FAULTS
             "year:2025 month:4 day:24 number:1193046"),
    ROW(a_turn_at_10_hz_does_not_show_day_and_number, /* It has 11 packets. */
        "<C9 unit:1:10 +79:DD known:0x063A " VERSIONS FAULTS "year:2025 month:4 day:0 number:0"),
    ROW(a_turn_at_12_hz_does_not_show_the_month_either, /* It has 10 packets. */
        "<F1 unit:1:9 +79:B0 known:0x023A year:2025 month:0"),
    ROW(a_field_is_known_when_the_packet_that_completes_it_has_come,
        "<79 unit:1:1 +79:42 known:0x0002 unit:1:2 +79:25 known:0x0002 faults:0x100 "
        "unit:1:3 +79:5E known:0x000A " FAULTS "hardware:0 unit:1:8 +79:72 known:0x003A year:0"),
    ROW(the_largest_values_fit_their_fields, /* The faults' reserved bit is left out. */
        "<FF 13( <FE ) +79:51 user:3 user-minor:31 info-faults:0x3F faults:0x3F hardware:7 "
        "firmware:15 firmware-minor:127 year:2051 month:15 day:31 number:2097151"),
    ROW(each_bit_of_the_serial_number_has_its_place, /* 01 101 10 0110101 0101011: 891563. */
        "<79 8( <00 ) <32 <CA <FC <6A <56 3( <00 ) +79:E1 year:2026 month:12 day:31 "
        "number:891563"),
    ROW(a_healthy_lidar_is_known_to_have_no_faults, "<79 unit:1:2 <00 unit:4:16 +79:95 faults:0"),
    /* ---- Trust ---- */
    ROW(a_last_crc_of_aa_is_like_any_other, "<79 unit:1:15 <96 +79:AA"),
    ROW(without_last_crc_nothing_is_trusted, /* An earlier stray byte has that value. */
        TURN "<79:D8*0 known:0"),
    ROW(more_than_one_stray_byte_is_no_last_crc,
        TURN "<79:D8*2 unit:1:16 <79:D8*257 unit:1:16 <79:D8*65535 known:0"),
    /* Section 9.1: no CT information in point packets, no LastCRC, but sometimes a noise byte. */
    ROW(a_unit_without_ct_information_never_becomes_healthy,
        "2( 16( <00 ) <79:32 ) 16( <00 ) <79:00 <00 known:0"),
    ROW(ct_information_that_stops_coming_confirms_nothing_sent_before, /* By chance right. */
        TURN "+79:D8 16( <00 ) <79:32 faults:0x12"),
    ROW(one_point_packet_with_information_is_enough, "<79 15( <00 ) <02 +79:8E faults:0"),
    ROW(a_gap_within_a_turn_leaves_it_unjudged, /* 42 is the CRC of 79 and 40 alone. */
        "<79 unit:1:6 <56:00*1 unit:8:16 <79:D8 <40 <34:00*3 <79:42 known:0"),
    ROW(a_lost_packet_refutes_the_turn, "<79 unit:1:6 unit:8:16 -79:D8 unit:1:15 -79:D8 " NOTHING),
    ROW(a_lost_start_packet_refutes_both_turns, TURN "unit:1:16 -79:D8 " NOTHING),
    ROW(the_turn_after_a_refuted_one_is_trusted, TURN "-79:00 unit:1:16 +79:D8"),
    ROW(the_turn_after_one_with_a_gap_is_trusted, "<79 <40:00*3 <79:42 unit:1:16 +79:D8"),
    ROW(packets_before_the_first_start_packet_are_no_turn, "unit:1:16 <79:D8 unit:1:16 +79:D8"),
    ROW(a_first_start_packet_ends_nothing, "<79:00 <79:61 known:0"), /* 61: the CRC of 79. */
    ROW(the_crc_covers_all_packets_of_however_long_a_turn,           /* 255, 256 and 300. */
        TURN "238( <10 ) +79:5C unit:1:16 239( <10 ) +79:E5 unit:1:16 283( <10 ) +79:68 " VERSIONS
             "number:1193046"),
    /* ---- What is kept ---- */
    ROW(what_is_known_stays_known_when_a_turn_is_refuted,
        TURN "+79:D8 unit:2:11 -79:11 " VERSIONS FAULTS "number:1193046"),
    ROW(a_short_turn_does_not_remove_what_a_long_one_reported,
        TURN "+F1:D8 unit:1:9 +79:B0 known:0x2E3A number:1193046"),
    ROW(a_short_turn_confirms_nothing_of_a_long_one_that_was_not_confirmed,
        TURN "+79:D8 16( <66 ) <F1 unit:1:9 +79:B0 year:2025 month:4 day:24 number:1193046"),
    ROW(the_faults_are_those_of_the_last_trusted_turn,
        TURN "+79:D8 faults:0x12 unit:1:2 <00 unit:4:16 faults:0x12 +79:95 faults:0"),
    ROW(an_interrupted_turn_is_not_continued_but_what_is_known_is_kept,
        TURN "+79:D8 unit:1:8 discard unit:9:16 <79:D8 faults:0x12 unit:1:16 +79:D8"),
    ROW(packets_between_an_interruption_and_a_start_packet_are_no_turn, /* EB: their CRC. */
        TURN "discard unit:9:16 <79:EB known:0"),
    ROW(an_interrupted_turn_does_not_spoil_the_next_one, "<79 <40:00*9 discard " TURN "+79:D8"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

void test_every_wrong_last_crc_refutes_the_turn(void)
{
    for (unsigned crc = 0; crc <= 255; crc++) {
        if (crc != 0xD8) {
            setUp();
            row_tell("unit:0:16", tell_word);
            TEST_ASSERT_EQUAL_INT(TMINI_CT_REFUTED, verdict_on(0x79, 1, (uint8_t)crc));
            expect_number("known:0");
        }
    }
}

void test_the_crc_of_123456789_is_a1(void)
{
    static const uint8_t digits[9] = "123456789";
    uint8_t crc = 0;
    for (unsigned i = 0; i < 9; i++) {
        crc = tmini_ct_crc8(crc, digits[i]);
    }
    TEST_ASSERT_EQUAL_HEX8(0xA1, crc);
}
