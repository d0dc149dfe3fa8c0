/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* `tmini decode` from outside: what it prints is what the reference decoder finds, for whole and for
 * damaged recordings; and what it says when there is nothing to decode. */

#include "corrupt.h"
#include "program.h"
#include "reference_decoder.h"

#include "unity.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BYTES_MAX 60000u
#define TEXT_MAX 4000000u

static uint8_t bytes[BYTES_MAX];
static size_t size;

/* The rows that should be printed. */
static char expected[TEXT_MAX];
static size_t expected_length;
static unsigned packets;
static unsigned scans;

void setUp(void) {}

void tearDown(void)
{
    program_clean_up();
}

static void load(const char *name)
{
    char path[500];
    (void)snprintf(path, sizeof path, "%s%s", RECORDINGS, name);
    const char *const content = program_read_file(0, path, &size);
    TEST_ASSERT_TRUE(size > 0 && size <= sizeof bytes);
    memcpy(bytes, content, size);
}

static void expect(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length =
        vsnprintf(expected + expected_length, TEXT_MAX - expected_length, format, arguments);
    va_end(arguments);
    expected_length += (size_t)length;
    TEST_ASSERT_TRUE(expected_length < TEXT_MAX);
}

/* 1/64 degree is 0.015625 degrees. */
static void expect_item(void *context, const reference_item_t *item)
{
    (void)context;
    scans += item->starts_revolution ? 1u : 0u;
    for (unsigned i = 0; i < item->lsn; i++) {
        const reference_point_t point = reference_point(item->bytes, i);
        const uint32_t millionths = point.angle_q6 * UINT32_C(15625);
        expect("%u,%u,%u,%" PRIu32 ".%06" PRIu32 ",%u,%u,%u\n", scans, packets, i,
               millionths / 1000000, millionths % 1000000, point.distance_mm, point.intensity,
               point.flag);
    }
    packets++;
}

/* Decodes `bytes` with both decoders and compares rows and counters. */
static void compare(unsigned max_samples)
{
    const reference_options_t options = {.max_samples = max_samples};
    char limit[8];
    char stats[400];
    (void)snprintf(limit, sizeof limit, "%u", max_samples);
    expected_length = packets = scans = 0;
    expect("scan,packet,point,angle_deg,distance_mm,intensity,flag\n");
    const reference_counts_t counts = reference_decode(bytes, size, &options, expect_item, NULL);
    program_write_file(program_path("damaged.bin"), bytes, size);
    const int status = program_tmini(
        (const char *const[]){"decode", program_path("damaged.bin"), "--csv", "--stats",
                              program_path("stats.json"), "--max-samples", limit, NULL});

    TEST_ASSERT_EQUAL_INT(counts.packets > 0 ? 0 : 1, status);
    TEST_ASSERT_EQUAL_STRING(expected, program_output);
    (void)snprintf(stats, sizeof stats,
                   "{\"packets\":%" PRIu64 ",\"start_packets\":%" PRIu64 ",\"points\":%" PRIu64
                   ",\"checksum_errors\":%" PRIu64 ",\"bytes\":%" PRIu64
                   ",\"bytes_skipped\":%" PRIu64 "}\n",
                   counts.packets, counts.start_packets, counts.points, counts.checksum_errors,
                   counts.bytes, counts.bytes_skipped);
    TEST_ASSERT_EQUAL_STRING(stats, program_read_file(1, program_path("stats.json"), NULL));
}

void test_every_recording_is_decoded_as_the_reference_decoder_does(void)
{
    static const char *const names[] = {"manual-packet.bin", "sim-6hz.bin", "sim-10hz-plain.bin",
                                        "sim-12hz.bin", "sim-6hz-damaged.bin"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        load(names[i]);
        compare(80);
    }
}

void test_damaged_recordings_are_decoded_as_the_reference_decoder_does(void)
{
    random_t random;
    for (unsigned seed = 1; seed <= 60; seed++) {
        random_seed(&random, seed);
        load("sim-6hz.bin");
        size = corrupt_some(&random, 1 + seed, bytes, size, sizeof bytes);
        compare(seed % 3 == 0 ? 255 : seed % 3 == 1 ? 80 : 39);
    }
}

void test_a_recording_cut_anywhere_is_re_examined_to_its_last_byte(void)
{
    for (size_t cut = 300; cut < 440; cut += 3) {
        load("sim-6hz.bin");
        size = cut;
        compare(80);
    }
}

void test_a_recording_can_come_from_standard_input(void)
{
    load("manual-packet.bin");
    program_write_file(program_path("input"), bytes, size);
    const int status = program_tmini_from(program_path("input"),
                                          (const char *const[]){"decode", "-", "--csv", NULL});

    TEST_ASSERT_EQUAL_INT(0, status);
    /* The manual's packet: 339.15625 degrees to 0.765625 degrees. */
    static const char first_rows[] = "scan,packet,point,angle_deg,distance_mm,intensity,flag\n"
                                     "0,0,0,339.156250,11842,1,0\n"
                                     "0,0,1,340.359375,11819,1,0\n";
    TEST_ASSERT_EQUAL_STRING_LEN(first_rows, program_output, sizeof first_rows - 1);
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n0,0,18,0.765625,11135,1,2\n"));
    TEST_ASSERT_EQUAL_STRING("packets 1, start packets 0, points 19, checksum errors 0, bytes 67, "
                             "bytes skipped 0\n",
                             program_errors);
}

void test_json_is_an_object_a_line_for_each_packet(void)
{
    load("sim-6hz.bin");
    size = 7 + 13; /* The reply to the start command, and the first start packet. */
    const uint8_t start[13] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                               0x00, 0x9E, 0x56, 0x15, 0x54, 0x02}; /* Section 9.14. */
    memcpy(bytes + 7, start, sizeof start);
    program_write_file(program_path("one.bin"), bytes, size);
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"decode", program_path("one.bin"),
                                                                 "--json", "--quiet", NULL}));
    TEST_ASSERT_EQUAL_STRING("{\"scan\":1,\"packet\":0,\"start\":true,\"ct\":117,"
                             "\"points\":[[0.484375,149,21,0]]}\n",
                             program_output);
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

void test_without_a_format_a_person_gets_a_summary(void)
{
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini((const char *const[]){"decode", RECORDINGS "sim-6hz.bin", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "scans       8 complete, 1 cut short"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "frequency   4.6 to 6.0 Hz\n"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, " degrees clockwise: behind to the right"));
    TEST_ASSERT_NOT_NULL(
        strstr(program_output, "0 wrong checksums, 0 stray bytes between packets"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "health      healthy\n"));
}

/* Runs a command that must fail, and say why. */
static void expect_failure(int status, const char *reason, const char *const words[])
{
    TEST_ASSERT_EQUAL_INT(status, program_tmini(words));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini: "));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, reason), program_errors);
}

void test_a_missing_file_is_named(void)
{
    expect_failure(1, "nowhere.bin: No such file",
                   (const char *const[]){"decode", "nowhere.bin", NULL});
    expect_failure(1, "nowhere.bin: No such file",
                   (const char *const[]){"plot", "nowhere.bin", "-o", "x.svg", NULL});
}

void test_an_empty_file_is_told_from_one_that_is_no_recording(void)
{
    program_write_file(program_path("empty"), "", 0);
    expect_failure(1, "is empty", (const char *const[]){"decode", program_path("empty"), NULL});
    expect_failure(1, "no lidar packet in",
                   (const char *const[]){"decode", RECORDINGS "README.md", "--csv", NULL});
    TEST_ASSERT_EQUAL_STRING("scan,packet,point,angle_deg,distance_mm,intensity,flag\n",
                             program_output);
    expect_failure(1, "no lidar packet in",
                   (const char *const[]){"plot", RECORDINGS "README.md", "-o", "x.svg", NULL});
}

void test_a_folder_cannot_be_decoded(void)
{
    expect_failure(1, "Is a directory", (const char *const[]){"decode", RECORDINGS, NULL});
}

void test_statistics_that_cannot_be_written_are_a_failure(void)
{
    expect_failure(1, "cannot write /nowhere/stats",
                   (const char *const[]){"decode", RECORDINGS "sim-6hz.bin", "--csv", "--stats",
                                         "/nowhere/stats", NULL});
}

void test_a_reader_that_has_read_enough_is_a_failure_but_costs_no_statistics(void)
{
    const char *const stats = program_path("stats");
    const char *const status = program_path("status");
    program_write_file(stats, "", 0);
    TEST_ASSERT_EQUAL_INT(0, system("cd '" WORK_DIR "' && { '" TMINI "' decode '" RECORDINGS
                                    "sim-6hz.bin' --csv --stats stats 2>errors; echo $? >status; }"
                                    " | head -n 1 >head"));
    TEST_ASSERT_EQUAL_STRING("1\n", program_read_file(0, status, NULL));
    TEST_ASSERT_EQUAL_STRING_LEN("{\"packets\":", program_read_file(0, stats, NULL), 11);
}

void test_wrong_usage_ends_with_2_and_says_why(void)
{
    expect_failure(2, "decode what?", (const char *const[]){"decode", NULL});
    expect_failure(2, "no option --speed", (const char *const[]){"decode", "--speed", NULL});
    expect_failure(2, "no option --port", (const char *const[]){"decode", "--port", "x", NULL});
    expect_failure(2, "unexpected \"b\"", (const char *const[]){"decode", "a", "b", NULL});
    expect_failure(2, "not both", (const char *const[]){"decode", "a", "--csv", "--json", NULL});
    expect_failure(2, "\"0\" is not a number from 1 to 255",
                   (const char *const[]){"decode", "a", "--max-samples", "0", NULL});
    expect_failure(2, "\"256\" is not a number",
                   (const char *const[]){"decode", "a", "--max-samples=256", NULL});
    expect_failure(2, "--stats takes a value", (const char *const[]){"decode", "--stats", NULL});
    expect_failure(2, "--csv takes no value", (const char *const[]){"decode", "--csv=1", NULL});
}

void test_an_unknown_command_is_told_which_there_are(void)
{
    TEST_ASSERT_EQUAL_INT(2, program_tmini((const char *const[]){"fly", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "there is no command \"fly\""));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini decode"));
    TEST_ASSERT_EQUAL_INT(2, program_tmini((const char *const[]){NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini record"));
}

void test_every_command_explains_itself(void)
{
    static const char *const commands[] = {"info",   "health", "frequency", "reboot", "scan",
                                           "record", "decode", "plot",      "view"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char usage[40];
        (void)snprintf(usage, sizeof usage, "tmini %s ", commands[i]);
        TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){commands[i], "--help", NULL}));
        TEST_ASSERT_EQUAL_STRING_LEN(usage, program_output, strlen(usage));
        TEST_ASSERT_NOT_NULL(strstr(program_output, "--help"));
        TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"--help", NULL}));
        TEST_ASSERT_NOT_NULL(strstr(program_output, usage));
    }
}
