/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* From bytes to packets and scans: the part that the decoder adds to parser, CT and builder. */

#include "rows.h"
#include "stream.h"

#include "tmini/parts/tmini_decoder.h"
#include "unity.h"

#include <string.h>

static uint8_t memory[512];
static uint8_t bytes[300];
static tmini_ring_t ring;
static tmini_decoder_t decoder;
static tmini_decoder_t other; /* Gets the packets from `decoder`, if it is used. */
static bool is_other_used;
static tmini_point_t points[2][40];
static uint8_t ct_of_first_third;

void setUp(void)
{
    ct_of_first_third = 0;
    is_other_used = false;
    other = (tmini_decoder_t){0};
    memset(&decoder, 0xFF, sizeof decoder); /* As memory that was used before. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, sizeof memory, false));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_decoder_init(&decoder, &ring, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&decoder.builder, points[0], 40, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&other.builder, points[1], 40, 0));
}

/* Third 0 is a start packet at 10 Hz, the others are a third of a turn. */
static void receive(unsigned third)
{
    const uint16_t first_q6 = (uint16_t)(third == 0 ? 0 : (third - 1) * 7680 + 64);
    const uint16_t last_q6 = (uint16_t)(third * 7680 % 23040);
    const uint8_t ct = third == 0 ? 201 : third == 1 ? ct_of_first_third : 0;
    stream_t stream = {bytes, 0, sizeof bytes};
    (void)stream_add_packet(&stream, ct, third == 0 ? 1 : 5, first_q6, last_q6);
    (void)tmini_ring_write(&ring, bytes, stream.size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, tmini_decoder_next(&decoder, 0));
}

/* The packet came at `at_ms`, or up to `late_ms` earlier. Returns whether it ends a scan. */
static bool come(unsigned third, uint32_t at_ms, uint16_t late_ms)
{
    receive(third);
    const bool is_scan = tmini_decoder_take(&decoder, false, at_ms, late_ms);
    return is_other_used ? tmini_decoder_take_packet(&other, &decoder.packet, at_ms) : is_scan;
}

/* Words of the rows:
 *
 *     0:70000 1:70025:90      this third comes at this time, 90 ms late at most
 *     0!:70100        it ends a scan, and begins the next; 0?:70100: it has not begun it yet
 *     rest:70000      the other thirds, which take 75 ms
 *     other           from now on, packets are passed on to another decoder
 *     no-builder      which makes no scans
 *     doubtful:2:70050        a third that is passed on as doubtful, and ends the scan
 *     ct:2 crc:0xE5   the CT of the first third; a LastCRC comes
 *     upside-down     the scan is marked, as tmini_mount_step() does
 *     restart         the decoder's; then there is no frame
 *     complete:1 …    see tell_word() */

static void tell_third(const char *word)
{
    const uint32_t at_ms = row_number(word);
    const bool ends = word[1] == '!' || word[1] == '?';
    TEST_ASSERT_EQUAL_MESSAGE(
        ends, come((unsigned)(word[0] - '0'), at_ms, (uint16_t)row_number(row_text(word))), word);
    if (is_other_used && word[1] == '!') {
        TEST_ASSERT_FALSE(tmini_builder_add(&other.builder, &decoder.packet, at_ms));
    }
}

static void pass_on_doubtful(unsigned third, uint32_t at_ms)
{
    (void)come(third, at_ms, 0);
    tmini_packet_t packet = decoder.packet;
    packet.gap = TMINI_GAP_UNKNOWN;
    TEST_ASSERT_TRUE(tmini_decoder_take_packet(&other, &packet, at_ms));
}

static void tell_word(char *word)
{
    tmini_decoder_t *const used = is_other_used ? &other : &decoder;
    const tmini_scan_t *const scan = &used->builder.scan;
    const row_number_t numbers[] = {
        {"complete", scan->complete},
        {"count", scan->count},
        {"gaps", scan->gaps},
        {"start-ms", scan->start_ms},
        {"marked", scan->upside_down},
        {"late", used->builder.late_scans},
        {"open", used->builder.open},
        {"confirmed", used->verdict == TMINI_CT_CONFIRMED},
        {"refuted", used->verdict == TMINI_CT_REFUTED},
        {"packet-gap", used->packet.gap},
        {"packet-ct", used->packet.ct},
    };
    const uint32_t number = row_number(word);
    const uint8_t byte = (uint8_t)number;
    if (word[0] >= '0' && word[0] <= '9') {
        tell_third(word);
    } else if (row_is(word, "rest")) {
        for (unsigned third = 1; third <= 3; third++) {
            TEST_ASSERT_FALSE(come(third, number + 25 * third, 0));
        }
    } else if (row_is(word, "other")) {
        is_other_used = true;
    } else if (row_is(word, "no-builder")) {
        other = (tmini_decoder_t){0};
    } else if (row_is(word, "doubtful")) {
        is_other_used = false;
        pass_on_doubtful(number, row_number(row_text(word)));
        is_other_used = true;
    } else if (row_is(word, "ct")) {
        ct_of_first_third = byte;
    } else if (row_is(word, "crc")) {
        (void)tmini_ring_write(&ring, &byte, 1);
    } else if (row_is(word, "upside-down")) {
        used->builder.scan.upside_down = true;
    } else if (row_is(word, "restart")) {
        tmini_decoder_restart(used);
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, tmini_decoder_next(used, 0));
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

#define TURN "0:70000 rest:70000 "

static const row_t rows[] IN_FLASH = {
    ROW(the_packet_that_ends_a_scan_begins_the_next_at_its_own_time, /* Unless it restarts. */
        TURN "0!:70100 complete:1 upside-down rest:70100 start-ms:70100 0!:70200 complete:1 "
             "marked:0 restart open:0"),
    /* ---- The limit of one and a half turns is 150 ms ---- */
    ROW(a_scan_that_may_have_begun_50_ms_earlier_has_not_taken_too_long,
        "0:70000:50 rest:70000 0!:70100:50 complete:1 rest:70100 start-ms:70100 0!:70200 "
        "complete:1 rest:70200 0!:70300 complete:1"),
    ROW(a_scan_that_may_have_begun_earlier_may_have_taken_too_long,
        "0:70000:51 rest:70000 0!:70100:51 complete:0 rest:70100 start-ms:70100 0!:70200 "
        "complete:0 rest:70200 0!:70300 complete:1"),
    ROW(a_scan_is_as_late_as_its_first_packet, /* Delays of the other packets do not count. */
        "0:70000 1:70025:90 2:70050:90 3:70075:90 0!:70100:90 complete:1"),
    ROW(a_scan_may_be_late_by_more_than_a_quarter_of_a_second, /* 300 is 44 in 8 bits. */
        "0:70000:300 rest:70000 0!:70100 complete:0"),
    ROW(a_scan_that_took_too_long_has_a_gap_though_no_byte_was_lost,
        "0:70000 0!:70151 gaps:1 late:1"),
    ROW(a_scan_of_more_than_a_minute_is_not_complete, /* 65,636 is 100 in 16 bits. */
        TURN "0!:135636 complete:0"),
    /* ---- Packets from another decoder ---- */
    ROW(packets_passed_on_make_the_same_scans, /* The last one begins the next. */
        "other " TURN "count:16 0!:70100 count:1 rest:70100 0!:70200 packet-gap:0 packet-ct:201"),
    ROW(a_doubtful_packet_passed_on_ends_the_scan,
        "other 0:70000 1:70025 doubtful:2:70050 count:6"),
    /* The CT bytes 201, 2, 0 and 0 have the CRC 0xE5 (section 7, computed bit by bit). */
    ROW(a_right_last_crc_confirms_packets_passed_on,
        "other ct:2 " TURN "crc:0xE5 0?:70100 confirmed:1 complete:1"),
    ROW(a_wrong_last_crc_refutes_packets_passed_on,
        "other ct:2 " TURN "crc:0xE4 0?:70100 refuted:1 complete:0"),
    ROW(without_a_builder_packets_passed_on_are_judged_too,
        "other no-builder " TURN "0:70100 packet-ct:201 open:0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

void test_initialisation_clears_the_memory(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, tmini_decoder_next(&decoder, 0));
    TEST_ASSERT_FALSE(decoder.builder.open);
    TEST_ASSERT_EQUAL_UINT32(0, decoder.parser.counters.packets);
    TEST_ASSERT_EQUAL_UINT8(0, decoder.ct.known);
    TEST_ASSERT_EQUAL_UINT16(0, decoder.packet.first_angle_q6);
}
