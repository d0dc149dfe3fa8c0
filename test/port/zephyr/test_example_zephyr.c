/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/zephyr with the simulated lidar in its room. */

#include "unity.h"

#include "console.h"
#include "story.h"
#include "zephyr_model.h"

void example_begin(void)
{
    zephyr_model_begin(NULL);
    zephyr_model_boot();
    machine.on_sleep = story_go_on;
}

void example_assert_stops(bool stops)
{
    assert_last_said(stops ? ", STOP;" : ", go;");
}

int example_play(void)
{
    return example_main();
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    zephyr_model_begin(NULL);
    board.ready = false;
    zephyr_model_boot();
    TEST_ASSERT_EQUAL_INT(0, example_main());
    assert_said("the lidar cannot be started");
}
