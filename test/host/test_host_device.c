/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The host tool with a lidar: each command with the simulated one on a pseudo-terminal, and the
 * messages if there is no lidar, another device, or a lidar that disappears. */

#define _XOPEN_SOURCE 700

#include "program.h"

#include "unity.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NO_OPTIONS ((const char *const[]){NULL})
#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static const char *port;

/* --------------------------------------------------------------------------------- background */

/* Runs that wait for many seconds, all at the same time. The tests below check how each ended. */
enum {
    SILENT_INFO,
    SILENT_SCAN,
    SILENT_RECORD,
    NOISY_INFO,
    NOISY_SCAN,
    DEAF_INFO,
    HALF_INFO,
    HALF_SCAN,
    HALF_HEALTH,
    LONG_RECORD,
    REBOOT,
    JOBS
};

static const char *const job_names[JOBS] = {
    "silent_info", "silent_scan", "silent_record", "noisy_info",  "noisy_scan", "deaf_info",
    "half_info",   "half_scan",   "half_health",   "long_record", "reboot"};
static pid_t jobs[JOBS];
static const char *rebooted_port;

static void start_job(unsigned job, const char *const words[])
{
    jobs[job] = program_start_as(job_names[job], words);
}

/* Waits for the end of the job and returns its exit status. */
static int end_job(unsigned job)
{
    return program_finish_as(job_names[job], jobs[job]);
}

/* A receiver with the wrong baud rate receives other bytes than were sent, and no packet. */
static const uint8_t noise[] = {0x33, 0x4C, 0xF8, 0x00, 0x80, 0x66, 0x99, 0xE6, 0x1E};

/* The reply to A5 90: model 151, firmware 1.2, hardware 1, and a serial number. */
static const uint8_t information[27] = {0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, 0x97, 2, 1, 1, 2, 0, 2,
                                        6,    0,    3,    1, 7, 0, 0,    0,    1, 2, 3, 4, 5};

static const char *start_half_a_lidar(void)
{
    return program_start_answerer(0x90, information, sizeof information);
}

/* Once, before the first test. */
static void start_background(void)
{
    size_t size = 0;
    program_begin_background();
    program_write_file(program_path("precious.bin"), "gold", 4);
    start_job(SILENT_INFO, WORDS("info", "-p", program_start_talker(NULL, 0)));
    start_job(SILENT_SCAN, WORDS("scan", "-p", program_start_talker(NULL, 0)));
    start_job(SILENT_RECORD, WORDS("record", "-p", program_start_talker(NULL, 0), "precious.bin"));
    start_job(NOISY_INFO, WORDS("info", "-p", program_start_talker(noise, sizeof noise)));
    start_job(NOISY_SCAN, WORDS("scan", "-p", program_start_talker(noise, sizeof noise)));
    const char *const recording = program_read_file(1, RECORDINGS "sim-6hz.bin", &size);
    start_job(DEAF_INFO,
              WORDS("info", "-p", program_start_talker((const uint8_t *)recording + 7, size - 7)));
    start_job(HALF_INFO, WORDS("info", "-p", start_half_a_lidar()));
    start_job(HALF_SCAN, WORDS("scan", "-p", start_half_a_lidar()));
    start_job(HALF_HEALTH, WORDS("health", "-p", start_half_a_lidar()));
    port = program_start_lidar(WORDS("--log", "long.log"));
    start_job(LONG_RECORD, WORDS("record", "-p", port, "long.bin", "--seconds", "8", "--quiet"));
    rebooted_port = program_start_lidar(WORDS("--frequency", "9"));
    start_job(REBOOT, WORDS("reboot", "-p", rebooted_port));
    program_end_background();
}

void setUp(void)
{
    static bool has_begun;
    (void)unsetenv("TMINI_PORT");
    (void)unsetenv("TMINI_ROOT");
    (void)setenv("TOOL", TMINI, 1);
    if (!has_begun) {
        has_begun = true;
        start_background();
    }
}

void tearDown(void)
{
    program_clean_up();
}

static void begin(void)
{
    port = program_start_lidar(NO_OPTIONS);
}

static void expect_success(const char *const words[])
{
    const int status = program_tmini(words);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, status, program_errors);
}

static void expect_output(const char *expected, const char *const words[])
{
    expect_success(words);
    TEST_ASSERT_EQUAL_STRING(expected, program_output);
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

static void expect_failure(int status, const char *reason, const char *const words[])
{
    program_expect_failure(status, reason, words);
    TEST_ASSERT_EQUAL_STRING("", program_output);
}

/* Waits until the tool has printed this many lines. */
static void wait_for_lines(unsigned lines)
{
    for (int i = 0; i < 1000; i++) {
        if (program_count(program_read_file(0, WORK_DIR "/output", NULL), "\n") >= lines) {
            return;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_FAIL_MESSAGE("the tool prints nothing");
}

/* Waits until the file has this size. */
static void wait_for_bytes(const char *path, size_t wanted)
{
    size_t size = 0;
    for (int i = 0; i < 3000; i++) {
        struct stat status;
        if (stat(path, &status) == 0 && (size_t)status.st_size >= wanted) {
            return;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_ASSERT_EQUAL_size_t(wanted, size);
}

/* ----------------------------------------------------------------------------------- commands */

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
    expect_ill("faulty: PD, LD; error code 24\n", WORDS("health", "-p", port));
    expect_ill("{\"healthy\":false,\"faults\":24,\"error_code\":24}\n",
               WORDS("health", "-p", port, "--json"));
}

void test_health_of_a_lidar_that_does_not_turn(void)
{
    port = program_start_lidar(WORDS("--blocked"));
    expect_ill("faulty: encoder (is the rotor blocked?); error code 2\n",
               WORDS("health", "-p", port));
}

/* `tmini scan && drive` must not drive then. */
void test_a_covered_window_is_reported_while_scanning_and_is_a_failure(void)
{
    port = program_start_lidar(WORDS("--covered"));
    TEST_ASSERT_EQUAL_INT(1, program_tmini(WORDS("scan", "-p", port, "-n", "5")));
    /* The fault needs two revolutions in a row: a busy computer may have lost one of them. */
    if (strstr(program_errors, "scans: 5 complete; ") != NULL) {
        TEST_ASSERT_NOT_NULL(strstr(program_errors, "faulty: data (is the window covered?)"));
    }
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "scans: "));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "; 0 with a distance; "));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "no scan had a distance"));
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

void test_a_frequency_is_lost_in_a_reboot(void)
{
    begin();
    expect_output("9.00 Hz\n", WORDS("frequency", "9", "-p", port));
    expect_output("9.00 Hz\n", WORDS("frequency", "-p", port));
}

void test_scan_prints_a_line_for_each_scan(void)
{
    begin();
    expect_success(WORDS("scan", "-p", port, "-n", "4"));
    TEST_ASSERT_EQUAL_UINT(4, program_count(program_output, "\n"));
    /* The nearest point of the simulated room is the corner of a box, 1.0 m away. */
    const char *const last = strstr(program_output, "scan 4 ");
    TEST_ASSERT_NOT_NULL(last);
    TEST_ASSERT_NOT_NULL(strstr(last, " deg, "));
    TEST_ASSERT_NOT_NULL(strstr(program_output, " Hz ")); /* Unknown if a start packet was lost. */
}

void test_scan_ends_with_a_summary(void)
{
    begin();
    expect_success(WORDS("scan", "-p", port, "-n3"));
    TEST_ASSERT_EQUAL_STRING_LEN("scans: ", program_errors, 7);
    TEST_ASSERT_NOT_NULL(
        strstr(program_errors, "; 3 with a distance; 0.0 % of the packets damaged\n"));
    expect_success(WORDS("scan", "-p", port, "-qn1"));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

void test_scan_as_json_has_the_members_of_decode(void)
{
    begin();
    expect_success(WORDS("scan", "-p", port, "-n", "2", "--json"));
    TEST_ASSERT_EQUAL_STRING_LEN("{\"scan\":1,\"time_ms\":", program_output, 20);
    TEST_ASSERT_NOT_NULL(strstr(program_output, ",\"frequency_hz\":"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, ",\"complete\":"));
    TEST_ASSERT_NOT_NULL(
        strstr(program_output, ",\"dropped\":0,\"checksum_errors\":0,\"faults\":"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "]]}\n{\"scan\":2,"));
    TEST_ASSERT_EQUAL_UINT(2, program_count(program_output, "\n"));
}

void test_scan_as_csv_has_the_columns_of_decode(void)
{
    begin();
    expect_success(WORDS("scan", "-p", port, "-n", "2", "--csv"));
    TEST_ASSERT_EQUAL_STRING_LEN(
        "scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz\n1,",
        program_output, 78);
    TEST_ASSERT_TRUE(program_count(program_output, "\n2,") >
                     100); /* Some 700, or fewer on a busy computer. */
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_output, "\n3,"));
}

/* Live and recorded scans give the same rows, except for the time. */
void test_a_scan_is_the_same_live_and_recorded(void)
{
    begin();
    expect_success(WORDS("record", "-p", port, "rec.tmini", "-q", "-s1"));
    expect_success(WORDS("decode", "rec.tmini", "-q", "--csv"));
    const char *const row = strstr(program_output, "\n1,");
    TEST_ASSERT_NOT_NULL(row);
    unsigned number[9] = {0};
    TEST_ASSERT_EQUAL_INT(9, sscanf(row, "\n%u,%u,%u,%u.%*u,%u,%u,%u,%u,%u", &number[0], &number[1],
                                    &number[2], &number[3], &number[4], &number[5], &number[6],
                                    &number[7], &number[8]));
    TEST_ASSERT_TRUE(number[7] > 100 && number[7] < 60000); /* In ms, since the start command. */
}

/* Compares with the simulator's own counts, with which its log ends. */
void test_a_long_recording_holds_every_packet(void)
{
    TEST_ASSERT_EQUAL_INT(0, end_job(LONG_RECORD));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
    expect_success(
        WORDS("decode", "long.bin", "--csv", "--quiet", "--stats", program_path("stats")));
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
    TEST_ASSERT_TRUE(points > 20000); /* 4000 per second, but on a busy computer less. */
    /* The reply to the start command, and one LastCRC before each start packet but the first. */
    TEST_ASSERT_EQUAL_UINT(7 + starts - 1, skipped);
}

/* A dash means standard output or standard input, so no file is needed. */
void test_a_recording_can_go_through_a_pipe(void)
{
    begin();
    (void)setenv("TMINI_PORT", port, 1);
    TEST_ASSERT_EQUAL_INT(
        0, system("\"$TOOL\" record - --seconds 1 -q | \"$TOOL\" decode - >summary"));
    const char *const text = program_read_file(0, program_path("summary"), NULL);
    TEST_ASSERT_NOT_NULL(strstr(text, "0 stray bytes between packets"));
    TEST_ASSERT_NOT_NULL(strstr(text, "7 bytes before the first packet, 0 after the last"));
}

/* The tool still sends commands to the lidar after the reader has gone. */
void test_a_closed_pipe_ends_a_scan_silently_and_stops_the_lidar(void)
{
    const char *const log = program_path("log");
    (void)setenv("TMINI_PORT", program_start_lidar(WORDS("--log", log)), 1);
    TEST_ASSERT_EQUAL_INT(
        0, system("{ \"$TOOL\" scan 2>errors; echo $? >status; } | head -n 2 >head"));
    TEST_ASSERT_EQUAL_STRING("141\n", program_read_file(0, program_path("status"), NULL));
    TEST_ASSERT_EQUAL_STRING("", program_read_file(0, program_path("errors"), NULL));
    const char *const text = program_wait_for("log", "stopping -> idle");
    TEST_ASSERT_NOT_NULL(strstr(strstr(text, "A5 60 start"), "A5 65 stop"));
}

/* Otherwise the port would be descriptor 1, and the results would be sent to the lidar. */
void test_with_closed_output_nothing_goes_to_the_lidar(void)
{
    const char *const log = program_path("log");
    (void)setenv("TMINI_PORT", program_start_lidar(WORDS("--log", log)), 1);
    TEST_ASSERT_EQUAL_INT(256, system("\"$TOOL\" info <&- >&- 2>errors"));
    TEST_ASSERT_EQUAL_STRING("tmini: cannot write to standard output\n",
                             program_read_file(0, program_path("errors"), NULL));
    TEST_ASSERT_EQUAL_INT(256, system("\"$TOOL\" health >&- 2>&-"));
    /* A stop, because the lidar's state is unknown, and the query. */
    TEST_ASSERT_EQUAL_UINT(4, program_count(program_read_file(0, log, NULL), "command A5"));
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_read_file(0, log, NULL), "unknown"));
}

void test_a_lidar_can_be_reached_through_a_socket(void)
{
    port = program_start_lidar(WORDS("--tcp", "0"));
    TEST_ASSERT_EQUAL_STRING_LEN("tcp:127.0.0.1:", port, 14);
    expect_output("healthy\n", WORDS("health", "-p", port));
    expect_success(WORDS("scan", "-qn2", "-p", port));
    TEST_ASSERT_EQUAL_UINT(2, program_count(program_output, "\n"));
}

void test_a_socket_that_is_closed_is_reported(void)
{
    port = program_start_lidar(WORDS("--tcp", "0"));
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, " has gone: the other end closed"));
    expect_failure(1, "Connection refused", WORDS("info", "-p", port));
}

void test_an_invalid_address_is_reported(void)
{
    expect_failure(1, "tcp:HOST:PORT", WORDS("info", "-p", "tcp:localhost"));
    expect_failure(1, "tcp:HOST:PORT", WORDS("info", "-p", "tcp:"));
    expect_failure(1, "no host of that name", WORDS("info", "-p", "tcp:no.such.host.invalid:1"));
    expect_failure(1, "a number from 1 to 65535", WORDS("info", "-p", "tcp:127.0.0.1:lidar"));
    expect_failure(1, "a number from 1 to 65535", WORDS("info", "-p", "tcp:127.0.0.1:65536"));
    expect_failure(1, "a number from 1 to 65535", WORDS("info", "-p", "tcp:127.0.0.1:0"));
}

void test_a_recording_reports_its_size(void)
{
    begin();
    const char *const recording = program_path("one.bin");
    size_t size = 0;
    char line[100];
    expect_success(WORDS("record", "-p", port, recording, "--seconds", "1"));
    (void)program_read_file(0, recording, &size);
    (void)snprintf(line, sizeof line, " s, %zu bytes; scans: ", size);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, line), program_errors);
    TEST_ASSERT_NOT_NULL(strstr(program_errors, " complete; 0 wrong checksums\n"));
    TEST_ASSERT_TRUE(size > 5000);
    TEST_ASSERT_EQUAL_UINT(1, program_count(program_errors, "\n")); /* Progress is for terminals. */
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_errors, "\r"));
}

void test_a_recording_ends_with_ctrl_c_and_is_whole(void)
{
    begin();
    const char *const recording = program_path("interrupted.bin");
    (void)remove(recording);
    const pid_t tool = program_start_tmini(WORDS("record", "-p", port, recording, "--quiet"));
    wait_for_bytes(recording, 8000);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
    expect_success(WORDS("decode", recording));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "0 stray bytes between packets"));
    TEST_ASSERT_NOT_NULL(
        strstr(program_output, "7 bytes before the first packet, 0 after the last"));
}

void test_plot_of_a_lidar_draws_a_scan(void)
{
    begin();
    const int status = program_tmini(WORDS("plot", "-p", port, "-o", program_path("live.svg")));
    if (strstr(program_errors, "without cairo") != NULL) {
        TEST_IGNORE_MESSAGE("the tool was built without cairo");
    }
    TEST_ASSERT_EQUAL_INT(0, status);
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "live.svg: Scan "));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, " with a distance"));
}

/* ----------------------------------------------------------------------------- Ctrl-C, unplug */

void test_ctrl_c_stops_the_lidar_before_leaving(void)
{
    const char *const log = program_path("log");
    port = program_start_lidar(WORDS("--log", log));
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
    TEST_ASSERT_NULL(strstr(program_errors, "tmini: "));
    const char *const text = program_wait_for("log", "stopping -> idle");
    const char *const start = strstr(text, "A5 60 start");
    TEST_ASSERT_NOT_NULL(start);
    TEST_ASSERT_NOT_NULL(strstr(start, "A5 65 stop"));
}

/* The operating system buffers the lidar's bytes during the pause: they are not lost, and the pause
 * does not lead to scans of single packets. */
void test_a_reader_that_pauses_costs_a_few_scans(void)
{
    (void)setenv("TMINI_PORT", program_start_lidar(NO_OPTIONS), 1);
    TEST_ASSERT_EQUAL_INT(0, system("{ \"$TOOL\" scan --json -n 40 2>errors; echo $? >code; } | "
                                    "(head -c 1000 >head; sleep 3; cat >rest)"));
    TEST_ASSERT_EQUAL_STRING("0\n", program_read_file(0, program_path("code"), NULL));
    TEST_ASSERT_NULL(strstr(program_read_file(0, program_path("errors"), NULL), "silent"));
    const char *const rest = program_read_file(0, program_path("rest"), NULL);
    TEST_ASSERT_TRUE(program_count(rest, "\"complete\":true") >= 30);
    TEST_ASSERT_EQUAL_UINT(0, program_count(rest, "\"packets\":1,"));
}

/* The pipe is almost full, so a line of a scan is written in several pieces, and each write would
 * block forever. */
void test_a_signal_ends_a_scan_whose_reader_stands_still_and_stops_the_lidar(void)
{
    const char *const log = program_path("log");
    (void)setenv("TMINI_PORT", program_start_lidar(WORDS("--log", log)), 1);
    TEST_ASSERT_EQUAL_INT(0, system("(head -c 61440 /dev/zero; sh -c 'echo $$ >tool; exec "
                                    "\"$TOOL\" scan --json --count 10000' 2>errors; "
                                    "echo $? >status) | sleep 90 & echo $! >reader"));
    (void)program_wait_for("log", "-> scanning");
    (void)sleep(1);
    TEST_ASSERT_EQUAL_INT(0, system("kill -TERM \"$(cat tool)\""));
    TEST_ASSERT_NOT_EQUAL(0, atoi(program_wait_for("status", "\n")));
    const char *const text = program_wait_for("log", "stopping -> idle");
    TEST_ASSERT_NOT_NULL(strstr(strstr(text, "A5 60 start"), "A5 65 stop"));
    TEST_ASSERT_EQUAL_INT(0, system("kill \"$(cat reader)\""));
}

/* As with `nohup`. 1.5 s are 19,000 bytes. */
void test_a_signal_that_is_ignored_stays_ignored(void)
{
    size_t size = 0;
    (void)remove(program_path("it.bin"));
    (void)setenv("TMINI_PORT", program_start_lidar(WORDS(NULL)), 1);
    const pid_t tool =
        program_start("/bin/sh", WORDS("-c", "trap '' HUP; exec \"$TOOL\" record -q it.bin "
                                             "--seconds 2"));
    wait_for_bytes(program_path("it.bin"), 1000);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGHUP));
    (void)program_read_file(0, program_path("it.bin"), &size);
    TEST_ASSERT_TRUE(size > 19000);
}

void test_a_file_that_may_not_grow_is_a_failure_and_the_lidar_is_stopped(void)
{
    const char *const log = program_path("log");
    (void)setenv("TMINI_PORT", program_start_lidar(WORDS("--log", log)), 1);
    TEST_ASSERT_EQUAL_INT(256, system("(ulimit -f 8; \"$TOOL\" record short.bin 2>errors)"));
    TEST_ASSERT_NOT_NULL(
        strstr(program_read_file(0, program_path("errors"), NULL), "cannot write short.bin"));
    (void)program_wait_for("log", "stopping -> idle");
}

void test_a_lidar_that_is_still_streaming_is_stopped_first(void)
{
    const char *const log = program_path("log");
    port = program_start_lidar(WORDS("--log", log));
    const int line = open(port, O_RDWR | O_NOCTTY);
    TEST_ASSERT_EQUAL_INT(2, (int)write(line, "\xA5\x60", 2));
    (void)program_wait_for("log", "idle -> scanning");
    expect_output("healthy\n", WORDS("health", "-p", port));
    close(line);
}

/* Runs the tool, and starts the lidar again as soon as the tool has stopped it, as if the stop
 * command had been lost. */
static int run_against_a_stubborn_lidar(const char *command, const char *option)
{
    const char *const log = program_path("log");
    port = program_start_lidar(WORDS("--log", log));
    const int line = open(port, O_RDWR | O_NOCTTY);
    const pid_t tool = program_start_tmini(WORDS(command, "-p", port, option));
    (void)program_wait_for("log", "stopping -> idle");
    TEST_ASSERT_EQUAL_INT(2, (int)write(line, "\xA5\x60", 2));
    const int status = program_finish(tool, 0);
    const char *const text = program_read_file(0, log, NULL);
    const char *const stopped = strstr(text, "stopping -> idle");
    /* If another stop was sent, it stopped the lidar. */
    if (strstr(stopped, "A5 65 stop") != NULL) {
        TEST_ASSERT_NOT_NULL(strstr(strstr(stopped, "A5 65 stop"), "scanning -> stopping"));
    }
    close(line);
    return status;
}

/* On a busy computer the lidar may be started too late: so it is tried up to 5 times. */
void test_a_lidar_that_scans_although_it_was_stopped_is_reported_and_stopped_again(void)
{
    bool is_reported = false;
    for (int i = 0; i < 5 && !is_reported; i++) {
        TEST_ASSERT_EQUAL_INT(0, run_against_a_stubborn_lidar("scan", "-n1"));
        is_reported =
            strstr(program_errors, "scans although it was stopped; stopping it again") != NULL;
    }
    TEST_ASSERT_TRUE(is_reported);
}

void test_check_reports_a_lidar_that_scans_although_it_was_stopped(void)
{
    bool is_reported = false;
    for (int i = 0; i < 5 && !is_reported; i++) {
        TEST_ASSERT_EQUAL_INT(0, run_against_a_stubborn_lidar("check", "-s1"));
        is_reported = strstr(program_output, "\nlook  stop       the lidar went on after") != NULL;
    }
    TEST_ASSERT_TRUE(is_reported);
    TEST_ASSERT_NOT_NULL(strstr(program_output, "stop\n"));
    TEST_ASSERT_NULL(strstr(program_errors, "although")); /* Reported only once. */
}

void test_a_cable_pulled_while_scanning_is_reported(void)
{
    begin();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has gone: the adapter was unplugged"));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "Plug it in"));
}

void test_a_lidar_that_falls_silent_while_scanning_is_reported(void)
{
    begin();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    program_freeze_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has fallen silent; starting it again"));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has fallen silent and does not come back"));
}

void test_a_lidar_that_comes_back_is_reported(void)
{
    begin();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port));
    wait_for_lines(2);
    program_freeze_lidar();
    (void)program_wait_for("errors", "the lidar has fallen silent; starting it again\n");
    program_thaw_lidar();
    (void)program_wait_for("errors", "the lidar is back\n");
    const unsigned lines = program_count(program_read_file(0, WORK_DIR "/output", NULL), "\n");
    wait_for_lines(lines + 2);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
}

/* Imitates the folders in which the system shows a plugged-in adapter. */
static void plug_in(const char *name, const char *line, const char *vendor, const char *product)
{
    char script[600];
    (void)snprintf(script, sizeof script,
                   "mkdir -p root/dev/serial/by-id root/usb/%s/1-1:1.0/tty && "
                   "ln -sf '%s' root/dev/serial/by-id/%s && echo %s >root/usb/%s/idVendor && "
                   "echo %s >root/usb/%s/idProduct && mkdir -p root/sys/class/tty/%s && "
                   "ln -sf ../../../../usb/%s/1-1:1.0 root/sys/class/tty/%s/device",
                   name, line, name, vendor, name, product, name, strrchr(line, '/') + 1, name,
                   strrchr(line, '/') + 1);
    TEST_ASSERT_EQUAL_INT(0, system(script));
    (void)setenv("TMINI_ROOT", "root", 1);
}

static void unplug_all(void)
{
    TEST_ASSERT_EQUAL_INT(0, system("rm -rf root"));
}

void test_with_wait_a_scan_continues_after_a_pulled_cable(void)
{
    begin();
    program_plug_in(port);
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", "adapter", "--wait"));
    wait_for_lines(2);
    program_stop_lidar();
    program_plug_in(NULL);
    (void)program_wait_for("errors", "adapter is not there; waiting for it\n");
    (void)program_wait_for("errors", "fallen silent");
    const unsigned lines = program_count(program_read_file(0, WORK_DIR "/output", NULL), "\n");
    program_plug_in(program_start_lidar_again(WORDS("--log", "log")));
    wait_for_lines(lines + 2);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "adapter is there\n"));
    TEST_ASSERT_NULL(strstr(program_errors, "tmini: "));
    (void)program_wait_for("log", "stopping -> idle");
}

void test_a_recording_with_wait_goes_on_after_a_pulled_cable(void)
{
    begin();
    program_plug_in(port);
    (void)remove("waits.tmini");
    const pid_t tool =
        program_start_tmini(WORDS("record", "-p", "adapter", "--wait", "waits.tmini"));
    wait_for_bytes("waits.tmini", 16000);
    program_stop_lidar();
    (void)program_wait_for("errors", "waiting for it\n");
    size_t size = 0;
    (void)program_read_file(0, "waits.tmini", &size);
    program_plug_in(program_start_lidar_again(NO_OPTIONS));
    wait_for_bytes("waits.tmini", size + 30000);
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
    expect_success(WORDS("decode", "waits.tmini"));
    TEST_ASSERT_NULL(strstr(program_errors, "damaged"));
}

void test_with_wait_a_port_that_is_not_there_yet_is_waited_for(void)
{
    program_plug_in(NULL);
    program_skip_idle_time();
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", "adapter", "--wait", "-n", "1"));
    (void)program_wait_for("errors", "adapter is not there; waiting for it\n");
    program_plug_in(program_start_lidar_again(NO_OPTIONS));
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, 0));
    TEST_ASSERT_EQUAL_UINT(1, program_count(program_output, "\n"));
}

/* The user gives the name of the device, which another adapter may get later. */
void test_with_wait_the_adapter_keeps_its_identity(void)
{
    unplug_all();
    begin();
    plug_in("usb-Lidar_0001", port, "10c4", "ea60");
    const pid_t tool = program_start_tmini(WORDS("scan", "-p", port, "--wait"));
    wait_for_lines(2);
    program_stop_lidar();
    (void)program_wait_for("errors", "root/dev/serial/by-id/usb-Lidar_0001 is not there");
    plug_in("usb-Lidar_0001", program_start_lidar_again(NO_OPTIONS), "10c4", "ea60");
    (void)program_wait_for("errors", "usb-Lidar_0001 is there\n");
    TEST_ASSERT_EQUAL_INT(0, program_finish(tool, SIGINT));
}

/* ---------------------------------------------------------------------- mounting and listening */

/* The nearest point of the simulated room is 1 m away at 143 degrees: 53 clockwise from a front at
 * 90, or 53 anti-clockwise if the lidar is upside down. */
void test_a_lidar_that_is_mounted_turned_is_shown_as_the_robot_sees(void)
{
    begin();
    const char *const turned[] = {"scan",          "-p", port, "-n", "1", "--front", "90", "-q",
                                  "--upside-down", NULL};
    expect_success(turned);
    TEST_ASSERT_NOT_NULL(strstr(program_output, " at 30"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, " deg, ahead left\n"));
    expect_success(WORDS("scan", "-p", port, "-n", "1", "-q", "--mask", "90:-90"));
    TEST_ASSERT_NULL(strstr(program_output, "behind"));
}

void test_masked_directions_are_no_missing_ranges(void)
{
    begin();
    expect_success(WORDS("check", "-p", port, "-s1", "--mask", "150:130"));
    const char *const ranges = strstr(program_output, "ok    ranges     ");
    TEST_ASSERT_NOT_NULL_MESSAGE(ranges, program_output);
    TEST_ASSERT_TRUE(atoi(ranges + 17) > 90);
    TEST_ASSERT_NOT_NULL(strstr(ranges, " deg, behind right\n"));
}

void test_an_invalid_mounting_is_reported(void)
{
    expect_failure(2, "\"a:1\" is not FROM:TO", WORDS("scan", "-p", "x", "--mask", "a:1"));
    expect_failure(2, "\"1:\" is not FROM:TO", WORDS("scan", "-p", "x", "--mask", "1:"));
    expect_failure(2, "\"361\" is not an angle", WORDS("scan", "-p", "x", "--front", "361"));
    expect_failure(2, "\"nan\" is not an angle", WORDS("scan", "-p", "x", "--front", "nan"));
    expect_failure(2, "\"9,5\" is not an angle", WORDS("scan", "-p", "x", "--front", "9,5"));
    expect_failure(2, "\"1.5\" is not a number of mm", WORDS("scan", "-p", "x", "--offset", "1.5"));
    expect_failure(2, "decode has no option --mask", WORDS("decode", "x", "--mask", "1:2"));
}

void test_listening_sends_nothing(void)
{
    const char *const log = program_path("log");
    port = program_start_lidar(WORDS("--log", log));
    const int line = open(port, O_RDWR | O_NOCTTY);
    TEST_ASSERT_EQUAL_INT(2, (int)write(line, "\xA5\x60", 2));
    (void)program_wait_for("log", "idle -> scanning");
    expect_success(WORDS("scan", "-p", port, "--listen", "-n", "2"));
    expect_success(WORDS("check", "-p", port, "--listen", "-s", "1"));
    TEST_ASSERT_NULL_MESSAGE(strstr(program_output, "BAD"), program_output);
    expect_success(WORDS("record", "-p", port, "--listen", "heard.bin", "-s", "1"));
    TEST_ASSERT_EQUAL_UINT(1, program_count(program_read_file(0, log, NULL), "command "));
    close(line);
}

void test_listening_to_a_silent_lidar_is_reported(void)
{
    begin();
    expect_failure(1, "has another program or controller started the lidar?",
                   WORDS("scan", "-p", port, "--listen"));
}

/* test_survey.c tests the survey's commands, in virtual time. */
void test_survey_writes_a_report_and_leaves_the_lidar_stopped_as_it_was(void)
{
    const char *const log = program_path("log");
    port = program_start_lidar(WORDS("--log", log, "--frequency", "7"));
    expect_success(WORDS("survey", "-p", port, "unit", "--with-serial", "-s10"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "as expected 9.15  model "));
    TEST_ASSERT_NOT_NULL(strstr(program_output, "differs     1     frequency at first, Hz"));
    const char *const report = program_read_file(1, "unit", NULL);
    TEST_ASSERT_NOT_NULL(strstr(report, "\nfrequency_hz = 7.00\n"));
    TEST_ASSERT_NOT_NULL(strstr(report, "\nserial = 2026031700012345\n"));
    expect_success(WORDS("decode", "unit.tmini"));
    expect_output("7.00 Hz\n", WORDS("frequency", "-p", port));
    expect_output("7.00 Hz\n",
                  WORDS("frequency", "-p", program_start_lidar(WORDS("--like", "unit"))));
}

void test_a_survey_of_nothing_is_reported(void)
{
    expect_failure(1, "not one byte came", WORDS("survey", "-p", program_start_talker(NULL, 0)));
}

void test_a_recording_survives_a_pulled_cable(void)
{
    begin();
    const char *const recording = program_path("pulled.bin");
    (void)remove(recording);
    const pid_t tool = program_start_tmini(WORDS("record", "-p", port, recording, "-q"));
    wait_for_bytes(recording, 16000);
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(tool, 0));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "has gone"));
    expect_success(WORDS("decode", recording));
    TEST_ASSERT_NOT_NULL(strstr(program_output, " complete"));
}

/* ---------------------------------------------------------------------------- what can go wrong */

void test_a_command_without_a_port_asks_for_one(void)
{
    static const char *const commands[] = {"info", "health", "frequency", "reboot", "scan", "view"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        expect_failure(2, "-p /dev/ttyUSB0", WORDS(commands[i]));
    }
    expect_failure(2, "-p /dev/ttyUSB0", WORDS("record", "x"));
    expect_failure(2, "record into which file?", WORDS("record", "-p", "x"));
    expect_failure(2, "view what?", WORDS("view", "-p", "x", "file"));
}

void test_ports_lists_adapters_by_their_stable_names(void)
{
    unplug_all();
    begin();
    plug_in("usb-Lidar_0001", port, "10c4", "ea60");
    plug_in("usb-Printer", program_start_talker(NULL, 0), "dead", "beef");
    expect_success(WORDS("ports"));
    const char *const lidars =
        strstr(program_output, "root/dev/serial/by-id/usb-Lidar_0001  (/dev/");
    TEST_ASSERT_NOT_NULL(lidars);
    TEST_ASSERT_NOT_NULL(strstr(lidars, ", 10c4:ea60)  CP210x\n"));
    TEST_ASSERT_NOT_NULL(strstr(program_output, ", dead:beef)  \n"));
    TEST_ASSERT_EQUAL_UINT(2, program_count(program_output, "\n"));
}

void test_the_only_adapter_that_may_be_a_lidars_is_taken(void)
{
    unplug_all();
    begin();
    plug_in("usb-Lidar_0001", port, "1a86", "55d4");
    plug_in("usb-Printer", program_start_talker(NULL, 0), "dead", "beef");
    expect_success(WORDS("health"));
    TEST_ASSERT_EQUAL_STRING("using root/dev/serial/by-id/usb-Lidar_0001\n", program_errors);
    TEST_ASSERT_EQUAL_STRING("healthy\n", program_output);
    plug_in("usb-Lidar_0002", program_start_lidar(NO_OPTIONS), "10c4", "ea60");
    expect_failure(2, "there are:\nroot/dev/serial/by-id/usb-Lidar_0001", WORDS("health"));
    expect_output("healthy\n", WORDS("health", "-p", port));
    (void)setenv("TMINI_PORT", port, 1);
    expect_output("healthy\n", WORDS("health"));
}

void test_without_an_adapter_ports_says_so(void)
{
    expect_failure(1, "no USB serial adapter is plugged in", WORDS("ports"));
}

void test_a_port_that_does_not_exist(void)
{
    expect_failure(1, "there is no such device", WORDS("info", "-p", "/dev/nowhere"));
    expect_failure(1, "tcp:HOST:PORT", WORDS("info", "-p", "127.0.0.1:4000"));
    expect_failure(1, "tcp:HOST:PORT", WORDS("info", "-p", "tcp:nowhere"));
    expect_failure(1, "no host of that name", WORDS("info", "-p", "tcp:no.such.invalid:4000"));
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
    /* Both tools write to the same output files; the second one prints last. */
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

/* The job must fail with a message that contains this reason. */
static void expect_failed_job(unsigned job, const char *reason)
{
    TEST_ASSERT_EQUAL_INT(1, end_job(job));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini: "));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, reason), program_errors);
    TEST_ASSERT_EQUAL_STRING("", program_output);
}

void test_a_port_without_a_lidar(void)
{
    expect_failed_job(SILENT_INFO, "not one byte came");
    expect_failed_job(SILENT_SCAN, "its TX goes to the adapter's RX");
}

void test_a_lidar_at_the_wrong_baud_rate(void)
{
    expect_failed_job(NOISY_INFO, "wrong baud rate");
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "but nothing that a T-mini Plus sends"));
    expect_failed_job(NOISY_SCAN, "wrong baud rate");
}

void test_a_lidar_that_sends_but_does_not_hear(void)
{
    expect_failed_job(DEAF_INFO, "does not obey");
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "--listen"));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "the adapter's TX"));
}

void test_a_lidar_that_answers_one_command_is_not_a_fault_of_the_wires(void)
{
    TEST_ASSERT_EQUAL_INT(0, end_job(HALF_INFO));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
    expect_failed_job(HALF_HEALTH, "answers `tmini info`, so its wires are good");
    TEST_ASSERT_NULL(strstr(program_errors, "RX"));
    expect_failed_job(HALF_SCAN, "but not this command: timeout");
}

void test_a_lidar_that_does_not_answer_does_not_overwrite_a_recording(void)
{
    expect_failed_job(SILENT_RECORD, "not one byte came");
    TEST_ASSERT_EQUAL_STRING("gold", program_read_file(0, program_path("precious.bin"), NULL));
}

void test_a_reboot_is_over_when_the_lidar_answers_again(void)
{
    TEST_ASSERT_EQUAL_INT(0, end_job(REBOOT));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "the lidar is back"));
    expect_output("9.00 Hz\n", WORDS("frequency", "-p", rebooted_port));
}

void test_a_recording_that_cannot_be_written(void)
{
    begin();
    expect_failure(1, "cannot write /nowhere/x",
                   WORDS("record", "-p", port, "/nowhere/x", "--seconds", "1"));
}
