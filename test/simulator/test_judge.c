/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The judge sees each kind of lie, and no other. Samples are letters: that is their distance. */

#include "encoder.h"
#include "rows.h"
#include "sim_judge.h"

#include "unity.h"

#include <string.h>

static sim_judge_t judge;
static sim_reading_t reading;
static sim_packet_t packet;
static uint8_t bytes[ENCODE_OTHER_MAX];
static uint32_t step_q6; /* Between two samples. */

void setUp(void)
{
    sim_judge_begin(&judge);
    packet = (sim_packet_t){.bytes = bytes};
}

static uint16_t angle_of(char letter)
{
    return (uint16_t)((uint32_t)(letter - 'a') % 4u * step_q6);
}

static size_t encode(const char *letters, uint8_t count)
{
    encode_sample_t samples[4] = {{0}};
    for (uint8_t i = 0; i < count; i++) {
        samples[i].distance_mm = (uint8_t)letters[i];
    }
    const encode_packet_t content = {count == 1, count, angle_of(letters[0]),
                                     angle_of(letters[count - 1]), samples};
    return encode_packet(bytes, &content);
}

static void send(const char *letters, uint8_t count)
{
    (void)encode(letters, count);
    packet.starts_revolution = count == 1;
    packet.revolution += packet.starts_revolution ? 1u : 0u;
    (void)sim_judge_sent(&judge, &packet);
}

static void tell(char *word)
{
    const row_member_t members[] = {{"step", MEMBER(step_q6)},
                                    {"guarded", MEMBER(judge.is_guarded)},
                                    {"partial", MEMBER(packet.is_of_partial)}};
    const row_number_t facts[] = {{"lies", reading.lies},
                                  {"hidden", reading.is_hidden},
                                  {"before", reading.before},
                                  {"odd", reading.odd},
                                  {"in_one", sim_judge_in_one(&judge, 0, judge.sent)}};
    const char *text = row_text(word);
    if (row_is(word, "turn")) { /* The first sample is the start packet's. */
        send(text, 1);
        send(&text[1], 3);
    } else if (row_is(word, "scan")) {
        for (reading = (sim_reading_t){0}; *text != '\0'; text++) {
            sim_read_point(&judge, &reading,
                           (reference_point_t){angle_of(*text), (uint8_t)*text, 0, 0});
        }
    } else if (row_is(word, "end")) {
        reading.lies = sim_read_end(&judge, &reading, row_is(text, "complete"), row_is(text, "gap"),
                                    row_is(text, "dropped"));
    } else if (row_is(word, "known") || row_is(word, "unknown")) { /* As a packet's samples. */
        TEST_ASSERT_EQUAL_MESSAGE(row_is(word, "known"),
                                  sim_judge_knows(&judge, bytes, encode(text, 3)), word);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_stores(word, members) || row_expects(word, facts), word);
    }
}

/* Lies: 1 invented, 2 mixed, 4 disordered, 8 again, 16 complete, 32 silent. */
#define ABC "turn:abcd turn:efgh turn:ijkl "
#define TURNS "step:5760 guarded:1 " ABC
#define PARTIAL "step:5760 partial:1 turn:abcd partial:0 turn:efgh turn:ijkl "

static const row_t rows[] IN_FLASH = {
    ROW(whole_turns_are_true,
        TURNS "scan:abcd end:complete lies:0 scan:efgh end:complete lies:0 in_one:8"),
    ROW(a_point_was_never_sent, TURNS "scan:abxd end:gap lies:1"),
    ROW(points_are_of_two_turns, TURNS "scan:abcdfgh end:gap lies:2 before:3 odd:5"),
    ROW(a_turn_that_began_elsewhere_may_go_on, PARTIAL "scan:abcdfgh end:gap lies:0"),
    ROW(but_not_beyond_a_start_packet, PARTIAL "scan:abcdefgh end:gap lies:2"),
    ROW(points_are_out_of_order, TURNS "scan:acb end:gap lies:4"),
    ROW(points_were_in_an_earlier_scan, TURNS "2( scan:abcd end:complete ) lies:8 in_one:0"),
    ROW(a_hole_is_called_complete, TURNS "scan:abd end:complete lies:48"),
    ROW(dropped_points_are_missing, TURNS "scan:abc end:dropped lies:0"),
    ROW(a_hole_is_reported, TURNS "scan:abd end:gap lies:0"),
    ROW(a_hole_is_not_reported, TURNS "scan:abd end lies:32"),
    ROW(the_end_is_missing, TURNS "scan:abc end lies:32"),
    ROW(the_beginning_is_missing, TURNS "scan:bcd end lies:32"),
    ROW(one_point_that_is_not_complete_says_enough, TURNS "scan:a end lies:0"),
    ROW(a_small_hole_is_hidden, "step:128 " ABC "scan:abd end lies:0 hidden:1"),
    ROW(a_larger_one_is_not, "step:129 " ABC "scan:abd end lies:32 hidden:0"),
    ROW(what_was_sent_is_known, TURNS "known:bcd known:efg unknown:abx unknown:xbc unknown:acd"),
    ROW(with_last_crc_none_is, "step:128 guarded:1 " ABC "scan:abd end lies:32 hidden:0"),
};

void test_the_judge(void)
{
    tell_rows(rows, tell);
}
