/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* `tmini decode` prints what the reference decoder finds, for intact and for damaged recordings.
 * Also tested: its messages when there is nothing to decode. */

#define _XOPEN_SOURCE 700

#include "corrupt.h"
#include "encoder.h"
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

/* The expected rows. */
static char expected[TEXT_MAX];
static size_t expected_length;
static unsigned packets;
static unsigned scans;
static unsigned samples;
static char frequency[16];

/* For shell commands: the path may contain any characters. */
void setUp(void)
{
    (void)setenv("TOOL", TMINI, 1);
}

void tearDown(void)
{
    program_clean_up();
}

static void load(const char *name)
{
    char path[100];
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
    if (item->starts_revolution) {
        const unsigned tenths = item->bytes[2] >> 1; /* Section 7. */
        scans++;
        (void)snprintf(frequency, sizeof frequency, "%u.%u0", tenths / 10, tenths % 10);
        frequency[tenths == 0 ? 0 : strlen(frequency)] = '\0';
    }
    for (unsigned i = 0; i < item->lsn; i++) {
        const reference_point_t point = reference_point(item->bytes, i);
        const uint32_t millionths = point.angle_q6 * UINT32_C(15625);
        expect("%u,%u,%u,%" PRIu32 ".%06" PRIu32 ",%u,%u,%u,%u,%s\n", scans, packets, i,
               millionths / 1000000, millionths % 1000000, point.distance_mm, point.intensity,
               point.flag, samples / 4, frequency);
    }
    packets++;
    samples += item->lsn; /* 4000 per second, so they give the time. */
}

/* Decodes `bytes` with both decoders and compares rows and counters. */
static void compare(unsigned max_samples)
{
    const reference_options_t options = {.max_samples = max_samples};
    char limit[8];
    char stats[400];
    (void)snprintf(limit, sizeof limit, "%u", max_samples);
    expected_length = packets = scans = samples = 0;
    frequency[0] = '\0';
    expect("scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz\n");
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

/* The false header claims 80 samples, but the recording ends earlier: the bytes after the header
 * are parsed again. */
void test_a_packet_after_a_false_header_at_the_end_is_found(void)
{
    static const uint8_t header[10] = {0xAA, 0x55, 0, 80, 1, 0, 1, 0, 0, 0};
    load("manual-packet.bin");
    memmove(bytes + sizeof header, bytes, size);
    memcpy(bytes, header, sizeof header);
    size += sizeof header;
    program_write_file(program_path("tail.bin"), bytes, size);
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini((const char *const[]){"decode", program_path("tail.bin"), "--csv", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n0,0,18,0.765625,11135,1,2,0,\n"));
    TEST_ASSERT_EQUAL_STRING("packets 1, start packets 0, points 19, checksum errors 0, bytes 77, "
                             "bytes skipped 10\n",
                             program_errors);
}

void test_a_recording_can_come_from_standard_input(void)
{
    load("manual-packet.bin");
    program_write_file(program_path("input"), bytes, size);
    const int status = program_tmini_from(program_path("input"),
                                          (const char *const[]){"decode", "-", "--csv", NULL});

    TEST_ASSERT_EQUAL_INT(0, status);
    /* The manual's packet: 339.15625 degrees to 0.765625 degrees. */
    static const char first_rows[] =
        "scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz\n"
        "0,0,0,339.156250,11842,1,0,0,\n"
        "0,0,1,340.359375,11819,1,0,0,\n";
    TEST_ASSERT_EQUAL_STRING_LEN(first_rows, program_output, sizeof first_rows - 1);
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n0,0,18,0.765625,11135,1,2,0,\n"));
    TEST_ASSERT_EQUAL_STRING("packets 1, start packets 0, points 19, checksum errors 0, bytes 67, "
                             "bytes skipped 0\n",
                             program_errors);
}

/* A start packet, a packet with three points, and the next start packet. */
static void make_one_scan(uint8_t ct)
{
    const encode_sample_t samples[3] = {{1000, 10, 0}, {0, 0, 0}, {3000, 30, 2}};
    const encode_packet_t start = {ct, 1, 0, 0, samples};
    const encode_packet_t packet = {0, 3, 224, 22912, samples}; /* 3.5 degrees to 358. */
    size = encode_packet(bytes, &start);
    size += encode_packet(bytes + size, &packet);
    size += encode_packet(bytes + size, &start);
    program_write_file(program_path("one.bin"), bytes, size);
}

void test_json_is_an_object_per_line_for_each_scan(void)
{
    make_one_scan(121);
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"decode", program_path("one.bin"),
                                                                 "--json", "--quiet", NULL}));
    TEST_ASSERT_EQUAL_STRING(
        "{\"scan\":1,\"time_ms\":0,\"frequency_hz\":6.00,\"complete\":true,\"packets\":2,"
        "\"gaps\":0,\"dropped\":0,\"checksum_errors\":0,\"faults\":null,\"points\":["
        "[0.000000,1000,10,0],[3.500000,1000,10,0],[180.750000,0,0,0],[358.000000,3000,30,2]]}\n"
        "{\"scan\":2,\"time_ms\":1,\"frequency_hz\":6.00,\"complete\":false,\"packets\":1,"
        "\"gaps\":0,\"dropped\":0,\"checksum_errors\":0,\"faults\":null,\"points\":["
        "[0.000000,1000,10,0]]}\n",
        program_output);
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

void test_json_reports_the_health_bits_when_the_unit_does(void)
{
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"decode", RECORDINGS "sim-6hz.bin",
                                                                 "--json", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\"faults\":0,"));
}

static void summarise(const char *path)
{
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"decode", path, NULL}));
}

static void expect_summary(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_output, text), program_output);
}

void test_without_a_format_a_person_gets_a_summary(void)
{
    summarise(RECORDINGS "sim-6hz.bin");
    expect_summary(
        "scans       8 complete; the next one has begun\n"); /* Nothing is "cut short". */
    expect_summary("points      7133, 6934 of them with a distance; 1037 before the first start");
    expect_summary("frequency   3.9 Hz to 6.0 Hz\n");
    expect_summary(" deg, behind right (scan 8)\n");
    expect_summary("0 wrong checksums, 0 stray bytes between packets\n");
    expect_summary("health      healthy\n");
    expect_summary("made on 2026-03-17, serial 2026031700012345\n");
}

void test_what_a_damaged_recording_does_not_tell_is_unknown(void)
{
    /* The unit reports its health, but no turn is complete. */
    summarise(RECORDINGS "sim-6hz-damaged.bin");
    expect_summary("health      unknown: no revolution arrived whole\n");
    expect_summary(" packets damaged (");
    summarise(RECORDINGS "sim-10hz-plain.bin");
    expect_summary("health      not reported: this unit sends no information within the stream\n");
}

/* A recording of `count` packets of one sample, with `gap` other bytes somewhere between them. */
static void summarise_damage(unsigned count, size_t gap)
{
    const encode_sample_t sample = {1000, 10, 0};
    const encode_packet_t packet = {0, 1, 224, 224, &sample};
    TEST_ASSERT_TRUE(count * 13u + gap <= sizeof bytes);
    size = 0;
    for (unsigned i = 0; i < count; i++) {
        size += encode_packet(bytes + size, &packet);
        memset(bytes + size, 0, i == 0 ? gap : 0);
        size += i == 0 ? gap : 0;
    }
    program_write_file(program_path("gap.bin"), bytes, size);
    summarise(program_path("gap.bin"));
}

/* A gap counts as one damaged packet per 130 bytes, rounded, but at least as one. */
void test_the_bytes_of_a_gap_show_how_many_packets_are_damaged(void)
{
    summarise_damage(3, 1);
    expect_summary(", 1 stray byte between packets: about 1 packet damaged (25.0 %)\n");
    summarise_damage(3, 194);
    expect_summary(", 194 stray bytes between packets: about 1 packet damaged (25.0 %)\n");
    summarise_damage(3, 195);
    expect_summary(", 195 stray bytes between packets: about 2 packets damaged (40.0 %)\n");
    summarise_damage(3, 324);
    expect_summary(": about 2 packets damaged (40.0 %)\n");
    summarise_damage(3, 325);
    expect_summary(": about 3 packets damaged (50.0 %)\n");
}

void test_a_small_share_of_damage_is_rounded_but_never_to_nothing(void)
{
    summarise_damage(665, 1); /* 1 of 666 is 0.1502 %. */
    expect_summary(": about 1 packet damaged (0.2 %)\n");
    summarise_damage(666, 1); /* 1 of 667 is 0.1499 %. */
    expect_summary(": about 1 packet damaged (0.1 %)\n");
    summarise_damage(1999, 1); /* 1 of 2000 is 0.05 %. */
    expect_summary(": about 1 packet damaged (0.1 %)\n");
    summarise_damage(2000, 1);
    expect_summary(": about 1 packet damaged (under 0.1 %)\n");
    summarise_damage(2000, 0);
    expect_summary(", 0 stray bytes between packets\n");
}

void test_a_frequency_that_was_not_reported_is_unknown(void)
{
    make_one_scan(1);
    summarise(program_path("one.bin"));
    expect_summary("frequency   unknown\n");
    TEST_ASSERT_NULL(strstr(program_output, "0.0 Hz"));
}

/* Repeats a recording of the simulated lidar. */
static void make_big_recording(size_t wanted)
{
    load("sim-6hz.bin");
    FILE *const file = fopen(program_path("big.bin"), "wb");
    TEST_ASSERT_NOT_NULL(file);
    for (size_t written = 0; written < wanted; written += size) {
        TEST_ASSERT_EQUAL_size_t(size, fwrite(bytes, 1, size, file));
    }
    fclose(file);
}

void test_a_missing_file_is_named(void)
{
    program_expect_failure(1, "nowhere.bin: No such file",
                           (const char *const[]){"decode", "nowhere.bin", NULL});
    program_expect_failure(1, "nowhere.bin: No such file",
                           (const char *const[]){"plot", "nowhere.bin", "-o", "x.svg", NULL});
}

void test_an_empty_file_and_one_that_is_no_recording_have_different_messages(void)
{
    program_write_file(program_path("empty"), "", 0);
    program_expect_failure(1, "is empty",
                           (const char *const[]){"decode", program_path("empty"), NULL});
    program_expect_failure(1, "no lidar packet in",
                           (const char *const[]){"decode", RECORDINGS "README.md", "--csv", NULL});
    TEST_ASSERT_EQUAL_STRING(
        "scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz\n",
        program_output);
    program_expect_failure(
        1, "no lidar packet in",
        (const char *const[]){"plot", RECORDINGS "README.md", "-o", "x.svg", NULL});
}

void test_a_folder_cannot_be_decoded(void)
{
    program_expect_failure(1, "Is a directory", (const char *const[]){"decode", RECORDINGS, NULL});
}

void test_statistics_that_cannot_be_written_are_a_failure(void)
{
    program_expect_failure(1, "cannot write /nowhere/stats",
                           (const char *const[]){"decode", RECORDINGS "sim-6hz.bin", "--csv",
                                                 "--stats", "/nowhere/stats", NULL});
}

/* `head` closes the pipe early. 141 is the shell's status of a program ended by SIGPIPE. */
void test_a_closed_pipe_ends_the_program_at_once_and_silently(void)
{
    make_big_recording(100000000);
    TEST_ASSERT_EQUAL_INT(0, system("{ \"$TOOL\" decode big.bin --csv 2>errors;"
                                    " echo $? >status; } | head -n 1 >head && rm big.bin"));
    TEST_ASSERT_EQUAL_STRING("141\n", program_read_file(0, program_path("status"), NULL));
    TEST_ASSERT_EQUAL_STRING("", program_read_file(0, program_path("errors"), NULL));
}

void test_it_ends_at_a_closed_pipe_even_if_sigpipe_is_ignored(void)
{
    TEST_ASSERT_EQUAL_INT(0, system("trap '' PIPE && { \"$TOOL\" decode '" RECORDINGS
                                    "sim-6hz.bin' --csv 2>errors; echo $? >status; }"
                                    " | head -n 1 >head"));
    TEST_ASSERT_EQUAL_STRING("141\n", program_read_file(0, program_path("status"), NULL));
}

/* The recording is larger than the memory limit. */
void test_a_long_recording_is_decoded_in_constant_memory(void)
{
    make_big_recording(100000000);
    TEST_ASSERT_EQUAL_INT(0, system(PROGRAM_LIMIT("60000") "\"$TOOL\" decode - <big.bin >summary"));
    const char *const text = program_read_file(0, program_path("summary"), NULL);
    TEST_ASSERT_NOT_NULL(strstr(text, " 812060 packets,"));
    TEST_ASSERT_EQUAL_INT(0, system("rm big.bin"));
}

void test_a_dash_is_standard_output_for_the_counters(void)
{
    make_one_scan(121);
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"decode", program_path("one.bin"),
                                                                 "--stats", "-", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n{\"packets\":3,\"start_packets\":2,"));
}

/* --------------------------------------------------------------------------- timed recordings */

static size_t put_chunk(uint8_t *file, uint32_t delta_us, const uint8_t *content, size_t count)
{
    for (unsigned i = 0; i < 4; i++) {
        file[i] = (uint8_t)(delta_us >> 8 * i);
    }
    file[4] = (uint8_t)count;
    file[5] = (uint8_t)(count >> 8);
    memcpy(file + 6, content, count);
    return 6 + count;
}

/* Three packets, at 0.5, 70.5 and 70.7 seconds, the second one in two chunks. */
static size_t make_timed(uint8_t *file)
{
    static const uint8_t magic[8] = {0x89, 't', 'm', 'i', 'n', 'i', 1, '\n'};
    make_one_scan(121);
    memcpy(file, magic, sizeof magic);
    size_t length = sizeof magic;
    length += put_chunk(file + length, 500000, bytes, 13);
    length += put_chunk(file + length, 20000, bytes + 13, 5);
    length += put_chunk(file + length, 69980000, bytes + 18, 14);
    length += put_chunk(file + length, 200000, bytes + 32, 13);
    return length;
}

void test_a_timed_recording_reports_when_its_packets_came(void)
{
    uint8_t file[200];
    const size_t length = make_timed(file);
    program_write_file(program_path("timed.tmini"), file, length);
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){
                                 "decode", program_path("timed.tmini"), "--csv", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n1,0,0,0.000000,1000,10,0,500,6.00\n"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n1,1,2,358.000000,3000,30,2,70500,6.00\n"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\n2,2,0,0.000000,1000,10,0,70700,6.00\n"));
    TEST_ASSERT_EQUAL_STRING("packets 3, start packets 2, points 5, checksum errors 0, bytes 45, "
                             "bytes skipped 0\n",
                             program_errors);
}

void test_a_timed_recording_may_be_cut_anywhere(void)
{
    uint8_t file[200];
    const size_t length = make_timed(file);
    for (size_t cut = 8; cut < length; cut++) {
        program_write_file(program_path("timed.tmini"), file, cut);
        const int status =
            program_tmini((const char *const[]){"decode", program_path("timed.tmini"), NULL});
        TEST_ASSERT_EQUAL_INT(cut < 8 + 6 + 13 ? 1 : 0, status);
    }
}

void test_wrong_usage_ends_with_2_and_says_why(void)
{
    program_expect_failure(2, "decode what?", (const char *const[]){"decode", NULL});
    program_expect_failure(2, "speed", (const char *const[]){"decode", "--speed", NULL});
    program_expect_failure(2, "See tmini decode --help",
                           (const char *const[]){"decode", "--speed", NULL});
    program_expect_failure(2, "See tmini COMMAND --help", (const char *const[]){"--speed", NULL});
    program_expect_failure(2, "x", (const char *const[]){"decode", "-qx", NULL});
    program_expect_failure(2, "stats", (const char *const[]){"decode", "--stats", NULL});
    program_expect_failure(2, "csv", (const char *const[]){"decode", "--csv=1", NULL});
    program_expect_failure(2, "s", (const char *const[]){"decode", "--s", NULL}); /* Ambiguous. */
    program_expect_failure(2, "no option --port",
                           (const char *const[]){"decode", "--port", "x", NULL});
    program_expect_failure(2, "unexpected \"b\"", (const char *const[]){"decode", "a", "b", NULL});
    program_expect_failure(2, "unexpected \"b\"",
                           (const char *const[]){"decode", "a", "b", "c", NULL});
    program_expect_failure(2, "not both",
                           (const char *const[]){"decode", "a", "--csv", "--json", NULL});
    program_expect_failure(2, "\"0\" is not a number from 1 to 255",
                           (const char *const[]){"decode", "a", "--max-samples", "0", NULL});
    program_expect_failure(2, "\"256\" is not a number",
                           (const char *const[]){"decode", "a", "--max-samples=256", NULL});
}

void test_options_may_be_short_joined_abbreviated_and_anywhere(void)
{
    const char *const room = RECORDINGS "sim-6hz.bin";
    const char *const stats = program_path("stats.json");
    (void)setenv("POSIXLY_CORRECT", "1", 1); /* Makes getopt() stop at the first operand. */
    static const char *const none = NULL;
    const char *const ways[][6] = {
        {"decode", room, "--stats", stats, "-q", none},
        {"decode", "-q", "--sta", stats, room, none},
        {"-q", "--stats", stats, "decode", room, none},
        {"--quiet", "decode", "--stat", stats, "--", room},
    };
    for (size_t i = 0; i < 4; i++) {
        const char *words[7] = {ways[i][0], ways[i][1], ways[i][2], ways[i][3],
                                ways[i][4], ways[i][5], NULL};
        program_write_file(stats, "", 0);
        TEST_ASSERT_EQUAL_INT(0, program_tmini(words));
        TEST_ASSERT_EQUAL_STRING_LEN("{\"packets\":190,", program_read_file(1, stats, NULL), 15);
    }
    (void)unsetenv("POSIXLY_CORRECT");
    program_expect_failure(1, "cannot open -q", (const char *const[]){"decode", "--", "-q", NULL});
}

void test_version_and_help_work_with_and_without_a_command(void)
{
    static const char *const ways[][3] = {
        {"--version", NULL}, {"-V", NULL}, {"scan", "-V", NULL}, {"check", "--vers", NULL}};
    for (size_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(0, program_tmini(ways[i]));
        TEST_ASSERT_EQUAL_STRING_LEN("tmini 1.", program_output, 8);
    }
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"help", "scan", NULL}));
    TEST_ASSERT_EQUAL_STRING_LEN("tmini scan ", program_output, 11);
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"help", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "tmini ports "));
    program_expect_failure(2, "no command \"walk\"", (const char *const[]){"help", "walk", NULL});
}

void test_closed_output_is_a_failure_and_not_another_file(void)
{
    TEST_ASSERT_EQUAL_INT(256, system("\"$TOOL\" decode '" RECORDINGS "sim-6hz.bin' >&- 2>errors"));
    TEST_ASSERT_EQUAL_STRING("tmini: cannot write to standard output\n",
                             program_read_file(0, WORK_DIR "/errors", NULL));
}

void test_a_mistyped_word_is_answered_with_the_one_that_was_meant(void)
{
    program_expect_failure(2, "did you mean tmini scan?", (const char *const[]){"scna", NULL});
    program_expect_failure(2, "did you mean --count?",
                           (const char *const[]){"scan", "--cuont", NULL});
    TEST_ASSERT_EQUAL_INT(0, program_tmini((const char *const[]){"version", NULL}));
}

void test_an_unknown_command_is_answered_by_the_list_of_commands(void)
{
    TEST_ASSERT_EQUAL_INT(2, program_tmini((const char *const[]){"fly", NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "there is no command \"fly\""));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "`tmini help` lists them all"));
    TEST_ASSERT_EQUAL_INT(2, program_tmini((const char *const[]){NULL}));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini record"));
}

void test_every_command_explains_itself(void)
{
    static const char *const commands[] = {"info", "health", "frequency", "reboot",
                                           "scan", "record", "decode",    "plot",
                                           "view", "ports",  "check"};
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
