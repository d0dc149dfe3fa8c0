/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/pico with the simulated lidar in its room. */

#include <setjmp.h>

#include "unity.h"

#include "console.h"
#include "pico_model.h"
#include "story.h"

#define STOP_PIN 15
#define START_US 200000u /* Before this time nothing has been seen. */

int example_main(void);

static jmp_buf end_of_story;

static void assert_pin(bool stops)
{
    TEST_ASSERT_EQUAL_INT(stops, pico_model_level(STOP_PIN));
}

static void leave(void)
{
    longjmp(end_of_story, 1);
}

static void go_on(void)
{
    if (pico_model_now_us() < START_US) {
        assert_pin(true);
    }
    if (!story_goes_on()) {
        leave();
    }
}

void setUp(void)
{
    pico_model_begin(NULL);
}

void tearDown(void) {}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_stops_the_robot_only_while_it_must(void)
{
    const story_board_t board = {pico_model_lidar(), pico_model_now_us, assert_pin};
    story_begin(&board);
    pico_model_on_sleep(go_on);
    if (setjmp(end_of_story) == 0) {
        (void)example_main();
    }
    TEST_ASSERT_FALSE(story_goes_on());
    assert_console_leaves_time(1024);
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    pico_model_set_baud_error(50);
    pico_model_on_sleep(leave);
    if (setjmp(end_of_story) == 0) {
        (void)example_main();
    }
    assert_said("the lidar cannot be started: ");
    assert_pin(true);
}
