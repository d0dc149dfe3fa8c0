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

static void run_program(void *argument)
{
    (void)argument;
    app_main();
}

void setUp(void)
{
    idf_begin(NULL);
    idf_begin_tasks();
}

void tearDown(void) {}

static void assert_pin(bool stops)
{
    TEST_ASSERT_EQUAL_INT(stops, idf_pin(STOP_PIN));
}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_stops_the_robot_only_while_it_must(void)
{
    idf_begin_task(run_program, NULL);
    vTaskDelay(20);
    assert_pin(true); /* Nothing has been seen yet. */
    TEST_ASSERT_FALSE(idf.pins[STOP_PIN].has_been_low);
    story_begin(assert_pin);
    while (story_goes_on()) {
        vTaskDelay(10);
    }
    assert_said("I lidar: health: faults: none\n");
    assert_console_leaves_time(1024);
}
