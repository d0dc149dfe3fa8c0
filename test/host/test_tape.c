/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What test_decode.py cannot show: packets that come from a driver, and how a recording is played
 * from memory. */

#include "encoder.h"
#include "rows.h"
#include "tape.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define FILE_MAX 60000u
#define CHUNK_US 42000u /* Between two chunks, unless a row says something else. */

static uint8_t file[FILE_MAX];
static size_t size;
static size_t fed; /* So much of the file has been fed. */
static bool is_timed;
static uint32_t delta_us; /* Before the next chunk. */
static tape_t tape;
static uint32_t now_ms; /* Of packets that come from a driver. */

void setUp(void)
{
    size = 0;
    fed = 0;
    is_timed = false;
    delta_us = CHUNK_US;
    now_ms = 0;
    tape_begin(&tape, NULL, 0);
}

/* ---- What is recorded ---- */

static void put_bytes(const uint8_t *bytes, size_t count)
{
    TEST_ASSERT_TRUE(size + count <= FILE_MAX);
    memcpy(file + size, bytes, count);
    size += count;
}

/* Quarter 0 is the start packet (6 Hz), the others are a quarter of a turn: 40 samples. */
static size_t packet_of(unsigned quarter, uint8_t packet[ENCODE_PACKET_MAX])
{
    static encode_sample_t samples[40];
    samples[0].intensity++; /* No packet equals the one before. */
    const encode_packet_t fields = {
        .ct = quarter == 0 ? 60 << 1 | 1 : 0,
        .lsn = quarter == 0 ? 1 : 40,
        .first_q6 = (uint16_t)(quarter == 0 ? 0 : (quarter - 1) * 5760 + 144),
        .last_q6 = (uint16_t)(quarter == 0 ? 0 : quarter * 5760 % 23040),
        .samples = samples,
    };
    return encode_packet(packet, &fields);
}

static void put_turn(void)
{
    for (unsigned quarter = 0; quarter <= 4; quarter++) {
        uint8_t head[TMINI_TIMED_HEAD_SIZE];
        uint8_t packet[ENCODE_PACKET_MAX];
        const size_t count = packet_of(quarter, packet);
        tmini_timed_write_head(head, delta_us, packet, count);
        put_bytes(head, is_timed ? sizeof head : 0);
        put_bytes(packet, count);
        delta_us = CHUNK_US;
    }
}

/* ---- How it is played ---- */

/* Plays until more bytes are needed or the end is reached. */
static void expect_next(tape_next_t wanted)
{
    tape_next_t next = TAPE_PACKET;
    while (next == TAPE_PACKET || next == TAPE_SCAN) {
        next = tape_next(&tape);
    }
    TEST_ASSERT_EQUAL_INT(wanted, next);
}

/* Feeds what is there. */
static void feed(void)
{
    while (fed < size) {
        expect_next(TAPE_NEEDS_BYTES);
        fed += tape_feed(&tape, file + fed, size - fed);
    }
}

static void finish(void)
{
    feed();
    expect_next(TAPE_NEEDS_BYTES);
    (void)tape_feed(&tape, file, 0);
    expect_next(TAPE_END);
    expect_next(TAPE_END);
}

/* A packet comes from a driver, by the library's parser. The driver marks a doubtful packet by its
 * gap. */
static bool come(unsigned quarter, bool is_doubted)
{
    static tmini_parser_t parser;
    static tmini_ring_t ring;
    static uint8_t memory[1024];
    uint8_t bytes[ENCODE_PACKET_MAX];
    tmini_packet_t packet;
    (void)tmini_ring_init(&ring, memory, sizeof memory, false);
    (void)tmini_parser_init(&parser, &ring, 0);
    (void)tmini_ring_write(&ring, bytes, packet_of(quarter, bytes));
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, tmini_parser_next(&parser));
    tmini_packet_open(&packet, tmini_parser_frame(&parser));
    packet.gap = is_doubted ? TMINI_GAP_UNKNOWN : packet.gap;
    return stream_take(&tape.stream, &packet, now_ms);
}

/* ---- Words of rows ---- */

/* A recording, and how it is played. */
static bool tell_tape(const char *word)
{
    if (row_is(word, "timed")) {
        put_bytes(tmini_timed_magic, sizeof tmini_timed_magic);
        is_timed = true;
    } else if (row_is(word, "after")) { /* The next chunk comes this many microseconds later. */
        delta_us = row_number(word);
    } else if (row_is(word, "turn")) {
        put_turn();
    } else if (row_is(word, "until")) { /* What came up to this time. */
        feed();
        tape.until_us = row_number(word);
        expect_next(TAPE_LATER);
    } else {
        return false;
    }
    return true;
}

/* A stream from a driver. QUARTER@MS: a packet comes; QUARTER?@MS: a doubtful one; …!: it ends a
 * scan; …*: or not. A time of +MS is later than the packet before. */
static bool tell_stream(const char *word)
{
    if (row_is(word, "no-rest")) {
        TEST_ASSERT_FALSE(stream_end(&tape.stream));
    } else if (row_is(word, "break")) {
        stream_break(&tape.stream);
    } else if (row_is(word, "late")) { /* By a network. */
        tape.stream.is_late = true;
    } else if (strchr(word, '@') != NULL) {
        const char *const time = strchr(word, '@') + 1;
        now_ms = (uint32_t)atoi(time) + (*time == '+' ? now_ms : 0);
        const bool ends = come(word[0] - (unsigned)'0', word[1] == '?');
        const bool should_end = strchr(word, '*') == NULL ? strchr(word, '!') != NULL : ends;
        TEST_ASSERT_EQUAL_MESSAGE(should_end, ends, word);
    } else {
        return false;
    }
    return true;
}

/* NAME:NUMBER: what is known then. */
static void tell(char *word)
{
    const row_number_t numbers[] = {
        {"packets", (uint32_t)tape.stream.packets}, {"damaged", (uint32_t)tape.stream.damaged},
        {"sent_ms", tape.stream.sent_ms},           {"scan.complete", tape.stream.scan.complete},
        {"scan.packets", tape.stream.scan.packets},
    };
    if (!tell_tape(word) && !tell_stream(word) && !row_expects(word, numbers)) {
        TEST_FAIL_MESSAGE(word);
    }
}

/* clang-format off */
static const row_t rows[] = {
    ROW(what_came_later_is_not_there_yet,
        "timed after:1000 turn until:999 packets:0 until:43000 packets:2 until:85000 packets:3"),

    /* After a pause, all of a batch may be doubtful. */
    ROW(a_doubtful_batch_is_one_scan,
        "0@0 1@42 2?@400! 3?@400 4@440 0@480! scan.packets:3 scan.complete:0 damaged:0"),
    ROW(a_pause_also_ends_a_doubtful_scan,
        "0@0 1@42 2?@400! 3?@400 4?@1401!"),
    ROW(what_was_interrupted_is_no_scan,
        "0@0 1@42 break 2@84 no-rest"),
    /* 40 samples take 10 ms. Packets that come together are dated 11 ms apart, so that those that
     * come in time catch up by 1 ms each. */
    ROW(packets_that_come_late_get_the_times_at_which_they_were_sent,
        "late 0@900 1@911 sent_ms:911 2@990 sent_ms:922 3@990 sent_ms:933 4@990 sent_ms:944"
        " 0@990! sent_ms:945 1@1000* sent_ms:956 1@1010* sent_ms:967 42( 1@+10* ) sent_ms:1429"
        " 1@+10* sent_ms:1440 1@+10* sent_ms:1450"),
    ROW(a_packet_that_comes_early_gets_the_time_at_which_it_comes,
        "late 1@100 2@110 sent_ms:110"),
    ROW(a_packet_that_comes_a_second_late_was_sent_in_time,
        "late 1@0 2@1011 sent_ms:11"),
    ROW(a_packet_that_comes_later_was_sent_then,
        "late 1@0 2@1012 sent_ms:1012"),
    ROW(without_a_network_packets_are_not_late,
        "1@0 2@500 sent_ms:500"),
};
/* clang-format on */

void test_rows(void)
{
    tell_rows(rows, tell);
}

/* ---- What is kept ---- */

/* There is room for 32,768 bytes. No byte that was accepted is lost. */
void test_no_more_is_taken_than_there_is_room_for(void)
{
    while (size < 100 * 533) {
        put_turn();
    }
    TEST_ASSERT_EQUAL_size_t(1000, tape_feed(&tape, file, 1000));
    TEST_ASSERT_EQUAL_size_t(31768, tape_feed(&tape, file + 1000, size - 1000));
    TEST_ASSERT_EQUAL_size_t(0, tape_feed(&tape, file + 32768, size - 32768));
    fed = 32768;
    finish();
    TEST_ASSERT_EQUAL_UINT64(500, tape.stream.packets);
}

void test_a_scan_stays_until_the_next(void)
{
    tmini_point_t points[161];
    row_tell("turn turn turn", tell);
    feed();
    while (tape.stream.scans < 2) {
        (void)tape_next(&tape);
    }
    const tmini_scan_t scan = tape.stream.scan;
    memcpy(points, scan.points, sizeof points);
    finish();
    TEST_ASSERT_EQUAL_PTR(scan.points, tape.stream.scan.points);
    TEST_ASSERT_EQUAL_MEMORY(points, scan.points, sizeof points);
}
