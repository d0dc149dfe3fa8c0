/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* examples/obstacle_stop on a PC, with the simulated lidar. OBSTACLE_STOP is the program's path. In
 * the simulated room the nearest object in the front sector is a pillar, 1.37 m away. */

#define _XOPEN_SOURCE 700

#include "program.h"

#include "unity.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

void setUp(void) {}

void tearDown(void)
{
    program_clean_up();
}

/* Waits until the program has printed this. */
static void wait_for(const char *text)
{
    (void)program_wait_for("output", text);
}

static void wait_for_message(const char *text)
{
    (void)program_wait_for("errors", text);
}

/* Runs the program with a faulty lidar: after the message, the robot must stand for five more
 * scans. */
static void expect_to_stand(const char *message, const char *const options[])
{
    size_t before = 0;
    const pid_t program = program_start(OBSTACLE_STOP, WORDS(program_start_lidar(options)));
    wait_for_message(message);
    (void)program_read_file(0, WORK_DIR "/output", &before);
    for (int i = 0; i < 2000; i++) {
        if (program_count(program_read_file(0, WORK_DIR "/output", NULL) + before, "STOP ") >= 5) {
            break;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_ASSERT_EQUAL_INT(0, program_finish(program, SIGTERM));
    TEST_ASSERT_TRUE(program_count(program_output + before, "STOP ") >= 5);
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_output + before, "go "));
}

void test_a_robot_in_a_free_room_may_go(void)
{
    const char *const log = program_path("log");
    const char *const port = program_start_lidar(WORDS("--log", log));
    const pid_t program = program_start(OBSTACLE_STOP, WORDS(port));
    wait_for("\ngo     13");
    TEST_ASSERT_EQUAL_INT(0, program_finish(program, SIGINT));
    (void)program_wait_for("log", "stopping -> idle");
}

/* Waits until the newest line begins with this. */
static void wait_for_last(const char *beginning)
{
    for (int i = 0; i < 3000; i++) {
        const char *line = program_read_file(0, WORK_DIR "/output", NULL);
        for (const char *next = line; next != NULL && next[1] != '\0';
             next = strchr(next + 1, '\n')) {
            line = next[0] == '\n' ? next + 1 : next;
        }
        if (strncmp(line, beginning, strlen(beginning)) == 0) {
            return;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_FAIL_MESSAGE(beginning);
}

void test_a_robot_that_has_lost_its_lidar_must_stop_until_it_is_back(void)
{
    program_plug_in(program_start_lidar((const char *const[]){NULL}));
    const pid_t program = program_start(OBSTACLE_STOP, WORDS("adapter"));
    wait_for("\ngo ");
    program_stop_lidar();
    program_plug_in(NULL);
    wait_for_message("fallen silent");
    wait_for_last("STOP ");
    program_plug_in(program_start_lidar_again((const char *const[]){NULL}));
    wait_for_last("go ");
    TEST_ASSERT_EQUAL_INT(0, program_finish(program, SIGINT));
}

void test_all_eight_sectors_are_shown(void)
{
    const pid_t program = program_start(OBSTACLE_STOP, WORDS(program_start_lidar(WORDS(NULL))));
    wait_for("\ngo ");
    TEST_ASSERT_EQUAL_INT(0, program_finish(program, SIGINT));
    TEST_ASSERT_EQUAL_STRING_LEN("mm    front    45", program_output, 17);
    /* At 12 Hz a scan takes 83 ms. On a UART of 115200 baud (87 us per byte) printing its line must
     * take at most half of that. */
    TEST_ASSERT_LESS_OR_EQUAL(83000 / 87 / 2, strcspn(strstr(program_output, "\ngo ") + 1, "\n"));
    unsigned mm[8] = {0};
    TEST_ASSERT_EQUAL_INT(8, sscanf(strstr(program_output, "\ngo ") + 4, "%u%u%u%u%u%u%u%u", &mm[0],
                                    &mm[1], &mm[2], &mm[3], &mm[4], &mm[5], &mm[6], &mm[7]));
    for (unsigned i = 0; i < 8; i++) {
        TEST_ASSERT_TRUE(mm[i] > 900 && mm[i] < 3500); /* The room is 5 m x 4 m, with boxes. */
    }
}

void test_a_robot_whose_lidar_is_covered_stays_where_it_is(void)
{
    expect_to_stand("faults: data", WORDS("--covered"));
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_output, "go ")); /* Never. */
}

void test_a_robot_whose_lidar_is_covered_and_does_not_report_it_stays_where_it_is(void)
{
    expect_to_stand("faults: data", WORDS("--covered", "--no-ct"));
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_output, "go "));
}

void test_a_robot_whose_lidar_does_not_turn_stays_where_it_is(void)
{
    expect_to_stand("faults: encoder", WORDS("--blocked"));
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_output, "go "));
}

void test_a_fault_that_stays_stops_the_robot_although_ranges_come(void)
{
    expect_to_stand("faults: LD", WORDS("--health", "0x10"));
}

void test_a_lidar_that_does_not_answer_is_reported_and_started_again(void)
{
    const char *const port = program_start_talker(NULL, 0);
    const pid_t program = program_start(OBSTACLE_STOP, WORDS(port));
    wait_for_message("the lidar does not start: timeout; trying again\n");
    TEST_ASSERT_EQUAL_INT(0, program_finish(program, SIGINT));
    TEST_ASSERT_EQUAL_UINT(0, program_count(program_output, "go "));
    TEST_ASSERT_EQUAL_UINT(1, program_count(program_output, "STOP "));
}

void test_wrong_usage_and_a_wrong_port_are_reported(void)
{
    TEST_ASSERT_EQUAL_INT(2, program_finish(program_start(OBSTACLE_STOP, WORDS(NULL)), 0));
    TEST_ASSERT_EQUAL_STRING("usage: obstacle_stop PORT, or obstacle_stop -p PORT\n",
                             program_errors);
    TEST_ASSERT_EQUAL_INT(2, program_finish(program_start(OBSTACLE_STOP, WORDS("a", "b")), 0));
    TEST_ASSERT_EQUAL_INT(0, program_finish(program_start(OBSTACLE_STOP, WORDS("--vers")), 0));
    TEST_ASSERT_EQUAL_STRING_LEN("obstacle_stop 1.", program_output, 16);
    TEST_ASSERT_EQUAL_INT(0, program_finish(program_start(OBSTACLE_STOP, WORDS("-h")), 0));
    TEST_ASSERT_EQUAL_INT(1, program_finish(program_start(OBSTACLE_STOP, WORDS("-p/dev/none")), 0));
    TEST_ASSERT_EQUAL_STRING("/dev/none: no such device\n", program_errors);
    TEST_ASSERT_EQUAL_INT(1, program_finish(program_start(OBSTACLE_STOP, WORDS("/dev/none")), 0));
    TEST_ASSERT_EQUAL_STRING("/dev/none: no such device\n", program_errors);
}
