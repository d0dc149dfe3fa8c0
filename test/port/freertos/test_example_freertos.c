/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The program examples/freertos, as it is, against the simulated lidar in its room. */

#include <string.h>

#include "unity.h"

#include "console.h"
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

static void assert_said(const char *text)
{
    if (strstr(freertos_model_console(), text) == NULL) {
        TEST_FAIL_MESSAGE(freertos_model_console());
    }
}

/* The line of the last second. */
static void assert_last_said(const char *text)
{
    const char *line = strrchr(freertos_model_console(), ',');
    while (line > freertos_model_console() && line[-1] != '\n') {
        line--;
    }
    if (strstr(line, text) == NULL) {
        TEST_FAIL_MESSAGE(freertos_model_console());
    }
}

static void let_pass(unsigned ms)
{
    vTaskDelay(pdMS_TO_TICKS(ms));
}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_reports_whether_a_robot_may_move(void)
{
    (void)example_main();
    let_pass(4000);
    assert_said("model 151, firmware 1.2, hardware 1, serial 2026031700012345\n");
    assert_last_said(", go;");
    assert_last_said("lost: 0 checksums, 0 bytes, 0 gaps\n");

    sim_place_obstacle(freertos_model_lidar(), 0, 640, 250);
    let_pass(1500);
    assert_last_said(", STOP;");

    sim_clear_obstacles(freertos_model_lidar());
    let_pass(1500);
    assert_last_said(", go;");

    sim_power(freertos_model_lidar(), false, freertos_model_now_us());
    let_pass(2500);
    assert_last_said(", STOP;");
    assert_said("lost; trying to get it back\n");

    sim_power(freertos_model_lidar(), true, freertos_model_now_us());
    let_pass(20000);
    assert_said("back again\n");
    assert_last_said(", go;");
    TEST_ASSERT_EQUAL_UINT(TASKS_EXPECTED, freertos_model_tasks());
    assert_console_leaves_time(1024);
}
