/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Recordings, from bytes to scans: those of the repository (test/recordings/README.md) and, if
 * there is one, that of a real unit. The expected counts come from the simulated lidar's own report
 * and, for the real unit, from the recording's description; none from the library. */

#include "receiver.h"

#include "tmini/parts/tmini_decoder.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define RECORDING_MAX 40000u
#define SCANS_MAX 20u
#define PATH_SIZE 4096u /* Room for any path of the project. */

static uint8_t bytes[RECORDING_MAX];
static size_t size;
static uint8_t memory[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL + 200];
static receiver_t receiver;
static tmini_decoder_t decoder; /* Takes what the receiver finds. */

typedef struct {
    unsigned packets_before_first;
    unsigned starts;
    unsigned points;
    unsigned trusted; /* Revolutions whose CT information was confirmed. */
    unsigned scans;
    tmini_scan_t scan[SCANS_MAX];
} replay_t;

/* Section 1. */
#define BYTES_PER_MS 13u

static replay_t replay;

void setUp(void) {}

void tearDown(void) {}

static bool load(const char *path)
{
    FILE *const file = fopen(path, "rb");
    if (file == NULL) {
        return false;
    }
    size = fread(bytes, 1, sizeof bytes, file);
    TEST_ASSERT_TRUE(size > 0 && size < sizeof bytes);
    fclose(file);
    return true;
}

static void load_own(const char *name)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s%s", RECORDINGS, name);
    TEST_ASSERT_TRUE_MESSAGE(load(path), path);
}

/* --------------------------------------------------------------------------------------- replay */

static void handle_packet(uint32_t now_ms)
{
    const tmini_packet_t *const packet = &receiver.packet;
    replay.points += packet->count;
    replay.starts += tmini_packet_is_start(packet) ? 1 : 0;
    replay.packets_before_first += replay.starts == 0 ? 1 : 0;
    const bool is_end = tmini_decoder_take_packet(&decoder, packet, now_ms);
    replay.trusted += decoder.verdict == TMINI_CT_CONFIRMED ? 1 : 0;
    if (is_end) {
        TEST_ASSERT_TRUE(replay.scans < SCANS_MAX);
        replay.scan[replay.scans++] = decoder.builder.scan;
        TEST_ASSERT_FALSE(tmini_builder_add(&decoder.builder, packet, now_ms));
    }
}

/* Replays everything in chunks of `chunk` bytes, including the bytes left at the end. */
static void replay_in_chunks(size_t chunk)
{
    replay = (replay_t){0};
    decoder = (tmini_decoder_t){0};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&decoder.builder, points,
                                                       sizeof points / sizeof points[0], 0));
    receiver_open(&receiver, memory, sizeof memory, 0);
    for (size_t fed = 0; fed < size; fed += chunk) {
        chunk = chunk < size - fed ? chunk : size - fed;
        receiver_feed(&receiver, &bytes[fed], chunk);
        while (receiver_next(&receiver) == TMINI_FRAME_PACKET) {
            handle_packet((uint32_t)(fed / BYTES_PER_MS));
        }
    }
    while (receiver_next_at_end(&receiver) == TMINI_FRAME_PACKET) {
        handle_packet((uint32_t)(size / BYTES_PER_MS));
    }
}

static void expect_counts(uint32_t packets, unsigned starts, unsigned point_count, uint32_t skipped,
                          uint32_t checksum_errors)
{
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    TEST_ASSERT_EQUAL_UINT32(packets, counters.packets);
    TEST_ASSERT_EQUAL_UINT(starts, replay.starts);
    TEST_ASSERT_EQUAL_UINT(point_count, replay.points);
    TEST_ASSERT_EQUAL_UINT32(skipped, counters.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(checksum_errors, counters.checksum_errors);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
}

/* All scans are complete and have these points, packets and frequencies in 0.1 Hz. */
static void expect_scans(unsigned count, const uint16_t *point_counts, const uint8_t *packets,
                         const uint8_t *frequencies)
{
    TEST_ASSERT_EQUAL_UINT(count, replay.scans);
    for (unsigned i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_UINT16(point_counts[i], replay.scan[i].count);
        TEST_ASSERT_EQUAL_UINT16(packets[i], replay.scan[i].packets);
        TEST_ASSERT_EQUAL_UINT16(frequencies[i] * 10, replay.scan[i].frequency_chz);
        TEST_ASSERT_TRUE(replay.scan[i].complete);
        TEST_ASSERT_EQUAL_UINT16(0, replay.scan[i].gaps);
        TEST_ASSERT_EQUAL_UINT16(0, replay.scan[i].dropped);
        TEST_ASSERT_EQUAL_UINT16(0, replay.scan[i].checksum_errors);
    }
}

/* ----------------------------------------------------------------------------- the repository's */

void test_the_manuals_packet_is_replayed(void)
{
    load_own("manual-packet.bin");
    replay_in_chunks(size);
    expect_counts(1, 0, 19, 0, 0);
    TEST_ASSERT_EQUAL_UINT(0, replay.scans);
}

/* Skipped bytes: the start reply, eight LastCRC and the last packet, which is cut. */
static void expect_six_hertz(void)
{
    static const uint16_t counts[8] = {873, 699, 665, 669, 667, 666, 667, 669};
    static const uint8_t packets[8] = {23, 19, 18, 18, 18, 18, 18, 18};
    static const uint8_t frequencies[8] = {46, 57, 60, 60, 60, 60, 60, 60};
    expect_counts(190, 9, 7133, 101, 0);
    TEST_ASSERT_EQUAL_UINT(26, replay.packets_before_first);
    expect_scans(8, counts, packets, frequencies);
    TEST_ASSERT_EQUAL_UINT(8, replay.trusted);
}

void test_a_recording_at_6_hz_is_replayed_whatever_the_chunks(void)
{
    static const size_t chunks[] = {1, 2, 13, 64, 130, 131, 512, 894};
    load_own("sim-6hz.bin");
    for (size_t i = 0; i < sizeof chunks / sizeof chunks[0]; i++) {
        replay_in_chunks(chunks[i]);
        expect_six_hertz();
    }
}

void test_a_recording_at_6_hz_has_all_ct_information(void)
{
    tmini_ct_info_t info;
    load_own("sim-6hz.bin");
    replay_in_chunks(64);
    tmini_ct_read(&decoder.ct, &info);
    TEST_ASSERT_TRUE((info.known & TMINI_KNOWN_SERIAL) != 0);
    TEST_ASSERT_EQUAL_UINT16(2026, info.year);
    TEST_ASSERT_EQUAL_UINT8(3, info.month);
    TEST_ASSERT_EQUAL_UINT8(17, info.day);
    TEST_ASSERT_EQUAL_UINT32(12345, info.number);
    TEST_ASSERT_EQUAL_UINT8(1, info.firmware_major);
    TEST_ASSERT_EQUAL_UINT8(2, info.firmware_minor);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ct_faults(&decoder.ct));
}

void test_a_recording_at_10_hz_of_a_plain_unit_has_scans_but_no_ct_information(void)
{
    static const uint16_t counts[10] = {725, 561, 475, 419, 402, 401, 400, 399, 402, 401};
    static const uint8_t packets[10] = {20, 15, 13, 12, 12, 11, 11, 11, 12, 11};
    static const uint8_t frequencies[10] = {55, 71, 84, 95, 100, 100, 100, 100, 100, 100};
    load_own("sim-10hz-plain.bin");
    replay_in_chunks(100);
    expect_counts(143, 11, 5132, 99, 0);
    expect_scans(10, counts, packets, frequencies);
    TEST_ASSERT_EQUAL_UINT(0, replay.trusted);
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULTS_UNKNOWN, tmini_ct_faults(&decoder.ct));
}

void test_a_recording_at_12_hz_has_scans_and_the_beginning_of_the_ct_information(void)
{
    static const uint16_t counts[12] = {553, 457, 398, 358, 335, 334, 332, 334, 334, 332, 333, 332};
    static const uint8_t packets[12] = {15, 13, 11, 10, 10, 10, 11, 10, 10, 10, 10, 10};
    static const uint8_t frequencies[12] = {72,  88,  101, 112, 119, 120,
                                            120, 120, 120, 120, 120, 120};
    load_own("sim-12hz.bin");
    replay_in_chunks(100);
    expect_counts(149, 13, 5149, 19, 0);
    expect_scans(12, counts, packets, frequencies);
    TEST_ASSERT_EQUAL_UINT(12, replay.trusted);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ct_faults(&decoder.ct));
}

/* 299 packets were sent; each of the 266 that arrived intact is delivered. No revolution arrived
 * intact: each scan has these gaps. */
void test_on_a_bad_line_every_intact_packet_is_replayed(void)
{
    static const uint16_t gaps[14] = {3, 1, 2, 2, 1, 3, 1, 1, 3, 2, 3, 1, 3, 1};
    load_own("sim-6hz-damaged.bin");
    replay_in_chunks(77);
    expect_counts(266, 15, 9832, 4214, 32);
    TEST_ASSERT_EQUAL_UINT(0, replay.trusted);
    TEST_ASSERT_EQUAL_UINT(14, replay.scans);
    for (unsigned i = 0; i < 14; i++) {
        TEST_ASSERT_EQUAL_UINT16(gaps[i], replay.scan[i].gaps);
        TEST_ASSERT_FALSE(replay.scan[i].complete);
    }
}

/* ------------------------------------------------------------------------- what was really sent */

typedef struct {
    unsigned packet, revolution, index, angle_q6, distance_mm, intensity, flag, intact;
} truth_t;

static bool read_truth(FILE *file, truth_t *truth)
{
    return fscanf(file, "%u,%u,%u,%u,%u,%u,%u,%u", &truth->packet, &truth->revolution,
                  &truth->index, &truth->angle_q6, &truth->distance_mm, &truth->intensity,
                  &truth->flag, &truth->intact) == 8;
}

/* The next sample of a packet that arrived intact. */
static bool read_intact(FILE *file, truth_t *truth)
{
    do {
        if (!read_truth(file, truth)) {
            return false;
        }
    } while (truth->intact == 0);
    return true;
}

static void expect_true_points(FILE *file)
{
    for (unsigned i = 0; i < receiver.packet.count; i++) {
        tmini_point_t point;
        truth_t truth;
        TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, i, &point));
        TEST_ASSERT_TRUE(read_intact(file, &truth));
        TEST_ASSERT_EQUAL_UINT(truth.index, i);
        TEST_ASSERT_EQUAL_UINT(truth.angle_q6, point.angle_q6);
        TEST_ASSERT_EQUAL_UINT(truth.distance_mm, point.distance_mm);
        TEST_ASSERT_EQUAL_UINT(truth.intensity, point.intensity);
        TEST_ASSERT_EQUAL_UINT(truth.flag, point.flag);
    }
}

static void expect_truth(const char *name)
{
    char path[PATH_SIZE];
    char header[200];
    truth_t truth;
    (void)snprintf(path, sizeof path, "%s%s.csv", TRUTHS, name);
    FILE *const file = fopen(path, "r");
    if (file == NULL) {
        TEST_IGNORE_MESSAGE("what was sent is not here: the test `recordings` makes it");
    }
    TEST_ASSERT_NOT_NULL(fgets(header, sizeof header, file));
    receiver_open(&receiver, memory, sizeof memory, 0);
    for (size_t fed = 0; fed < size;) {
        const size_t left = size - fed;
        const size_t chunk = left < receiver_room(&receiver) ? left : receiver_room(&receiver);
        receiver_feed(&receiver, &bytes[fed], chunk);
        fed += chunk;
        while (receiver_next(&receiver) == TMINI_FRAME_PACKET) {
            expect_true_points(file);
        }
    }
    TEST_ASSERT_FALSE(read_intact(file, &truth));
    fclose(file);
}

void test_every_sample_is_as_it_was_sent(void)
{
    static const char *const names[] = {"sim-6hz", "sim-10hz-plain", "sim-12hz", "sim-6hz-damaged"};
    for (unsigned i = 0; i < 4; i++) {
        char file[100];
        (void)snprintf(file, sizeof file, "%s.bin", names[i]);
        load_own(file);
        expect_truth(names[i]);
    }
}

/* -------------------------------------------------------------------------------- the real unit */

static void load_real(void)
{
    if (!load(REAL_RECORDINGS "t-mini-plus-room.bin")) {
        TEST_IGNORE_MESSAGE("no recording of a real unit in TMINI_RECORDINGS_DIR");
    }
}

void test_a_real_units_recording_gives_four_complete_scans(void)
{
    static const uint16_t counts[4] = {624, 624, 626, 630};
    static const uint8_t packets[4] = {17, 17, 17, 17};
    static const uint8_t frequencies[4] = {63, 64, 65, 64};
    load_real();
    replay_in_chunks(64);
    expect_counts(89, 5, 3278, 0, 0);
    TEST_ASSERT_EQUAL_UINT(20, replay.packets_before_first);
    expect_scans(4, counts, packets, frequencies);
    TEST_ASSERT_EQUAL_UINT(0, replay.trusted);
    TEST_ASSERT_EQUAL_UINT(TMINI_FAULTS_UNKNOWN, tmini_ct_faults(&decoder.ct));
}
