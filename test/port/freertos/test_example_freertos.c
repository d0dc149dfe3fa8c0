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

void example_begin(void)
{
    freertos_model_begin(NULL, WATCHING_PRIORITY);
}

void example_assert_stops(bool stops)
{
    assert_last_said(stops ? ", STOP;" : ", go;");
    TEST_ASSERT_EQUAL_UINT(TASKS_EXPECTED, tasks_count());
}

int example_play(void)
{
    (void)example_main();
    for (;;) {
        vTaskDelay(pdMS_TO_TICKS(100));
        story_go_on();
    }
}
