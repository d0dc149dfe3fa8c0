/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/esp32_idf with the simulated lidar in its room. */

#include "unity.h"

#include "console.h"
#include "freertos/FreeRTOS.h"
#include "freertos/task.h"
#include "idf.h"
#include "story.h"

#define STOP_PIN IDF_JTAG_PIN /* CONFIG_EXAMPLE_STOP_GPIO */

void app_main(void);

void example_begin(void)
{
    idf_begin(NULL);
    idf_begin_tasks();
}

void example_assert_stops(bool stops)
{
    TEST_ASSERT_EQUAL_INT(stops, idf_pin(STOP_PIN));
    assert_said("I lidar: health: faults: none\n");
}

static void run_program(void *argument)
{
    (void)argument;
    app_main();
}

int example_play(void)
{
    idf_begin_task(run_program, NULL);
    vTaskDelay(20);
    TEST_ASSERT_EQUAL_INT(1, idf_pin(STOP_PIN)); /* Nothing has been seen yet. */
    TEST_ASSERT_FALSE(idf.pins[STOP_PIN].has_been_low);
    for (;;) {
        vTaskDelay(10);
        story_go_on();
    }
}
