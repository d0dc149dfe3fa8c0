/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* examples/obstacle_stop on a PC, with the simulated lidar. OBSTACLE_STOP is the program's path. In the
 * simulated room the nearest thing in the front sector is a pillar, 1.37 m away. */

#define _XOPEN_SOURCE 700

#include "program.h"

#include "unity.h"

#include <poll.h>
#include <signal.h>
#include <string.h>

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

void setUp(void) {}

void tearDown(void)
{
    program_clean_up();
}

/* Until the program has printed the text. */
static void wait_for(const char *text)
{
    for (int i = 0; i < 1000; i++) {
        if (strstr(program_read_file(0, WORK_DIR "/output", NULL), text) != NULL) {
            return;
        }
        (void)poll(NULL, 0, 10);
    }
    TEST_FAIL_MESSAGE(text);
}

void test_a_robot_in_a_free_room_may_go(void)
{
    const char *const log = program_path("log");
    const char *const port = program_start_lidar(WORDS("--log", log));
    const pid_t program = program_start(OBSTACLE_STOP, WORDS(port));
    wait_for("go    front  13");
    TEST_ASSERT_EQUAL_INT(0, program_finish(program, SIGINT));
    TEST_ASSERT_NOT_NULL(strstr(program_read_file(0, log, NULL), "stopping -> idle"));
}

void test_a_robot_that_has_lost_its_lidar_must_stop(void)
{
    const char *const port = program_start_lidar((const char *const[]){NULL});
    const pid_t program = program_start(OBSTACLE_STOP, WORDS(port));
    wait_for("\ngo ");
    program_stop_lidar();
    TEST_ASSERT_EQUAL_INT(1, program_finish(program, 0));
    const char *last_line = strstr(program_output, "STOP");
    TEST_ASSERT_NOT_NULL(last_line);
    while (strchr(last_line, '\n')[1] != '\0') {
        last_line = strchr(last_line, '\n') + 1;
    }
    TEST_ASSERT_EQUAL_STRING_LEN("STOP  front ", last_line, 12);
}

void test_wrong_usage_and_a_wrong_port_are_told(void)
{
    TEST_ASSERT_EQUAL_INT(2, program_finish(program_start(OBSTACLE_STOP, WORDS(NULL)), 0));
    TEST_ASSERT_EQUAL_STRING("usage: obstacle_stop PORT\n", program_errors);
    TEST_ASSERT_EQUAL_INT(1, program_finish(program_start(OBSTACLE_STOP, WORDS("/dev/none")), 0));
    TEST_ASSERT_EQUAL_STRING("/dev/none: no such device\n", program_errors);
}
