/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/zephyr with the simulated lidar in its room. */

#include "unity.h"

#include "console.h"
#include "story.h"
#include "zephyr_model.h"

int example_main(void);

static void assert_last_line(bool stops)
{
    assert_last_said(stops ? ", STOP;" : ", go;");
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
    story_tell(example_main, assert_last_line, story_go_on);
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    zephyr_model_begin(NULL);
    board.ready = false;
    zephyr_model_boot();
    TEST_ASSERT_EQUAL_INT(0, example_main());
    assert_said("the lidar cannot be started");
}
