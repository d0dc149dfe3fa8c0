/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The program examples/zephyr, as it is, against the simulated lidar in its room. */

#include <setjmp.h>
#include <string.h>

#include "unity.h"

#include "console.h"
#include "zephyr_model.h"

int example_main(void);

static jmp_buf end_of_story;
static unsigned chapter;

void setUp(void)
{
    zephyr_model_begin(NULL);
    zephyr_model_boot();
    chapter = 0;
}

void tearDown(void) {}

static void assert_said(const char *text)
{
    if (strstr(zephyr_model_console(), text) == NULL) {
        TEST_FAIL_MESSAGE(zephyr_model_console());
    }
}

/* The line of the last second. */
static void assert_last_said(const char *text)
{
    const char *line = strrchr(zephyr_model_console(), ',');
    while (line > zephyr_model_console() && line[-1] != '\n') {
        line--;
    }
    if (strstr(line, text) == NULL) {
        TEST_FAIL_MESSAGE(zephyr_model_console());
    }
}

static void it_scans_and_an_obstacle_comes(void)
{
    assert_said("model 151, firmware 1.2, hardware 1, serial 2026031700012345\n");
    assert_said(", go; bytes ");
    assert_said("lost: 0 checksums, 0 bytes, 0 gaps\n");
    assert_last_said(", go;");
    sim_place_obstacle(zephyr_model_lidar(), 0, 640, 250);
}

static void it_stops_and_the_obstacle_goes(void)
{
    assert_last_said(", STOP;");
    sim_clear_obstacles(zephyr_model_lidar());
}

static void it_goes_and_power_fails(void)
{
    assert_last_said(", go;");
    sim_power(zephyr_model_lidar(), false, zephyr_model_now_us());
}

static void it_is_blind_and_power_returns(void)
{
    assert_last_said(", STOP;");
    assert_said("lost; trying to get it back\n");
    sim_power(zephyr_model_lidar(), true, zephyr_model_now_us());
}

static void it_has_come_back(void)
{
    assert_said("back again\n");
    assert_last_said(", go;");
}

static const struct {
    uint32_t time_ms;
    void (*happens)(void);
} story[] = {
    {4000, it_scans_and_an_obstacle_comes},
    {5500, it_stops_and_the_obstacle_goes},
    {6500, it_goes_and_power_fails},
    {8500, it_is_blind_and_power_returns},
    {30000, it_has_come_back},
};

static void tell_story(void)
{
    if (zephyr_model_now_us() / 1000u < story[chapter].time_ms) {
        return;
    }
    story[chapter].happens();
    if (++chapter == sizeof story / sizeof story[0]) {
        longjmp(end_of_story, 1);
    }
}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_stops_the_robot_only_while_it_must(void)
{
    zephyr_model_on_sleep(tell_story);
    if (setjmp(end_of_story) == 0) {
        (void)example_main();
    }
    TEST_ASSERT_EQUAL_UINT(sizeof story / sizeof story[0], chapter);
    assert_console_leaves_time(1024);
}

void test_it_says_so_when_the_lidar_cannot_be_started(void)
{
    zephyr_model_begin(NULL);
    zephyr_model_set_ready(false);
    zephyr_model_boot();
    TEST_ASSERT_EQUAL_INT(0, example_main());
    assert_said("the lidar cannot be started");
}
