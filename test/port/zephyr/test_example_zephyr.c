/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/zephyr with the simulated lidar in its room. */

#include <setjmp.h>

#include "unity.h"

#include "console.h"
#include "story.h"
#include "zephyr_model.h"

int example_main(void);

static jmp_buf end_of_story;

static void assert_last_line(bool stops)
{
    assert_last_said(stops ? ", STOP;" : ", go;");
}

static void go_on(void)
{
    if (!story_goes_on()) {
        longjmp(end_of_story, 1);
    }
}

void setUp(void)
{
    zephyr_model_begin(NULL);
    zephyr_model_boot();
}

void tearDown(void) {}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_reports_whether_a_robot_may_move(void)
{
    const story_board_t board = {zephyr_model_lidar(), zephyr_model_now_us, assert_last_line};
    story_begin(&board);
    zephyr_model_on_sleep(go_on);
    if (setjmp(end_of_story) == 0) {
        (void)example_main();
    }
    TEST_ASSERT_FALSE(story_goes_on());
    assert_console_leaves_time(1024);
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    zephyr_model_begin(NULL);
    zephyr_model_set_ready(false);
    zephyr_model_boot();
    TEST_ASSERT_EQUAL_INT(0, example_main());
    assert_said("the lidar cannot be started");
}
