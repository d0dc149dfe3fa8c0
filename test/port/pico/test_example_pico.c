/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/pico with the simulated lidar in its room. */

#include "unity.h"

#include "console.h"
#include "pico_model.h"
#include "story.h"

#define STOP_PIN 15
#define START_US 200000u /* Before this time nothing has been seen. */

void example_assert_stops(bool stops)
{
    TEST_ASSERT_EQUAL_INT(stops, chip.levels[STOP_PIN]);
}

static void go_on(void)
{
    if (machine.now_us < START_US) {
        example_assert_stops(true);
    }
    story_go_on();
}

void example_begin(void)
{
    pico_model_begin(NULL);
    machine.on_sleep = go_on;
}

int example_play(void)
{
    return example_main();
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    chip.baud_error_permille = 50;
    machine.on_sleep = story_leave;
    story_run(example_main);
    assert_said("the lidar cannot be started: ");
    example_assert_stops(true);
}
