/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Recordings played from memory: raw ones, and timed ones written here from the format's
 * description, with one byte lost, changed or added anywhere. */

#include "encoder.h"
#include "known_packets.h"
#include "simulator.h"
#include "tape.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define FILE_MAX 200000u
#define SECONDS 10u
#define FIRST_CHUNK 150u /* The first chunk ends before this offset. */

static uint8_t file[FILE_MAX + 1];
static size_t size;
static tape_t tape;
static unsigned scans;

void setUp(void)
{
    size = 0;
    scans = 0;
    tape_begin(&tape, NULL, 0);
}

void tearDown(void) {}

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

static void put_chunk(unsigned version, uint32_t delta_us, const uint8_t *bytes, size_t count)
{
    if (version == 2) {
        put(0xA7);
        put(0xC3);
    }
    put_number(delta_us, 4);
    put_number((uint32_t)count, 2);
    if (version == 2) {
        put_number(crc_of(bytes, count, crc_of(file + size - 6, 6, 0xFFFF)), 2);
    }
    for (size_t i = 0; i < count; i++) {
        put(bytes[i]);
    }
}

static void put_magic(unsigned version)
{
    for (size_t i = 0; i < 8; i++) {
        put("\x89tmini\x02\n"[i]);
    }
    file[6] = (uint8_t)version;
}

/* Ten seconds of a lidar's stream, read every 5 ms, after a second of silence. */
static void write_whole(unsigned version)
{
    static const uint8_t start[2] = {0xA5, 0x60};
    static sim_t lidar;
    const sim_config_t config = sim_default_config();
    uint64_t stamp_us = 0;
    sim_init(&lidar, &config);
    sim_receive(&lidar, start, sizeof start, 1000000);
    put_magic(version);
    for (uint64_t now_us = 1000000; now_us < (SECONDS + 1) * 1000000u; now_us += 5000) {
        uint8_t bytes[512];
        const size_t count = sim_transmit(&lidar, now_us, bytes, sizeof bytes);
        if (count > 0) {
            put_chunk(version, (uint32_t)(now_us - stamp_us), bytes, count);
            stamp_us = now_us;
        }
    }
}

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

static void feed(const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
        const size_t taken = tape_feed(&tape, bytes, count);
        bytes += taken;
        count -= taken;
    }
}

static void finish(void)
{
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    (void)tape_feed(&tape, file, 0);
    TEST_ASSERT_EQUAL_INT(TAPE_END, play());
}

static void play_whole(void)
{
    feed(file, size);
    finish();
}

typedef enum { DROPPED, CHANGED, ADDED, KINDS } damage_t;

static void read_damaged(size_t at, damage_t damage)
{
    const uint8_t other = (uint8_t)(file[at] ^ 0x55);
    tape_begin(&tape, NULL, 0);
    feed(file, at);
    feed(&other, damage == DROPPED ? 0 : 1);
    at += damage == ADDED ? 0 : 1;
    feed(file + at, size - at);
    finish();
}

static void expect_one_percent_at_most(unsigned version)
{
    char at_fault[60];
    write_whole(version);
    play_whole();
    const count_t packets = tape.stream.packets;
    const uint64_t time_us = tape.time_us;
    TEST_ASSERT_TRUE(packets > 900);
    TEST_ASSERT_EQUAL_UINT(0, tape.chunks.damages);
    for (size_t at = FIRST_CHUNK; at < size; at += 509) {
        for (damage_t damage = DROPPED; damage < KINDS; damage++) {
            (void)snprintf(at_fault, sizeof at_fault, "version %u, damage %d at %zu", version,
                           damage, at);
            read_damaged(at, damage);
            TEST_ASSERT_TRUE_MESSAGE(tape.stream.packets * 100 >= packets * 99, at_fault);
            TEST_ASSERT_TRUE_MESSAGE(tape.stream.packets <= packets, at_fault);
            if (version == 2) { /* Version 1 cannot detect a changed pause. */
                TEST_ASSERT_UINT64_WITHIN_MESSAGE(20000, time_us, tape.time_us, at_fault);
            }
        }
    }
}

void test_a_damaged_byte_costs_a_recording_of_version_1_a_hundredth_at_most(void)
{
    expect_one_percent_at_most(1);
}

void test_a_damaged_byte_costs_a_recording_of_version_2_a_hundredth_at_most(void)
{
    expect_one_percent_at_most(2);
}

/* Except in the last chunk, which may be cut short. */
void test_no_byte_of_version_2_is_lost_silently(void)
{
    write_whole(2);
    for (size_t at = 8; at + 600 < size; at += 607) {
        read_damaged(at, DROPPED);
        TEST_ASSERT_TRUE(tape.chunks.damages >= 1);
    }
}

/* ----------------------------------------------------------------------------- what is played */

static void put_bytes(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        put(bytes[i]);
    }
}

/* Quarter 0 is the start packet (6 Hz), the others are a quarter of a turn: 40 samples. */
static size_t packet_of(unsigned quarter, uint8_t packet[ENCODE_PACKET_MAX])
{
    static const encode_sample_t samples[40];
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
    put_bytes(packet, packet_of(quarter, packet));
}

static void put_turn(void)
{
    for (unsigned quarter = 0; quarter <= 4; quarter++) {
        put_packet(quarter);
    }
}

/* The same in chunks, 42 ms apart; the first one comes after `delta_us`. */
static void put_turn_at(uint32_t delta_us)
{
    uint8_t packet[ENCODE_PACKET_MAX];
    for (unsigned quarter = 0; quarter <= 4; quarter++) {
        put_chunk(2, quarter == 0 ? delta_us : 42000, packet, packet_of(quarter, packet));
    }
}

/* A candidate that is incomplete at the end contains a packet. */
void test_at_the_end_the_rest_is_parsed_again(void)
{
    put_bytes((const uint8_t *)"\xAA\x55\x20\x28\x95\xA9\x63\x01\x00\x00", 10);
    put_bytes(manual_packet, sizeof manual_packet);
    feed(file, size);
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.packets);
    (void)tape_feed(&tape, file, 0);
    TEST_ASSERT_EQUAL_INT(TAPE_PACKET, tape_next(&tape));
    TEST_ASSERT_EQUAL_UINT8(19, tape.stream.decoder.packet.count);
    TEST_ASSERT_EQUAL_INT(TAPE_END, tape_next(&tape));
    TEST_ASSERT_EQUAL_INT(TAPE_END, tape_next(&tape));
    TEST_ASSERT_EQUAL_UINT64(77, tape.bytes);
    TEST_ASSERT_EQUAL_UINT64(10, tape_skipped(&tape));
}

void test_bytes_in_no_packet_and_wrong_checksums_are_counted(void)
{
    put_bytes(manual_packet, sizeof manual_packet);
    put_bytes(manual_packet, sizeof manual_packet);
    file[30] ^= 1;
    put(0xAA);
    feed(file, size);
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_EQUAL_UINT64(67, tape_skipped(&tape)); /* The last byte is still pending. */
    finish();
    TEST_ASSERT_EQUAL_UINT64(68, tape_skipped(&tape));
    TEST_ASSERT_EQUAL_UINT64(1, tape_checksum_errors(&tape));
    TEST_ASSERT_EQUAL_UINT64(1, tape.stream.packets);
}

void test_a_file_shorter_than_a_header_is_played_once_it_has_ended(void)
{
    feed(manual_packet, 5);
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_FALSE(tape.is_begun);
    finish();
    TEST_ASSERT_TRUE(tape.is_begun);
    TEST_ASSERT_EQUAL_UINT64(5, tape.bytes);
}

/* A sample takes 250 us: one of the start packet, 40 of each other packet. */
void test_a_raw_recording_has_the_time_of_its_samples(void)
{
    put_packet(0);
    put_packet(1);
    put_packet(2);
    play_whole();
    TEST_ASSERT_EQUAL_UINT64(41 * 250, tape.time_us);
    TEST_ASSERT_EQUAL_UINT32(10, tape.stream.packet_ms);
}

void test_packets_of_more_samples_than_allowed_are_not_taken(void)
{
    tape_begin(&tape, NULL, 39);
    put_turn();
    play_whole();
    TEST_ASSERT_EQUAL_UINT64(1, tape.stream.packets);
}

void test_blocks_of_any_size_give_the_same(void)
{
    for (unsigned turn = 0; turn < 30; turn++) {
        put_turn();
    }
    for (size_t block = 1; block < 2 * size; block = 3 * block + 1) {
        tape_begin(&tape, NULL, 0);
        scans = 0;
        for (size_t at = 0; at < size; at += block) {
            feed(file + at, size - at < block ? size - at : block);
        }
        finish();
        TEST_ASSERT_EQUAL_UINT64(150, tape.stream.packets);
        TEST_ASSERT_EQUAL_UINT(29, scans);
        TEST_ASSERT_EQUAL_UINT64(29, tape.stream.complete);
    }
}

void test_what_came_later_is_not_there_yet(void)
{
    put_magic(2);
    put_turn_at(1000);
    feed(file, size);
    tape.until_us = 999;
    TEST_ASSERT_EQUAL_INT(TAPE_LATER, play());
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.packets);
    tape.until_us = 1000 + 42000;
    TEST_ASSERT_EQUAL_INT(TAPE_LATER, play());
    TEST_ASSERT_EQUAL_UINT64(2, tape.stream.packets);
    tape.until_us = UINT64_MAX;
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_EQUAL_UINT64(5, tape.stream.packets);
}

/* There is room for 32,768 bytes. No byte that was accepted is lost. */
void test_no_more_is_taken_than_there_is_room_for(void)
{
    while (size < 100 * 533) {
        put_turn();
    }
    TEST_ASSERT_EQUAL_size_t(1000, tape_feed(&tape, file, 1000));
    TEST_ASSERT_EQUAL_size_t(31768, tape_feed(&tape, file + 1000, size - 1000));
    TEST_ASSERT_EQUAL_size_t(0, tape_feed(&tape, file + 32768, size - 32768));
    feed(file + 32768, size - 32768);
    finish();
    TEST_ASSERT_EQUAL_UINT64(500, tape.stream.packets);
}

void test_blocks_of_any_size_give_the_same_chunks(void)
{
    put_magic(2);
    for (unsigned turn = 0; turn < 30; turn++) {
        put_turn_at(42000);
    }
    for (size_t block = 1; block < 2 * size; block = 3 * block + 1) {
        tape_begin(&tape, NULL, 0);
        for (size_t at = 0; at < size; at += block) {
            feed(file + at, size - at < block ? size - at : block);
        }
        finish();
        TEST_ASSERT_EQUAL_UINT64(150, tape.stream.packets);
        TEST_ASSERT_EQUAL_UINT64(150 * 42000, tape.time_us);
        TEST_ASSERT_EQUAL_UINT(0, tape.chunks.damages);
    }
}

/* The program that wrote the file was ended. The last chunk has two packets of 67 bytes. */
static void play_cut(unsigned version)
{
    const size_t head = version == 1 ? 6 : 10;
    uint8_t packets[2 * sizeof manual_packet];
    memcpy(packets, manual_packet, sizeof manual_packet);
    memcpy(packets + sizeof manual_packet, manual_packet, sizeof manual_packet);
    size = 0;
    put_magic(version);
    put_chunk(version, 1000, manual_packet, sizeof manual_packet);
    const size_t last = size;
    put_chunk(version, 1000, packets, sizeof packets);
    for (size_t end = last; end <= size; end++) {
        const size_t left = end > last + head ? end - last - head : 0;
        tape_begin(&tape, NULL, 0);
        feed(file, end);
        finish();
        TEST_ASSERT_EQUAL_UINT(0, tape.chunks.damages);
        TEST_ASSERT_EQUAL_UINT64(1 + left / 67, tape.stream.packets);
        TEST_ASSERT_EQUAL_UINT64(67 + left, tape.bytes);
    }
}

void test_a_recording_of_version_1_that_ends_anywhere_in_a_chunk_is_not_damaged(void)
{
    play_cut(1);
}

void test_a_recording_of_version_2_that_ends_anywhere_in_a_chunk_is_not_damaged(void)
{
    play_cut(2);
}

/* While the next chunk is looked for, the lidar's bytes are passed on, down to the last. */
void test_a_recording_may_end_in_a_damaged_place(void)
{
    put_magic(1);
    put_number(0xFFFFFFFF, 4);
    put_bytes(manual_packet, sizeof manual_packet);
    play_whole();
    TEST_ASSERT_EQUAL_UINT(1, tape.chunks.damages);
    TEST_ASSERT_EQUAL_UINT64(1, tape.stream.packets);
    TEST_ASSERT_EQUAL_UINT64(71, tape.bytes);
}

/* ---------------------------------------------------------------------- what a stream reports */

static void put_garbage(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        put(0);
    }
}

/* In units of 130 bytes, rounded: 194 bytes are one packet, 195 are two; at least one. */
void test_damage_is_counted_in_packets(void)
{
    static const unsigned bytes[] = {1, 64, 194, 195};
    static const unsigned packets[] = {1, 1, 1, 2};
    for (unsigned i = 0; i < 4; i++) {
        setUp();
        put_packet(1);
        put_garbage(bytes[i]);
        put_packet(2);
        put_garbage(7);
        put_packet(3);
        play_whole();
        TEST_ASSERT_EQUAL_UINT64(bytes[i] + 7, tape.stream.stray_bytes);
        TEST_ASSERT_EQUAL_UINT64(packets[i] + 1, tape.stream.damaged);
    }
    TEST_ASSERT_EQUAL_UINT(500, stream_damaged_permille(&tape.stream));
}

/* 0 of 0 and 1 of 16 packets are damaged. */
void test_the_damaged_share_is_rounded(void)
{
    TEST_ASSERT_EQUAL_UINT(0, stream_damaged_permille(&tape.stream));
    tape.stream.packets = 15;
    tape.stream.damaged = 1;
    TEST_ASSERT_EQUAL_UINT(63, stream_damaged_permille(&tape.stream));
}

void test_what_precedes_the_first_packet_is_no_damage(void)
{
    put_garbage(300);
    put_packet(1);
    play_whole();
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.stray_bytes);
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.damaged);
    TEST_ASSERT_EQUAL_UINT64(300, tape_skipped(&tape));
}

/* Two bytes before a start packet are damage. */
void test_one_byte_before_a_start_packet_is_a_last_crc(void)
{
    for (unsigned count = 1; count <= 2; count++) {
        setUp();
        put_turn();
        put_garbage(count);
        put_turn();
        play_whole();
        TEST_ASSERT_EQUAL_UINT64(count == 1 ? 1 : 0, tape.stream.last_crc_bytes);
        TEST_ASSERT_EQUAL_UINT64(count == 1 ? 0 : 2, tape.stream.stray_bytes);
    }
}

/* The 66 s before the first packet are no pause. */
void test_the_longest_pause_is_between_two_packets(void)
{
    put_magic(2);
    put_turn_at(66000000);
    put_turn_at(70000);
    play_whole();
    TEST_ASSERT_EQUAL_UINT32(70, tape.stream.longest_ms);
    TEST_ASSERT_EQUAL_UINT64(1, tape.stream.complete);
}

void test_a_pause_may_be_longer_than_a_minute(void)
{
    put_magic(2);
    put_turn_at(0);
    put_turn_at(66000000);
    play_whole();
    TEST_ASSERT_EQUAL_UINT32(66000, tape.stream.longest_ms);
    TEST_ASSERT_EQUAL_UINT32(66336, tape.stream.packet_ms);
}

/* The start packet's CT has 60, which is 6.00 Hz. */
void test_the_frequency_is_that_of_the_latest_start_packet(void)
{
    put_packet(4);
    feed(file, size);
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_EQUAL_UINT(0, tape.stream.frequency_chz);
    size = 0;
    put_packet(0);
    put_packet(1);
    play_whole();
    TEST_ASSERT_EQUAL_UINT(600, tape.stream.frequency_chz);
}

/* Units without LastCRC (section 9.1) report nothing; this is known after a whole turn. */
void test_a_unit_may_report_nothing_in_the_stream(void)
{
    put_turn();
    put_packet(0);
    feed(file, size - 13);
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_FALSE(stream_reports_nothing(&tape.stream));
    feed(file + size - 13, 13);
    TEST_ASSERT_EQUAL_INT(TAPE_NEEDS_BYTES, play());
    TEST_ASSERT_TRUE(stream_reports_nothing(&tape.stream));
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULTS_UNKNOWN, stream_faults(&tape.stream));
    tape.stream.last_crc_bytes = 1; /* LastCRC has come, so a report may follow. */
    TEST_ASSERT_FALSE(stream_reports_nothing(&tape.stream));
}

/* The simulated lidar sends LastCRC, and is healthy. */
void test_a_unit_may_report_its_health_in_the_stream(void)
{
    write_whole(2);
    play_whole();
    TEST_ASSERT_EQUAL_UINT(0, stream_faults(&tape.stream));
    TEST_ASSERT_FALSE(stream_reports_nothing(&tape.stream));
    TEST_ASSERT_EQUAL_UINT64(tape.stream.start_packets - 1, tape.stream.last_crc_bytes);
    TEST_ASSERT_EQUAL_UINT64(tape.stream.last_crc_bytes, tape.stream.confirmed);
}

/* ----------------------------------------------------------------------------- what is a scan */

void test_a_scan_has_the_number_of_its_start_packet(void)
{
    put_packet(4); /* Before the first start packet. */
    put_turn();
    put_turn();
    put_packet(0);
    feed(file, size);
    for (unsigned number = 1; number <= 2; number++) {
        while (tape_next(&tape) != TAPE_SCAN) {
        }
        TEST_ASSERT_EQUAL_UINT64(number, tape.stream.number);
        TEST_ASSERT_EQUAL_UINT16(161, tape.stream.scan.count);
        TEST_ASSERT_TRUE(tape.stream.scan.complete);
    }
    TEST_ASSERT_EQUAL_UINT64(40, tape.stream.points_before);
}

void test_a_scan_stays_until_the_next(void)
{
    put_turn();
    put_turn();
    put_turn();
    feed(file, size);
    for (unsigned i = 0; i < 2; i++) {
        while (tape_next(&tape) != TAPE_SCAN) {
        }
    }
    const tmini_scan_t scan = tape.stream.scan;
    tmini_point_t points[161];
    memcpy(points, scan.points, sizeof points);
    finish();
    TEST_ASSERT_EQUAL_PTR(scan.points, tape.stream.scan.points);
    TEST_ASSERT_EQUAL_MEMORY(points, scan.points, sizeof points);
}

/* A scan of 161 points, then 41 points of one that the end cuts off. */
void test_the_end_leaves_the_rest_of_a_scan_once(void)
{
    put_turn();
    put_packet(0);
    put_packet(1);
    play_whole();
    TEST_ASSERT_EQUAL_UINT(1, scans);
    TEST_ASSERT_TRUE(stream_end(&tape.stream));
    TEST_ASSERT_EQUAL_UINT64(2, tape.stream.number);
    TEST_ASSERT_EQUAL_UINT16(41, tape.stream.scan.count);
    TEST_ASSERT_FALSE(tape.stream.scan.complete);
    TEST_ASSERT_FALSE(stream_end(&tape.stream));
    TEST_ASSERT_EQUAL_INT(TAPE_END, play());
}

void test_a_start_packet_and_then_a_pause_is_no_scan(void)
{
    uint8_t packet[ENCODE_PACKET_MAX];
    put_magic(2);
    put_turn_at(0);
    put_chunk(2, 42000, packet, packet_of(0, packet));
    put_turn_at(1001000); /* After a pause of more than a second. */
    put_turn_at(42000);
    play_whole();
    TEST_ASSERT_EQUAL_UINT(2, scans);
    TEST_ASSERT_EQUAL_UINT64(2, tape.stream.complete);
    TEST_ASSERT_EQUAL_UINT64(3, tape.stream.number);
    TEST_ASSERT_EQUAL_UINT32(1001, tape.stream.longest_ms);
}

void test_a_start_packet_is_not_joined_with_what_comes_after_a_pause(void)
{
    uint8_t packet[ENCODE_PACKET_MAX];
    put_magic(2);
    put_chunk(2, 0, packet, packet_of(0, packet));
    put_chunk(2, 1001000, packet, packet_of(1, packet));
    play_whole();
    TEST_ASSERT_EQUAL_UINT32(1001, tape.stream.longest_ms);
    TEST_ASSERT_TRUE(stream_end(&tape.stream));
    TEST_ASSERT_EQUAL_UINT16(1, tape.stream.scan.packets);
}

/* The angles fit together, but whole turns may be missing in the pause. */
void test_a_scan_does_not_go_on_after_a_pause(void)
{
    uint8_t packet[ENCODE_PACKET_MAX];
    for (uint32_t pause_us = 1000000; pause_us <= 1001000; pause_us += 1000) {
        setUp();
        put_magic(2);
        put_chunk(2, 0, packet, packet_of(0, packet));
        put_chunk(2, 42000, packet, packet_of(1, packet));
        put_chunk(2, pause_us, packet, packet_of(2, packet));
        play_whole();
        TEST_ASSERT_EQUAL_UINT(pause_us > 1000000 ? 1 : 0, scans);
    }
}

/* 70,000 unreadable bytes come twice: the packets before and after them must not be joined. */
void test_a_scan_does_not_go_on_after_unreadable_bytes(void)
{
    put_packet(0);
    put_packet(1);
    for (unsigned quarter = 2; quarter <= 3; quarter++) {
        for (unsigned i = 0; i < 70000; i++) {
            put(0);
        }
        put_packet(quarter);
    }
    play_whole();
    TEST_ASSERT_EQUAL_UINT64(4, tape.stream.packets);
    TEST_ASSERT_EQUAL_UINT(1, scans);
    TEST_ASSERT_TRUE(stream_end(&tape.stream));
    TEST_ASSERT_EQUAL_UINT16(1, tape.stream.scan.packets);
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.damaged); /* How many packets is unknown. */
}

/* Computed backwards from the packets, the first sample would be before the recording's
 * beginning. */
void test_no_scan_begins_before_the_recording(void)
{
    put_packet(0);
    put_garbage(600);
    put_packet(1);
    put_packet(2);
    play_whole();
    TEST_ASSERT_TRUE(stream_end(&tape.stream));
    TEST_ASSERT_EQUAL_UINT16(2, tape.stream.scan.packets);
    TEST_ASSERT_EQUAL_UINT32(0, tape.stream.scan.start_ms);
}

void test_a_mount_turns_scans_once(void)
{
    const tmini_mount_t mount = {.front_q6 = 90 * 64};
    tape_begin(&tape, &mount, 0);
    put_turn();
    put_packet(0);
    play_whole();
    TEST_ASSERT_EQUAL_UINT(1, scans);
    TEST_ASSERT_EQUAL_UINT16(17280,
                             tape.stream.scan.points[0].angle_q6); /* 0 - 90 degrees is 270. */
}

/* ---------------------------------------------------------------- packets from a driver: live */

/* Passes on a packet from the library's parser. The driver marks a doubtful packet by its gap. */
static bool come(unsigned quarter, bool is_doubted, uint32_t now_ms)
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

void test_a_stream_begins_empty(void)
{
    memset(&tape.stream, 0xFF, sizeof tape.stream);
    stream_init(&tape.stream, NULL);
    TEST_ASSERT_FALSE(come(1, false, 5000));
    TEST_ASSERT_EQUAL_UINT64(1, tape.stream.packets);
    TEST_ASSERT_EQUAL_UINT64(40, tape.stream.points_before);
    TEST_ASSERT_EQUAL_UINT32(0, tape.stream.longest_ms);
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULTS_UNKNOWN, stream_faults(&tape.stream));
}

/* After a pause all packets of a batch may be doubtful: the first one begins a new scan, and the
 * others belong to it. */
void test_a_doubtful_batch_is_one_scan(void)
{
    TEST_ASSERT_FALSE(come(0, false, 0));
    TEST_ASSERT_FALSE(come(1, false, 42));
    TEST_ASSERT_TRUE(come(2, true, 400));
    TEST_ASSERT_FALSE(come(3, true, 400));
    TEST_ASSERT_FALSE(come(4, false, 440));
    TEST_ASSERT_TRUE(come(0, false, 480));
    TEST_ASSERT_EQUAL_UINT16(3, tape.stream.scan.packets);
    TEST_ASSERT_FALSE(tape.stream.scan.complete);
    TEST_ASSERT_EQUAL_UINT64(2, tape.stream.scans);
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.complete);
    TEST_ASSERT_EQUAL_UINT64(0, tape.stream.damaged);
}

void test_a_pause_also_ends_a_doubtful_scan(void)
{
    TEST_ASSERT_FALSE(come(0, false, 0));
    TEST_ASSERT_FALSE(come(1, false, 42));
    TEST_ASSERT_TRUE(come(2, true, 400));
    TEST_ASSERT_FALSE(come(3, true, 400));
    TEST_ASSERT_TRUE(come(4, true, 1401));
}

void test_what_was_interrupted_is_no_scan(void)
{
    TEST_ASSERT_FALSE(come(0, false, 0));
    TEST_ASSERT_FALSE(come(1, false, 42));
    stream_break(&tape.stream);
    TEST_ASSERT_FALSE(come(2, false, 84));
    TEST_ASSERT_FALSE(stream_end(&tape.stream));
}

/* 40 samples take 10 ms. Packets that come together are dated 11 ms apart, so that those that come
 * in time catch up by 1 ms each. */
void test_packets_that_come_late_get_the_times_at_which_they_were_sent(void)
{
    static const uint32_t came_ms[] = {900, 911, 990, 990, 990, 990};
    static const uint32_t sent_ms[] = {900, 911, 922, 933, 944, 945};
    tape.stream.is_late = true;
    for (unsigned i = 0; i < 6; i++) {
        (void)come(i % 5, false, came_ms[i]);
        TEST_ASSERT_EQUAL_UINT32(sent_ms[i], tape.stream.sent_ms);
    }
    for (uint32_t now_ms = 1000; now_ms <= 1600; now_ms += 10) {
        const uint32_t behind_ms = now_ms < 1440 ? 45 - (now_ms - 990) / 10 : 0;
        (void)come(1, false, now_ms);
        TEST_ASSERT_EQUAL_UINT32(now_ms - behind_ms, tape.stream.sent_ms);
    }
}

void test_a_packet_that_comes_early_gets_the_time_at_which_it_comes(void)
{
    tape.stream.is_late = true;
    (void)come(1, false, 100);
    (void)come(2, false, 110);
    TEST_ASSERT_EQUAL_UINT32(110, tape.stream.sent_ms);
}

void test_a_packet_that_comes_more_than_a_second_late_was_sent_then(void)
{
    for (uint32_t late_ms = 1000; late_ms <= 1001; late_ms++) {
        setUp();
        tape.stream.is_late = true;
        (void)come(1, false, 0);
        (void)come(2, false, 11 + late_ms);
        TEST_ASSERT_EQUAL_UINT32(late_ms == 1000 ? 11 : 1012, tape.stream.sent_ms);
    }
}

void test_without_a_network_packets_are_not_late(void)
{
    (void)come(1, false, 0);
    (void)come(2, false, 500);
    TEST_ASSERT_EQUAL_UINT32(500, tape.stream.sent_ms);
}
