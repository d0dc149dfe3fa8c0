/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* `tmini check` gives the right verdict on each fault of the simulated lidar, and on devices that
 * are no lidar. Several tools run at the same time; the tests examine what each printed. The tool
 * may also report a busy computer ("pace", "computer"), which is not a fault of the lidar. */

#define _XOPEN_SOURCE 700

#include "program.h"

#include "unity.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

typedef struct {
    const char *name;
    const char *options[5]; /* Of the simulated lidar. */
    pid_t tool;
} case_t;

static case_t cases[] = {
    {"good", {"--seed", "7"}, 0},
    {"socket", {"--tcp", "0"}, 0},
    {"no_ct", {"--no-ct"}, 0},
    {"drop", {"--fault", "drop=1e-3"}, 0},
    {"flip", {"--fault", "flip=1e-3"}, 0},
    {"insert", {"--fault", "insert=1e-3"}, 0},
    {"burst", {"--fault", "burst=4"}, 0},
    {"cut", {"--fault", "cut=6"}, 0},
    {"stall", {"--fault", "stall=3"}, 0},
    {"garble", {"--fault", "garble=2"}, 0},
    {"unplug", {"--fault", "unplug=1"}, 0},
    {"blocked", {"--blocked"}, 0},
    {"covered", {"--covered"}, 0},
    {"covered_no_ct", {"--covered", "--no-ct"}, 0},
    {"sensor", {"--health", "0x01"}, 0},
    {"encoder", {"--health", "0x02"}, 0},
    {"power", {"--health", "0x04"}, 0},
    {"pd", {"--health", "0x08"}, 0},
    {"ld", {"--health", "0x10"}, 0},
    {"data", {"--health", "0x20"}, 0},
    {"field", {"--begin", "unmarked", "--firmware", "1.3"}, 0},
    {"slow", {"--motor", "70"}, 0},
    {"brake", {"--motor", "85"}, 0},
    {"weak", {"--spin-up", "8"}, 0},
};

#define CASES (sizeof cases / sizeof cases[0])

/* Cases that run at the same time: with more, the computer is too slow for the simulated lidars. */
#define AT_ONCE 8u

/* How many cases have begun, in the order of the table. */
static size_t begun;

/* On a busy computer the simulated lidar or the tool may stop for a second. The tool reports this
 * correctly, but the case tests something else. Such a case is repeated; this many repeats are left
 * for all cases. */
static unsigned retries = 20;

/* Tools on ports that have no simulated lidar. */
static pid_t silent, noisy, deaf, half;

static void begin_case(case_t *one)
{
    const char *const port = program_start_lidar(one->options);
    one->tool = program_start_as(one->name, WORDS("check", "-p", port, "-q", "-s7"));
}

static void begin_cases(void)
{
    static const uint8_t noise[] = {0x33, 0x4C, 0xF8, 0x00, 0x80, 0x66, 0x99, 0xE6, 0x1E};
    static const uint8_t information[27] = {0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, 0x97, 2, 1, 1, 2, 0, 2,
                                            6,    0,    3,    1, 7, 0, 0,    0,    1, 2, 3, 4, 5};
    size_t size = 0;
    program_begin_background();
    while (begun < AT_ONCE) {
        begin_case(&cases[begun++]);
    }
    const char *const room = program_read_file(1, RECORDINGS "sim-6hz.bin", &size);
    silent = program_start_as("silent", WORDS("check", "-p", program_start_talker(NULL, 0)));
    noisy =
        program_start_as("noisy", WORDS("check", "-p", program_start_talker(noise, sizeof noise)));
    deaf = program_start_as(
        "deaf", WORDS("check", "-p", program_start_talker((const uint8_t *)room + 7, size - 7)));
    half = program_start_as("half",
                            WORDS("check", "-p", program_start_answerer(0x90, information, 27)));
    program_end_background();
}

void setUp(void)
{
    static bool has_begun;
    (void)unsetenv("TMINI_PORT");
    if (!has_begun) {
        has_begun = true;
        begin_cases();
    }
}

void tearDown(void)
{
    program_clean_up();
}

static case_t *find_case(const char *name)
{
    size_t i = 0;
    while (strcmp(cases[i].name, name) != 0) {
        i++;
    }
    return &cases[i];
}

static bool computer_was_busy(void)
{
    return strstr(program_output, "the lidar fell silent ") != NULL ||
           strstr(program_output, "\nlook  pace ") != NULL ||
           strstr(program_output, "\nlook  computer ") != NULL;
}

static void expect_narrow_lines(void)
{
    for (const char *line = program_output; *line != '\0'; line += strspn(line, "\n")) {
        const size_t length = strcspn(line, "\n");
        TEST_ASSERT_TRUE_MESSAGE(length <= 80, line);
        line += length;
    }
}

/* Waits for the end of a case, and begins another one. Returns the exit status. */
static int finish_case(case_t *one)
{
    program_begin_background();
    while (begun <= (size_t)(one - cases)) {
        begin_case(&cases[begun++]);
    }
    const int ended = program_finish_as(one->name, one->tool);
    if (begun < CASES) {
        begin_case(&cases[begun++]);
    }
    program_end_background();
    return ended;
}

/* Waits for the end of the case, which must have this exit status and print this text. */
static void end_case(const char *name, int status, const char *text)
{
    case_t *const one = find_case(name);
    int ended = finish_case(one);
    while (retries > 0 && computer_was_busy() &&
           (ended != status || strstr(program_output, text) == NULL)) {
        retries--;
        begin_case(one);
        ended = finish_case(one);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(status, ended, program_output);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_output, text), program_output);
    expect_narrow_lines();
}

static void expect_said(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_output, text), program_output);
}

static void expect_unsaid(const char *text)
{
    TEST_ASSERT_NULL_MESSAGE(strstr(program_output, text), program_output);
}

/* The verdict is bad, for exactly these reasons. */
static void expect_bad(const char *name, const char *reasons)
{
    char verdict[80];
    (void)snprintf(verdict, sizeof verdict, "\nverdict: not good: %s\n", reasons);
    end_case(name, 1, verdict);
}

void test_a_good_lidar_is_good(void)
{
    end_case("good", 0, "\nok    supply     no restart; first packet after ");
    expect_unsaid("BAD");
    expect_said(
        "\nok    answers    model 151, firmware 1.2, hardware 1, serial 2026031700012345\n");
    expect_said("\nok    health     healthy\n");
    expect_said("\nok    line       0.0 % of ");
    expect_said("\nok    frequency  6.0 Hz measured, 6.0 Hz set\n");
    expect_said("\nok    faults     healthy\n");
    expect_said(" % valid; nearest ");
    expect_said("\nverdict: ");
    end_case("socket", 0, "ok    port       tcp:127.0.0.1:");
    expect_unsaid("BAD");
}

void test_a_unit_that_reports_nothing_within_the_stream_is_good_too(void)
{
    end_case("no_ct", 0, "\nverdict: ");
    expect_said(
        "\nok    faults     not reported: this unit sends no information within the stream\n");
    expect_unsaid("BAD");
}

/* Cases with a bad verdict: its reason, and two texts that are printed. */
static const struct {
    const char *name;
    const char *reason;
    const char *said[2];
} troubles[] = {
    {"drop", "line", {" packets damaged, ", "GND beside them"}},
    {"flip", "line", {" packets damaged, ", "GND beside them"}},
    {"insert", "line", {" packets damaged, ", "GND beside them"}},
    {"burst", "line", {" packets damaged, ", "GND beside them"}},
    {"cut", "line", {" packets damaged, ", "GND beside them"}},
    {"blocked", "health", {"faulty: encoder", "let the rotor turn freely"}},
    {"covered", "faults", {"uncover or clean the window", ""}},
    {"covered_no_ct", "faults", {"uncover or clean the window", ""}},
    /* The tool believes the lidar's own health report. */
    {"sensor", "health", {"faulty: sensor\n", "ask its maker"}},
    {"encoder", "health", {"faulty: encoder (is the rotor blocked?)\n", ""}},
    {"power", "health", {"faulty: wireless power\n", ""}},
    {"pd", "health", {"faulty: PD\n", ""}},
    {"ld", "health", {"faulty: LD\n", ""}},
    {"data", "health", {"faulty: data (is the window covered?)\n", ""}},
};

void test_each_fault_is_named_with_a_remedy(void)
{
    for (size_t i = 0; i < sizeof troubles / sizeof troubles[0]; i++) {
        expect_bad(troubles[i].name, troubles[i].reason);
        expect_said(troubles[i].said[0]);
        expect_said(troubles[i].said[1]);
    }
}

void test_bytes_that_come_late_are_no_damage(void)
{
    end_case("stall", 0, "\nlook  pace       packets came up to ");
    expect_said("\nok    line       0.0 % ");
    expect_said("verdict: usable, but look at: ");
}

void test_a_wrong_baud_rate_for_a_while_is_a_fault_of_the_line(void)
{
    /* Perhaps no revolution arrives complete. */
    end_case("garble", 1, "\nverdict: not good: line");
    expect_said("bytes came that no lidar sends: a wrong baud rate for a while");
    expect_unsaid("pace"); /* Neither the computer nor the motor is called slow. */
    expect_unsaid("the motor took");
}

void test_a_lidar_that_restarts_has_a_weak_supply(void)
{
    end_case("unplug", 1, "\nBAD   supply     the lidar fell silent ");
    expect_said("5 V, up to 1 A");
}

void test_a_motor_that_comes_up_slowly_has_a_weak_supply(void)
{
    end_case("weak", 0, "\nlook  supply     the motor took ");
}

void test_a_unit_that_behaves_like_real_ones_is_good(void)
{
    end_case("field", 0, "firmware 1.3, ");
    expect_unsaid("BAD");
}

void test_a_motor_that_does_not_come_up_to_its_speed(void)
{
    expect_bad("slow", "frequency");
    expect_said("\nBAD   frequency  4.2 Hz measured, 6.0 Hz set\n");
    end_case("brake", 0, "\nlook  frequency  5.1 Hz measured, 6.0 Hz set\n");
    expect_said("brake the rotor");
}

static void expect_no_lidar(const char *name, pid_t tool, const char *verdict, const char *advice)
{
    TEST_ASSERT_EQUAL_INT(1, program_finish_as(name, tool));
    expect_said(verdict);
    expect_said(advice);
    expect_narrow_lines();
}

void test_devices_that_are_no_lidar(void)
{
    expect_no_lidar("silent", silent, "\nverdict: not good: wiring\n", "not one byte came");
    expect_no_lidar("noisy", noisy, "\nverdict: not good: baud\n", "230400 baud");
    expect_no_lidar("deaf", deaf, "\nverdict: not good: command\n", "the adapter's TX");
}

void test_a_lidar_that_answers_but_does_not_scan(void)
{
    TEST_ASSERT_EQUAL_INT(1, program_finish_as("half", half));
    expect_said("\nlook  health     not answered\n");
    expect_said("\nBAD   start      it answers, but does not scan\n");
    expect_said("\nverdict: not good: start\n");
    expect_unsaid("RX");
}

void test_an_interrupted_examination_has_no_verdict(void)
{
    const char *const port = program_start_lidar(WORDS("--seed", "8"));
    const pid_t gone = program_start_as("gone", WORDS("check", "-p", port));
    program_wait_for("goneerrors", "scanning for ");
    (void)kill(gone, SIGINT);
    TEST_ASSERT_EQUAL_INT(1, program_finish_as("gone", gone));
    expect_unsaid("verdict");
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "no verdict"));
}

void test_without_a_port_there_is_nothing_to_examine(void)
{
    TEST_ASSERT_EQUAL_INT(1, program_tmini(WORDS("check", "-p", "/dev/nowhere")));
    expect_said("verdict: none, because there is no port to look at\n");
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "no such device"));
    TEST_ASSERT_EQUAL_INT(2, program_tmini(WORDS("check")));
}
