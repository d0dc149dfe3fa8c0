/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/pico with the simulated lidar in its room. */

#include "unity.h"

#include "console.h"
#include "pico_model.h"
#include "story.h"

#define STOP_PIN 15
#define START_US 200000u /* Before this time nothing has been seen. */

int example_main(void);

static void assert_pin(bool stops)
{
    TEST_ASSERT_EQUAL_INT(stops, chip.levels[STOP_PIN]);
}

static void go_on(void)
{
    if (machine.now_us < START_US) {
        assert_pin(true);
    }
    story_go_on();
}

void setUp(void)
{
    pico_model_begin(NULL);
}

void tearDown(void) {}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_stops_the_robot_only_while_it_must(void)
{
    story_tell(example_main, assert_pin, go_on);
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    chip.baud_error_permille = 50;
    story_run(example_main, story_leave);
    assert_said("the lidar cannot be started: ");
    assert_pin(true);
}
