/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Timed recordings (FILE.tmini), written here from the format's description, with one byte lost,
 * changed or added anywhere: what is read of them. */

#include "recording.h"
#include "simulator.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define NAME "damaged.tmini"
#define FILE_MAX 200000u
#define SECONDS 10u
#define FIRST_CHUNK 150u /* It ends before. */

static uint8_t file[FILE_MAX + 1];
static size_t size;
static recording_t recording;

void setUp(void) {}

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

/* What a lidar sends in ten seconds, read each 5 ms, after a second in which nothing comes. */
static void write_whole(unsigned version)
{
    static const uint8_t start[2] = {0xA5, 0x60};
    static sim_t lidar;
    const sim_config_t config = sim_default_config();
    uint64_t stamp_us = 0;
    sim_init(&lidar, &config);
    sim_receive(&lidar, start, sizeof start, 1000000);
    size = 0;
    for (size_t i = 0; i < 8; i++) {
        put("\x89tmini\x02\n"[i]);
    }
    file[6] = (uint8_t)version;
    for (uint64_t now_us = 1000000; now_us < (SECONDS + 1) * 1000000u; now_us += 5000) {
        uint8_t bytes[512];
        const size_t count = sim_transmit(&lidar, now_us, bytes, sizeof bytes);
        if (count > 0) {
            put_chunk(version, (uint32_t)(now_us - stamp_us), bytes, count);
            stamp_us = now_us;
        }
    }
}

static void write_to(FILE *out, const uint8_t *bytes, size_t count)
{
    if (count > 0) {
        (void)fwrite(bytes, 1, count, out);
    }
}

/* Reads the first bytes of it, then others, then its last ones. */
static void read_back(const uint8_t *first, size_t count, const uint8_t *added, size_t added_count,
                      const uint8_t *last, size_t last_count)
{
    const options_t options = {.operand = NAME};
    FILE *const out = fopen(NAME, "wb");
    TEST_ASSERT_NOT_NULL(out);
    write_to(out, first, count);
    write_to(out, added, added_count);
    write_to(out, last, last_count);
    TEST_ASSERT_EQUAL_INT(0, fclose(out));
    TEST_ASSERT_EQUAL_INT(0, recording_open(&recording, &options));
    while (recording_next(&recording)) {
    }
    recording_close(&recording);
}

typedef enum { DROPPED, CHANGED, ADDED, KINDS } damage_t;

static void read_damaged(size_t at, damage_t damage)
{
    const uint8_t other = (uint8_t)(file[at] ^ 0x55);
    read_back(file, at, &other, damage == DROPPED ? 0 : 1, file + at + (damage == ADDED ? 0 : 1),
              size - at - (damage == ADDED ? 0 : 1));
}

static void expect_one_percent_at_most(unsigned version)
{
    char at_fault[60];
    write_whole(version);
    read_back(file, size, NULL, 0, NULL, 0);
    const count_t packets = recording.stream.packets;
    const uint64_t time_us = recording.time_us;
    TEST_ASSERT_TRUE(packets > 900);
    TEST_ASSERT_EQUAL_UINT64(0, recording.chunks.damages);
    for (size_t at = FIRST_CHUNK; at < size; at += 509) {
        for (damage_t damage = DROPPED; damage < KINDS; damage++) {
            (void)snprintf(at_fault, sizeof at_fault, "version %u, damage %d at %zu", version,
                           damage, at);
            read_damaged(at, damage);
            TEST_ASSERT_TRUE_MESSAGE(recording.stream.packets * 100 >= packets * 99, at_fault);
            TEST_ASSERT_TRUE_MESSAGE(recording.stream.packets <= packets, at_fault);
            if (version == 2) { /* In version 1 a changed pause is one. */
                TEST_ASSERT_UINT64_WITHIN_MESSAGE(20000, time_us, recording.time_us, at_fault);
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

/* But of the last chunk, which may be cut short. */
void test_no_byte_of_version_2_is_lost_silently(void)
{
    write_whole(2);
    for (size_t at = 8; at + 600 < size; at += 607) {
        read_damaged(at, DROPPED);
        TEST_ASSERT_TRUE(recording.chunks.damages >= 1);
    }
}
