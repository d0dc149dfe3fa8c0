/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Runs the unchanged program examples/esp32_idf with the simulated lidar in its room. */

#include <string.h>

#include "unity.h"

#include "console.h"
#include "freertos/FreeRTOS.h"
#include "freertos/task.h"
#include "idf.h"

#define STOP_PIN IDF_JTAG_PIN /* CONFIG_EXAMPLE_STOP_GPIO */

/* Other tasks may run at the same time. */
#define CHANGE(call) (idf_lock(), (call), idf_unlock())

void app_main(void);

static void run_program(void *argument)
{
    (void)argument;
    app_main();
}

void setUp(void) {}

void tearDown(void) {}

static void assert_logged(const char *text)
{
    if (strstr(idf.log, text) == NULL) {
        TEST_FAIL_MESSAGE(idf.log);
    }
}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_stops_the_robot_only_while_it_must(void)
{
    idf_begin(NULL);
    idf_begin_tasks();
    xTaskCreatePinnedToCore(run_program, "main", 3584, NULL, 1, NULL, 0);

    vTaskDelay(20);
    TEST_ASSERT_EQUAL_INT(1, idf_pin(STOP_PIN)); /* Nothing has been seen yet: stop. */
    TEST_ASSERT_FALSE(idf.pins[STOP_PIN].has_been_low);

    vTaskDelay(300);
    assert_logged("I lidar: model 151, firmware 1.2, hardware 1, serial 2026031700012345\n");
    assert_logged("I lidar: health: faults: none\n");
    assert_logged(" scans, nearest in front ");
    assert_logged(", go; lost: 0 checksums, 0 bytes, 0 overflows\n");
    TEST_ASSERT_EQUAL_INT(0, idf_pin(STOP_PIN));

    CHANGE(sim_place_obstacle(&machine.lidar, 0, 640, 250)); /* 10 degrees wide, 250 mm ahead. */
    vTaskDelay(100);
    TEST_ASSERT_EQUAL_INT(1, idf_pin(STOP_PIN));
    assert_logged(", STOP;");

    CHANGE(sim_clear_obstacles(&machine.lidar));
    vTaskDelay(100);
    TEST_ASSERT_EQUAL_INT(0, idf_pin(STOP_PIN));

    CHANGE(sim_set_health(&machine.lidar,
                          SIM_HEALTH_PD)); /* The lidar still reports ranges, all of them far. */
    vTaskDelay(100);
    TEST_ASSERT_EQUAL_INT(1, idf_pin(STOP_PIN));
    assert_logged("W lidar: faults: PD\n");

    CHANGE(sim_set_health(&machine.lidar, 0));
    vTaskDelay(100);
    TEST_ASSERT_EQUAL_INT(0, idf_pin(STOP_PIN));

    CHANGE(machine_power(false));
    vTaskDelay(200);
    TEST_ASSERT_EQUAL_INT(1, idf_pin(STOP_PIN));
    assert_logged("W lidar: lost; trying to get it back\n");

    CHANGE(machine_power(true));
    vTaskDelay(2500);
    assert_logged("I lidar: back again\n");
    TEST_ASSERT_EQUAL_INT(0, idf_pin(STOP_PIN));
    assert_console_leaves_time(1024);
}
