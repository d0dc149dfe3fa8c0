/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The host tool and a lidar: each command against the simulated one on a pseudo-terminal, and what is
 * said when there is none, or something else, or when it goes away. */

#define _XOPEN_SOURCE 700

#include "program.h"

#include "unity.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NO_OPTIONS ((const char *const[]){NULL})
#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static const char *port;

void setUp(void) {}

void tearDown(void)
{
    program_clean_up();
}

static void begin(void)
{
    port = program_start_lidar(NO_OPTIONS);
}

static void expect_output(const char *expected, const char *const words[])
{
    const int status = program_tmini(words);
    TEST_ASSERT_EQUAL_STRING(expected, program_output);
    TEST_ASSERT_EQUAL_STRING("", program_errors);
    TEST_ASSERT_EQUAL_INT(0, status);
}

static void expect_failure(int status, const char *reason, const char *const words[])
{
    TEST_ASSERT_EQUAL_INT(status, program_tmini(words));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini: "));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, reason), program_errors);
    TEST_ASSERT_EQUAL_STRING("", program_output);
}

static unsigned count_of(const char *text, const char *part)
{
    unsigned count = 0;
    for (const char *at = strstr(text, part); at != NULL; at = strstr(at + 1, part)) {
        count++;
    }
    return count;
}

/* Waits until the tool has printed so many lines. */
static void wait_for_lines(unsigned lines)
{
    for (int i = 0; i < 1000; i++) {
        if (count_of(program_read_file(0, WORK_DIR "/output", NULL), "\n") >= lines) {
            return;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_FAIL_MESSAGE("the tool prints nothing");
}

/* ------------------------------------------------------------------------------------- commands */

void test_info_names_model_versions_and_serial_number(void)
{
    begin();
    expect_output("model       151 (T-mini Plus)\n"
                  "firmware    1.2\n"
                  "hardware    1\n"
                  "serial      2026031700012345\n",
                  WORDS("info", "-p", port));
    expect_output("{\"model\":151,\"firmware\":\"1.2\",\"hardware\":1,"
                  "\"serial\":\"2026031700012345\"}\n",
                  WORDS("info", "--json", "--port", port));
}

void test_health_of_a_healthy_lidar(void)
{
    begin();
    expect_output("healthy\n", WORDS("health", "-p", port));
    expect_output("{\"healthy\":true,\"faults\":0,\"error_code\":0}\n",
                  WORDS("health", "-p", port, "--json"));
}

static void expect_ill(const char *expected, const char *const words[])
{
    TEST_ASSERT_EQUAL_INT(1, program_tmini(words));
    TEST_ASSERT_EQUAL_STRING(expected, program_output);
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

void test_health_of_a_lidar_with_two_faults(void)
{
    port = program_start_lidar(WORDS("--health", "0x18"));
    expect_ill("faulty: laser feedback (PD), laser drive (LD); error code 24\n",
               WORDS("health", "-p", port));
    expect_ill("{\"healthy\":false,\"faults\":24,\"error_code\":24}\n",
               WORDS("health", "-p", port, "--json"));
}

void test_health_of_a_lidar_that_does_not_turn(void)
{
    port = program_start_lidar(WORDS("--blocked"));
    expect_ill("faulty: encoder (is the rotor blocked?); error code 2\n",
               WORDS("health", "-p", port));
}

void test_a_covered_window_is_told_while_scanning(void)
{
    port = program_start_lidar(WORDS("--covered"));
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("scan", "-p", port, "-n", "8")));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "faulty: data (is the window covered?)"));
}

void test_the_frequency_is_read_set_and_kept(void)
{
    begin();
    expect_output("6.00 Hz\n", WORDS("frequency", "-p", port));
    expect_output("7.50 Hz\n", WORDS("frequency", "7.5", "-p", port));
    expect_output("{\"frequency_hz\":7.50}\n", WORDS("frequency", "-p", port, "--json"));
    expect_output("12.00 Hz\n", WORDS("frequency", "12", "-p", port));
    expect_output("6.00 Hz\n", WORDS("frequency", "6.0", "-p", port));
}

void test_a_frequency_out_of_range_is_refused_before_anything_is_sent(void)
{
    expect_failure(2, "6 to 12 Hz", WORDS("frequency", "5.9", "-p", "/dev/none"));
    expect_failure(2, "6 to 12 Hz", WORDS("frequency", "12.1", "-p", "/dev/none"));
    expect_failure(2, "6 to 12 Hz", WORDS("frequency", "7.55", "-p", "/dev/none"));
    expect_failure(2, "6 to 12 Hz", WORDS("frequency", "nan", "-p", "/dev/none"));
    expect_failure(2, "6 to 12 Hz", WORDS("frequency", "7Hz", "-p", "/dev/none"));
}

void test_a_reboot_sets_the_frequency_back(void)
{
    begin();
    expect_output("9.00 Hz\n", WORDS("frequency", "9", "-p", port));
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("reboot", "-p", port)));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "the lidar is back"));
    expect_output("6.00 Hz\n", WORDS("frequency", "-p", port));
}

void test_scan_prints_a_line_for_each_scan(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("scan", "-p", port, "-n", "4")));
    TEST_ASSERT_EQUAL_UINT(4, count_of(program_output, "\n"));
    /* The nearest thing in the simulated room is the corner of a box, 1.0 m away. */
    const char *const last = strstr(program_output, "scan 4 ");
    TEST_ASSERT_NOT_NULL(last);
    TEST_ASSERT_NOT_NULL(strstr(last, " degrees, behind to the right\n"));
    TEST_ASSERT_NOT_NULL(strstr(last, " Hz "));
}

void test_scan_as_json_is_an_object_a_line(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("scan", "-p", port, "-n", "2", "--json")));
    TEST_ASSERT_EQUAL_STRING_LEN("{\"scan\":1,\"timestamp_ms\":", program_output, 25);
    TEST_ASSERT_NOT_NULL(strstr(program_output, "\"complete\":true,"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "]]}\n{\"scan\":2,"));
    TEST_ASSERT_EQUAL_UINT(2, count_of(program_output, "\n"));
}

void test_scan_as_csv_has_a_row_for_each_point(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("scan", "-p", port, "-n", "2", "--csv")));
    TEST_ASSERT_EQUAL_STRING_LEN("scan,point,angle_deg,distance_mm,intensity,flag\n1,0,",
                                 program_output, 52);
    TEST_ASSERT_TRUE(count_of(program_output, "\n2,") > 600); /* 4000 a second, below 6.7 Hz. */
}

/* Where the lidar's bytes went: from the simulator's own count, which its log ends with. */
void test_a_recording_of_ten_seconds_holds_every_packet(void)
{
    const char *const log = program_path("log");
    const char *const recording = program_path("ten.bin");
    port = program_start_lidar(WORDS("--log", log));
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini(WORDS("record", "-p", port, recording, "--seconds", "10", "--quiet")));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("decode", recording, "--csv", "--quiet", "--stats",
                                                 program_path("stats"))));
    unsigned packets = 0;
    unsigned starts = 0;
    unsigned points = 0;
    unsigned errors = 0;
    unsigned bytes = 0;
    unsigned skipped = 0;
    TEST_ASSERT_EQUAL_INT(
        6, sscanf(program_read_file(0, program_path("stats"), NULL),
                  "{\"packets\":%u,\"start_packets\":%u,\"points\":%u,\"checksum_errors\":%u,"
                  "\"bytes\":%u,\"bytes_skipped\":%u}",
                  &packets, &starts, &points, &errors, &bytes, &skipped));
    TEST_ASSERT_EQUAL_UINT(0, errors);
    TEST_ASSERT_TRUE(points > 39000 && points < 42000); /* 4000 a second. */
    /* The reply to the start command, and one LastCRC before each start packet but the first. */
    TEST_ASSERT_EQUAL_UINT(7 + starts - 1, skipped);
}

void test_a_recording_shows_its_progress_and_its_size(void)
{
    begin();
    const char *const recording = program_path("one.bin");
    size_t size = 0;
    char line[100];
    TEST_ASSERT_EQUAL_INT(0,
                          program_tmini(WORDS("record", "-p", port, recording, "--seconds", "1")));
    (void)program_read_file(0, recording, &size);
    (void)snprintf(line, sizeof line, "\n%zu bytes in ", size);
    TEST_ASSERT_NOT_NULL(strstr(program_errors, line));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, " scans  0 wrong checksums  0 bytes overrun"));
    TEST_ASSERT_TRUE(size > 10000);
}

void test_a_recording_ends_with_ctrl_c_and_is_whole(void)
{
    begin();
    const char *const recording = program_path("interrupted.bin");
    const pid_t tool = program_start_tmini(WORDS("record", "-p", port, recording, "--quiet"));
    (void)poll(NULL, 0, 1500);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("decode", recording)));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "0 stray bytes between packets"));
    TEST_ASSERT_NOT_NULL(
        strstr(program_output, "7 bytes before the first packet, 0 after the last"));
}

void test_plot_of_a_lidar_draws_a_scan(void)
{
    begin();
    const char *const picture = program_path("live.svg");
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", "-p", port, "-o", picture)));
    TEST_ASSERT_NOT_NULL(strstr(program_read_file(0, picture, NULL), ">Scan 4<"));
}

/* --------------------------------------------------------------------------------- Ctrl-C, unplug */

void test_ctrl_c_stops_the_lidar_before_leaving(void)
{
    const char *const log = program_path("log");
    port = program_start_lidar(WORDS("--log", log));
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
    const char *const text = program_read_file(0, log, NULL);
    const char *const start = strstr(text, "A5 60 start");
    TEST_ASSERT_NOT_NULL(start);
    TEST_ASSERT_NOT_NULL(strstr(start, "A5 65 stop"));
    TEST_ASSERT_NOT_NULL(strstr(start, "stopping -> idle"));
}

void test_a_lidar_that_is_still_streaming_is_stopped_first(void)
{
    begin();
    const int line = open(port, O_RDWR | O_NOCTTY);
    TEST_ASSERT_EQUAL_INT(2, (int)write(line, "\xA5\x60", 2));
    (void)poll(NULL, 0, 500);
    expect_output("healthy\n", WORDS("health", "-p", port));
    close(line);
}

void test_a_cable_pulled_while_scanning_is_told(void)
{
    begin();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has gone: the adapter was unplugged"));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "Plug it in"));
}

void test_a_lidar_that_falls_silent_while_scanning_is_told(void)
{
    begin();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    program_freeze_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has fallen silent; starting it again"));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has fallen silent and does not come back"));
}

void test_a_recording_survives_a_pulled_cable(void)
{
    begin();
    const char *const recording = program_path("pulled.bin");
    const pid_t tool = program_start_tmini(WORDS("record", "-p", port, recording, "-q"));
    (void)poll(NULL, 0, 1500);
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has gone"));
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("decode", recording)));
    TEST_ASSERT_NOT_NULL(strstr(program_output, " complete"));
}

/* ------------------------------------------------------------------------------- what can be wrong */

void test_a_command_without_a_port_asks_for_one(void)
{
    static const char *const commands[] = {"info", "health", "frequency", "reboot", "scan"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        expect_failure(2, "-p /dev/ttyUSB0", WORDS(commands[i]));
    }
    expect_failure(2, "-p /dev/ttyUSB0", WORDS("record", "x"));
    expect_failure(2, "record into which file?", WORDS("record", "-p", "x"));
    expect_failure(2, "plot what", WORDS("plot", "-o", "x.svg"));
    expect_failure(2, "plot what", WORDS("plot", "file", "-p", "port", "-o", "x.svg"));
    expect_failure(2, "view what?", WORDS("view"));
}

void test_a_port_that_does_not_exist(void)
{
    expect_failure(1, "there is no such device", WORDS("info", "-p", "/dev/nowhere"));
    expect_failure(1, "/dev/nowhere/deep", WORDS("scan", "-p", "/dev/nowhere/deep"));
}

void test_a_port_that_is_no_serial_device(void)
{
    expect_failure(1, "not a serial port", WORDS("info", "-p", "/dev/null"));
    expect_failure(1, "not a serial port", WORDS("info", "-p", "/tmp"));
    expect_failure(1, "not a serial port", WORDS("info", "-p", RECORDINGS "sim-6hz.bin"));
}

void test_a_port_that_another_program_uses(void)
{
    begin();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(1);
    /* Both have the same files for their output; the second one says something last. */
    TEST_ASSERT_EQUAL_INT(1, program_finish(program_start_tmini(WORDS("info", "-p", port)), 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "another program is using it"));
    (void)program_finish(tool, SIGINT);
}

void test_a_port_that_one_may_not_open(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(0, chmod(port, 0));
    program_give_up_rights(true);
    const int status = program_tmini(WORDS("info", "-p", port));
    program_give_up_rights(false);
    if (status == PROGRAM_CANNOT_START) {
        TEST_IGNORE_MESSAGE("a user without rights cannot run the tool from this folder");
    }
    TEST_ASSERT_EQUAL_INT(1, status);
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "you may not open it"));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "dialout"));
}

void test_a_port_without_a_lidar(void)
{
    port = program_start_talker(NULL, 0);
    expect_failure(1, "not one byte came", WORDS("info", "-p", port));
    expect_failure(1, "its TX goes to the adapter's RX", WORDS("scan", "-p", port));
}

void test_a_lidar_at_the_wrong_baud_rate(void)
{
    /* A receiver at another rate makes some other bytes of what is sent, and no packet. */
    static const uint8_t noise[] = {0x33, 0x4C, 0xF8, 0x00, 0x80, 0x66, 0x99, 0xE6, 0x1E};
    port = program_start_talker(noise, sizeof noise);
    expect_failure(1, "wrong baud rate", WORDS("info", "-p", port));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "but nothing that a T-mini Plus says"));
    expect_failure(1, "wrong baud rate", WORDS("scan", "-p", port));
}

void test_a_lidar_that_sends_but_does_not_hear(void)
{
    size_t size = 0;
    const char *const recording = program_read_file(1, RECORDINGS "sim-6hz.bin", &size);
    port = program_start_talker((const uint8_t *)recording + 7, size - 7);
    expect_failure(1, "does not do what it is told", WORDS("info", "-p", port));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "the adapter's TX"));
}

void test_a_recording_is_not_lost_to_a_lidar_that_does_not_answer(void)
{
    const char *const precious = program_path("precious.bin");
    program_write_file(precious, "gold", 4);
    port = program_start_talker(NULL, 0);
    expect_failure(1, "not one byte came", WORDS("record", "-p", port, precious, "-q"));
    TEST_ASSERT_EQUAL_STRING("gold", program_read_file(0, precious, NULL));
}

void test_a_recording_that_cannot_be_written(void)
{
    begin();
    expect_failure(1, "cannot write /nowhere/x",
                   WORDS("record", "-p", port, "/nowhere/x", "--seconds", "1"));
}
