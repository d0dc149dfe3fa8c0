/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/freertos with the simulated lidar in its room. */

#include "unity.h"

#include "console.h"
#include "story.h"
#include "FreeRTOS.h"
#include "task.h"
#include "freertos_model.h"

#define WATCHING_PRIORITY 3u

int example_main(void);

void setUp(void)
{
    freertos_model_begin(NULL, WATCHING_PRIORITY);
}

void tearDown(void) {}

static void assert_last_line(bool stops)
{
    assert_last_said(stops ? ", STOP;" : ", go;");
}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_reports_whether_a_robot_may_move(void)
{
    story_begin(assert_last_line);
    (void)example_main();
    while (story_goes_on()) {
        vTaskDelay(pdMS_TO_TICKS(100));
    }
    TEST_ASSERT_EQUAL_UINT(TASKS_EXPECTED, tasks_count());
    assert_console_leaves_time(1024);
}
