/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "story.h"

#include <setjmp.h>

#include "console.h"
#include "machine.h"
#include "unity.h"

static jmp_buf end_of_story;
static unsigned chapter;

static void it_scans_and_an_obstacle_comes(void)
{
    assert_said("model 151, firmware 1.2, hardware 1, serial 2026031700012345\n");
    assert_last_said(", go;");
    assert_last_said("lost: 0 checksums, 0 bytes, 0 "); /* Gaps or overflows. */
    example_assert_stops(false);
    sim_place_obstacle(&machine.lidar, 0, 640, 250);
}

static void it_stops_and_the_obstacle_goes(void)
{
    assert_last_said(", STOP;");
    example_assert_stops(true);
    sim_clear_obstacles(&machine.lidar);
}

/* It still measures, and nothing is near. */
static void it_goes_and_becomes_faulty(void)
{
    example_assert_stops(false);
    sim_set_health(&machine.lidar, SIM_HEALTH_PD);
}

static void it_stops_and_is_repaired(void)
{
    assert_said("faults: PD\n");
    example_assert_stops(true);
    sim_set_health(&machine.lidar, 0);
}

static void it_goes_and_power_fails(void)
{
    example_assert_stops(false);
    machine_power(false);
}

static void it_is_blind_and_power_returns(void)
{
    assert_said("lost; trying to get it back\n");
    example_assert_stops(true);
    machine_power(true);
}

static void it_has_come_back(void)
{
    assert_said("back again\n");
    example_assert_stops(false);
}

static const struct {
    uint64_t time_us;
    void (*happens)(void);
} chapters[] = {
    {4000000, it_scans_and_an_obstacle_comes},
    {5500000, it_stops_and_the_obstacle_goes},
    {6500000, it_goes_and_becomes_faulty},
    {7500000, it_stops_and_is_repaired},
    {8500000, it_goes_and_power_fails},
    {10500000, it_is_blind_and_power_returns},
    {32000000, it_has_come_back},
};

#define CHAPTERS (sizeof chapters / sizeof chapters[0])

void setUp(void)
{
    chapter = 0;
    example_begin();
}

void tearDown(void) {}

void story_go_on(void)
{
    if (chapter < CHAPTERS && machine.now_us >= chapters[chapter].time_us) {
        chapters[chapter].happens();
        chapter++;
    }
    if (chapter == CHAPTERS) {
        story_leave();
    }
}

void story_leave(void)
{
    longjmp(end_of_story, 1);
}

void story_run(int (*program)(void))
{
    if (setjmp(end_of_story) == 0) {
        (void)program();
    }
}

/* One test for the whole program, because it never ends. */
void test_it_names_the_lidar_and_stops_the_robot_only_while_it_must(void)
{
    story_run(example_play);
    TEST_ASSERT_EQUAL_UINT(CHAPTERS, chapter);
    assert_console_leaves_time(1024);
}
