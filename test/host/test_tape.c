/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Recordings played from memory: raw ones, and timed ones written here from the format's
 * description, with one byte lost, changed or added anywhere. Most tests are rows: what is in the
 * recording, what is done with it, and what is then known. */

#include "encoder.h"
#include "rows.h"
#include "simulator.h"
#include "tape.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILE_MAX 200000u
#define SECONDS 10u
#define FIRST_CHUNK 150u /* The first chunk ends before this offset. */
#define CHUNK_US 42000u  /* Between two chunks, unless a row says something else. */

static uint8_t file[FILE_MAX + 1];
static size_t size;
static size_t fed;        /* So much of the file has been fed. */
static unsigned version;  /* Of the chunks; 0: none. */
static uint32_t delta_us; /* Before the next chunk. */
static tape_t tape;
static unsigned scans;
static uint32_t now_ms; /* Of packets that come from a driver. */

static void begin(void)
{
    fed = 0;
    scans = 0;
    tape_begin(&tape, NULL, 0);
}

void setUp(void)
{
    size = 0;
    version = 0;
    delta_us = CHUNK_US;
    now_ms = 0;
    begin();
}

void tearDown(void) {}

/* ---- What is recorded ---- */

static void put(unsigned byte)
{
    TEST_ASSERT_TRUE(size < FILE_MAX);
    file[size++] = (uint8_t)byte;
}

static void put_number(uint32_t number, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++) {
        put(number >> (8 * i) & 0xFFu);
    }
}

/* CRC-16 bit by bit: polynomial 0x1021, initial value 0xFFFF. */
static uint16_t crc_of(const uint8_t *bytes, size_t count, uint16_t crc)
{
    for (size_t i = 0; i < count; i++) {
        crc = (uint16_t)(crc ^ bytes[i] << 8);
        for (int bit = 0; bit < 8; bit++) {
            crc = (uint16_t)((crc & 0x8000u) != 0 ? crc << 1 ^ 0x1021 : crc << 1);
        }
    }
    return crc;
}

static void put_bytes(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        put(bytes[i]);
    }
}

static void put_magic(unsigned of_version)
{
    put_bytes((const uint8_t *)"\x89tmini\x02\n", 8);
    version = of_version;
    file[6] = (uint8_t)version;
}

/* What the lidar has sent: in a chunk, if there are chunks. */
static void put_sent(const uint8_t *bytes, size_t count)
{
    if (version == 2) {
        put(0xA7);
        put(0xC3);
    }
    if (version > 0) {
        put_number(delta_us, 4);
        put_number((uint32_t)count, 2);
        delta_us = CHUNK_US;
    }
    if (version == 2) {
        put_number(crc_of(bytes, count, crc_of(file + size - 6, 6, 0xFFFF)), 2);
    }
    put_bytes(bytes, count);
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

static void put_packet(unsigned quarter)
{
    uint8_t packet[ENCODE_PACKET_MAX];
    put_sent(packet, packet_of(quarter, packet));
}

static void put_turn(void)
{
    for (unsigned quarter = 0; quarter <= 4; quarter++) {
        put_packet(quarter);
    }
}

/* Ten seconds of a lidar's stream, read every 5 ms, after a second of silence. */
static void put_lidar(void)
{
    static const uint8_t start[2] = {0xA5, 0x60};
    static sim_t lidar;
    const sim_config_t config = sim_default_config();
    uint64_t stamp_us = 0;
    sim_init(&lidar, &config);
    sim_receive(&lidar, start, sizeof start, 1000000);
    for (uint64_t now_us = 1000000; now_us < (SECONDS + 1) * 1000000u; now_us += 5000) {
        uint8_t bytes[512];
        const size_t count = sim_transmit(&lidar, now_us, bytes, sizeof bytes);
        if (count > 0) {
            delta_us = (uint32_t)(now_us - stamp_us);
            put_sent(bytes, count);
            stamp_us = now_us;
        }
    }
}

/* ---- How it is played ---- */

/* Plays until more bytes are needed or the end is reached. */
static tape_next_t play(void)
{
    tape_next_t next = TAPE_PACKET;
    while (next == TAPE_PACKET || next == TAPE_SCAN) {
        next = tape_next(&tape);
        scans += next == TAPE_SCAN ? 1 : 0;
    }
    return next;
}

static void expect_next(tape_next_t wanted)
{
    TEST_ASSERT_EQUAL_INT(wanted, play());
}

static void feed_bytes(const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        expect_next(TAPE_NEEDS_BYTES);
        const size_t taken = tape_feed(&tape, bytes, count);
        bytes += taken;
        count -= taken;
    }
}

/* Feeds the file up to here. */
static void feed_to(size_t end)
{
    feed_bytes(file + fed, end - fed);
    fed = end;
}

static void finish(void)
{
    expect_next(TAPE_NEEDS_BYTES);
    (void)tape_feed(&tape, file, 0);
    expect_next(TAPE_END);
    expect_next(TAPE_END);
}

static void play_whole(void)
{
    feed_to(size);
    finish();
}

/* Plays the file in blocks of this size. */
static void play_blocks(size_t block)
{
    begin();
    while (fed < size) {
        feed_to(size - fed < block ? size : fed + block);
    }
    finish();
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

/* What is in the recording. */
static bool tell_content(const char *word)
{
    if (row_is(word, "v")) { /* In chunks, of this version. */
        put_magic(row_number(word));
    } else if (row_is(word, "raw")) { /* No longer. */
        version = 0;
    } else if (row_is(word, "after")) { /* The next chunk comes this many microseconds later. */
        delta_us = row_number(word);
    } else if (row_is(word, "zeros")) {
        memset(file + size, 0, row_number(word));
        size += row_number(word);
    } else if (row_is(word, "turn")) {
        put_turn();
    } else if (word[0] >= '0' && word[0] <= '4') { /* A packet of it. */
        put_packet(word[0] - (unsigned)'0');
    } else {
        return false;
    }
    return true;
}

/* What is done with it. */
static bool tell_act(const char *word)
{
    if (row_is(word, "feed")) { /* All that is there is decoded. */
        feed_to(size);
        expect_next(TAPE_NEEDS_BYTES);
    } else if (row_is(word, "until")) { /* What came up to this time. */
        feed_to(size);
        tape.until_us = row_number(word);
        expect_next(TAPE_LATER);
    } else if (row_is(word, "scan")) { /* Up to the end of the next scan. */
        feed_to(size);
        while (tape_next(&tape) != TAPE_SCAN) {
        }
    } else if (row_is(word, "blocks")) { /* To the end, in blocks of a byte, and of more. */
        for (size_t block = 1; block < 2 * size; block = 3 * block + 1) {
            play_blocks(block);
        }
    } else if (row_is(word, "end")) {
        play_whole();
    } else if (row_is(word, "rest") || row_is(word, "no-rest")) {
        TEST_ASSERT_EQUAL(word[0] == 'r', stream_end(&tape.stream));
    } else if (row_is(word, "break")) {
        stream_break(&tape.stream);
    } else if (row_is(word, "late")) { /* By a network. */
        tape.stream.is_late = true;
    } else {
        return false;
    }
    return true;
}

/* NAME:NUMBER: what is known then. */
static bool tell_number(const char *word)
{
    const stream_t *const stream = &tape.stream;
    const row_number_t numbers[] = {
        {"bytes", (uint32_t)tape.bytes},
        {"time_us", (uint32_t)tape.time_us},
        {"skipped", (uint32_t)tape_skipped(&tape)},
        {"damages", tape.chunks.damages},
        {"scans", scans}, /* That tape_next() has announced. */
        {"packets", (uint32_t)stream->packets},
        {"complete", (uint32_t)stream->complete},
        {"points_before", (uint32_t)stream->points_before},
        {"stray_bytes", (uint32_t)stream->stray_bytes},
        {"last_crc_bytes", (uint32_t)stream->last_crc_bytes},
        {"damaged", (uint32_t)stream->damaged},
        {"packet_ms", stream->packet_ms},
        {"sent_ms", stream->sent_ms},
        {"longest_ms", stream->longest_ms},
        {"frequency", stream->frequency_chz},
        {"faults", stream_faults(stream)},
        {"reports_nothing", stream_reports_nothing(stream)},
        {"scan.number", (uint32_t)stream->number},
        {"scan.complete", stream->scan.complete},
        {"scan.packets", stream->scan.packets},
        {"scan.count", stream->scan.count},
        {"scan.start_ms", stream->scan.start_ms},
    };
    return row_expects(word, numbers);
}

/* QUARTER@MS: a packet comes from a driver; QUARTER?@MS: a doubtful one; …!: it ends a scan; …*: or
 * not. A time of +MS is later than the packet before. */
static void tell_packet(const char *word)
{
    const char *const time = strchr(word, '@') + 1;
    now_ms = (uint32_t)atoi(time) + (*time == '+' ? now_ms : 0);
    const bool ends = come(word[0] - (unsigned)'0', word[1] == '?');
    if (strchr(word, '*') == NULL) {
        TEST_ASSERT_EQUAL_MESSAGE(strchr(word, '!') != NULL, ends, word);
    }
}

static void tell(char *word)
{
    if (strchr(word, '@') != NULL) {
        tell_packet(word);
    } else if (!tell_content(word) && !tell_act(word) && !tell_number(word)) {
        TEST_FAIL_MESSAGE(word);
    }
}

static void run(const row_t *row)
{
    row_tell(row->steps, tell);
}

/* clang-format off */
static const row_t rows[] = {
    /* A recording. */
    ROW(blocks_of_any_size_give_the_same,
        "30( turn ) blocks packets:150 scans:29 complete:29"),
    ROW(blocks_of_any_size_give_the_same_chunks,
        "v:2 30( turn ) blocks packets:150 time_us:6300000 damages:0"),
    ROW(what_came_later_is_not_there_yet,
        "v:2 after:1000 turn until:999 packets:0 until:43000 packets:2 until:85000 packets:3"),
    /* While the next chunk is looked for, the lidar's bytes are passed on, down to the last. */
    ROW(a_recording_may_end_in_a_damaged_place,
        "v:1 zeros:4 raw 1 end damages:1 packets:1 bytes:134"),

    /* What a stream reports. */
    ROW(what_precedes_the_first_packet_is_no_damage,
        "zeros:300 1 end stray_bytes:0 damaged:0 skipped:300"),
    ROW(one_byte_before_a_start_packet_is_a_last_crc,
        "turn zeros:1 turn end last_crc_bytes:1 stray_bytes:0"),
    ROW(two_bytes_before_a_start_packet_are_damage,
        "turn zeros:2 turn end last_crc_bytes:0 stray_bytes:2"),
    ROW(the_time_before_the_first_packet_is_no_pause,
        "v:2 after:66000000 turn after:70000 turn end longest_ms:70 complete:1"),
    ROW(a_pause_may_be_longer_than_a_minute,
        "v:2 after:0 turn after:66000000 turn end longest_ms:66000 packet_ms:66336"),
    /* The start packet's CT has 60, which is 6.00 Hz. */
    ROW(the_frequency_is_that_of_the_latest_start_packet,
        "4 feed frequency:0 0 1 feed frequency:600"),
    /* Units without LastCRC (section 9.1); this is known after a whole turn. */
    ROW(a_unit_may_report_nothing_in_the_stream,
        "turn feed reports_nothing:0 0 feed complete:1 reports_nothing:1 faults:256"),
    ROW(after_last_crc_a_report_may_follow,
        "turn turn zeros:1 0 feed complete:2 last_crc_bytes:1 reports_nothing:0"),

    /* What is a scan. A quarter has 40 points, a turn 161. */
    ROW(a_scan_has_the_number_of_its_start_packet,
        "4 turn turn 0 scan scan.number:1 scan.count:161 scan.complete:1"
        " scan scan.number:2 scan.count:161 scan.complete:1 points_before:40"),
    ROW(the_end_leaves_the_rest_of_a_scan_once,
        "turn 0 1 end scans:1 rest scan.number:2 scan.count:41 scan.complete:0 no-rest"),
    ROW(a_start_packet_and_then_a_pause_is_no_scan,
        "v:2 turn 0 after:1001000 turn turn end scans:2 complete:2 scan.number:3 longest_ms:1001"),
    ROW(a_start_packet_is_not_joined_with_what_comes_after_a_pause,
        "v:2 0 after:1001000 1 end longest_ms:1001 rest scan.packets:1"),
    ROW(a_scan_goes_on_after_a_second,
        "v:2 0 1 after:1000000 2 end scans:0"),
    /* The angles fit together, but whole turns may be missing in the pause. */
    ROW(a_scan_does_not_go_on_after_a_longer_pause,
        "v:2 0 1 after:1001000 2 end scans:1"),
    /* The packets before and after them must not be joined; how many are lost is unknown. */
    ROW(a_scan_does_not_go_on_after_unreadable_bytes,
        "0 1 zeros:70000 2 zeros:70000 3 end packets:4 scans:1 damaged:0 rest scan.packets:1"),
    /* Computed backwards from the packets, the first sample would be before it. */
    ROW(no_scan_begins_before_the_recording,
        "0 zeros:600 1 2 end rest scan.packets:2 scan.start_ms:0"),

    /* Packets from a driver. After a pause, all of a batch may be doubtful. */
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
    run_rows(rows, run);
}

/* ---- Damaged anywhere ---- */

typedef enum { DROPPED, CHANGED, ADDED, KINDS } damage_t;

static void play_damaged(size_t at, damage_t damage)
{
    const uint8_t other = (uint8_t)(file[at] ^ 0x55);
    begin();
    feed_to(at);
    feed_bytes(&other, damage == DROPPED ? 0 : 1);
    fed += damage == ADDED ? 0 : 1;
    play_whole();
}

void test_a_damaged_byte_is_noticed_and_costs_a_recording_a_hundredth_at_most(void)
{
    char at_fault[60];
    for (unsigned of_version = 1; of_version <= 2; of_version++) {
        setUp();
        put_magic(of_version);
        put_lidar();
        play_whole();
        const count_t packets = tape.stream.packets;
        const uint64_t time_us = tape.time_us;
        TEST_ASSERT_TRUE(packets > 900);
        TEST_ASSERT_EQUAL_UINT(0, tape.chunks.damages);
        TEST_ASSERT_EQUAL_UINT64(tape.stream.start_packets - 1, tape.stream.confirmed);
        for (size_t i = 0; FIRST_CHUNK + 509 * (i / KINDS) < size; i++) {
            const size_t at = FIRST_CHUNK + 509 * (i / KINDS);
            (void)snprintf(at_fault, sizeof at_fault, "version %u, damage %u at %zu", version,
                           (unsigned)(i % KINDS), at);
            play_damaged(at, (damage_t)(i % KINDS));
            TEST_ASSERT_TRUE_MESSAGE(tape.stream.packets * 100 >= packets * 99, at_fault);
            TEST_ASSERT_TRUE_MESSAGE(tape.stream.packets <= packets, at_fault);
            if (version == 2) { /* Version 1 cannot detect a changed pause. */
                TEST_ASSERT_UINT64_WITHIN_MESSAGE(20000, time_us, tape.time_us, at_fault);
                TEST_ASSERT_TRUE_MESSAGE(tape.chunks.damages > 0 || at + 600 > size, at_fault);
            }
        }
    }
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
    play_whole();
    TEST_ASSERT_EQUAL_UINT64(500, tape.stream.packets);
}

void test_a_scan_stays_until_the_next(void)
{
    row_tell("turn turn turn scan scan", tell);
    const tmini_scan_t scan = tape.stream.scan;
    tmini_point_t points[161];
    memcpy(points, scan.points, sizeof points);
    finish();
    TEST_ASSERT_EQUAL_PTR(scan.points, tape.stream.scan.points);
    TEST_ASSERT_EQUAL_MEMORY(points, scan.points, sizeof points);
}
