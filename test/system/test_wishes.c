/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Programs of a user who knows only the functions' names, run against the simulated lidar in
 * virtual time. None of them repeats a call that failed. */

#include "world.h"

#include "unity.h"

#include <stdio.h>

static world_t world;
static world_config_t config;

void setUp(void)
{
    config = world_default_config();
}

void tearDown(void)
{
    for (unsigned i = 0; i < VIOLATION_KINDS; i++) {
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, world.counts.violations[i],
                                         world_violation_name((violation_t)i));
    }
}

static void begin(void)
{
    world_init(&world, &config);
}

static uint32_t count(tmini_event_t event)
{
    return world.counts.events[event];
}

static void start(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&world.lidar));
}

static void set_frequency(uint16_t frequency_chz)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_set_frequency(&world.lidar, frequency_chz));
}

/* Complete scans come at that frequency, and nothing else happens. */
static void scans_at(uint16_t frequency_chz)
{
    const uint32_t before = count(TMINI_EVENT_SCAN);
    (void)world_run_ms(&world, 5000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_SCANNING, tmini_state(&world.lidar));
    TEST_ASSERT_EQUAL_UINT16(frequency_chz, sim_frequency_chz(&world.sim));
    TEST_ASSERT_UINT32_WITHIN(2, frequency_chz / 20u, count(TMINI_EVENT_SCAN) - before);
    TEST_ASSERT_TRUE(world.scan.complete);
}

static void fail_supply_for(uint32_t ms)
{
    sim_power(&world.sim, false, world.now_us);
    (void)world_run_ms(&world, ms);
    sim_power(&world.sim, true, world.now_us);
}

/* ---- A frequency and a start ---- */

void test_set_10_hz_and_start_scans_at_10_hz(void)
{
    begin();
    set_frequency(1000);
    start();
    (void)world_run_ms(&world, 5000);
    scans_at(1000);
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_COMMAND_FAILED));
}

void test_start_and_set_10_hz_scans_at_10_hz(void)
{
    begin();
    start();
    set_frequency(1000);
    (void)world_run_ms(&world, 5000);
    scans_at(1000);
}

void test_a_configured_frequency_is_set_by_the_start(void)
{
    config.frequency_chz = 1000;
    begin();
    start();
    (void)world_run_ms(&world, 5000);
    scans_at(1000);
    TEST_ASSERT_EQUAL_UINT16(1000, tmini_frequency_chz(&world.lidar));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&world.lidar));
}

void test_a_frequency_set_while_scanning_stops_sets_and_starts_again(void)
{
    begin();
    start();
    (void)world_run_ms(&world, 4000);
    set_frequency(1200);
    set_frequency(1200);
    (void)world_run_ms(&world, 5000);
    scans_at(1200);
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_FREQUENCY));
    TEST_ASSERT_EQUAL_UINT32(2, count(TMINI_EVENT_STARTED));
}

void test_a_frequency_wanted_during_a_query_is_set_by_the_next_start(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&world.lidar));
    set_frequency(800);
    start();
    (void)world_run_ms(&world, 6000);
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_INFO));
    scans_at(800);
}

void test_a_start_follows_a_query_however_it_ends(void)
{
    begin();
    sim_lose_next_reply(&world.sim);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_health(&world.lidar));
    start();
    (void)world_run_ms(&world, 6000);
    scans_at(600);
}

/* ---- What goes wrong ---- */

void test_a_supply_that_fails_for_300_ms_leaves_10_hz_and_complete_scans(void)
{
    config.frequency_chz = 1000;
    config.max_points = 450; /* A turn has 400 at 10 Hz, 667 at 6 Hz. */
    begin();
    start();
    (void)world_run_ms(&world, 5000);
    fail_supply_for(300);
    (void)world_run_ms(&world, 20000);
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_LOST));
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_RECOVERED));
    scans_at(1000);
}

void test_a_lidar_that_is_powered_a_minute_later_scans(void)
{
    config.frequency_chz = 1000;
    begin();
    sim_power(&world.sim, false, world.now_us);
    start();
    (void)world_run_ms(&world, 60000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_STARTING, tmini_state(&world.lidar));
    TEST_ASSERT_TRUE(count(TMINI_EVENT_COMMAND_FAILED) >= 6);
    TEST_ASSERT_TRUE(count(TMINI_EVENT_COMMAND_FAILED) <= 20); /* One per attempt. */
    sim_power(&world.sim, true, world.now_us);
    (void)world_run_ms(&world, 20000);
    scans_at(1000);
}

/* A lidar that is booting may miss the query for its frequency but obey the start. */
void test_a_lidar_that_is_powered_at_any_moment_of_the_start_turns_as_wanted(void)
{
    for (unsigned late_ms = 0; late_ms < 6000; late_ms += 173) {
        config.frequency_chz = 1000;
        config.seed = late_ms;
        begin();
        sim_power(&world.sim, false, world.now_us);
        start();
        (void)world_run_ms(&world, late_ms);
        sim_power(&world.sim, true, world.now_us);
        (void)world_run_ms(&world, 25000);
        scans_at(1000);
    }
}

void test_a_frequency_that_cannot_be_set_is_reported_and_the_lidar_scans(void)
{
    config.frequency_chz = 1000;
    config.sim.max_frequency_chz = 800;
    begin();
    start();
    const unsigned events = world_run_until(&world, BIT(TMINI_EVENT_STARTED), 10000);
    TEST_ASSERT_TRUE((events & BIT(TMINI_EVENT_COMMAND_FAILED)) != 0);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_REPLY, tmini_command_error(&world.lidar));
    (void)world_run_ms(&world, 60000);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&world.lidar));
    TEST_ASSERT_EQUAL_UINT32(2, count(TMINI_EVENT_STARTED)); /* One more attempt. */
    scans_at(800);
}

void test_a_lidar_that_loses_its_frequency_unnoticed_gets_it_again(void)
{
    config.frequency_chz = 1000;
    begin();
    start();
    (void)world_run_ms(&world, 5000);
    world.sim.frequency_chz = 600;
    (void)world_run_ms(&world, 15000);
    TEST_ASSERT_EQUAL_UINT32(2, count(TMINI_EVENT_FAULTS_CHANGED)); /* Set, then cleared. */
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_LOST));
    scans_at(1000);
}

/* The program repeats its wishes in each pass of its loop. */
void test_wishes_that_are_stated_each_second_are_kept_as_well(void)
{
    begin();
    for (unsigned second = 0; second < 20; second++) {
        if (second == 5) {
            world.sim.frequency_chz = 600;
        }
        set_frequency(1000);
        start();
        (void)world_run_ms(&world, 1000);
    }
    TEST_ASSERT_EQUAL_UINT32(2, count(TMINI_EVENT_FAULTS_CHANGED)); /* Set, then cleared. */
    scans_at(1000);
}

void test_a_frequency_that_is_five_percent_off_is_no_fault(void)
{
    config.frequency_chz = 1000;
    config.sim.motor_percent = 96;
    begin();
    start();
    (void)world_run_ms(&world, 20000);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&world.lidar));
    config.sim.motor_percent = 93;
    begin();
    start();
    (void)world_run_ms(&world, 20000);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&world.lidar));
}

/* ---- Stop ---- */

void test_a_stop_that_is_lost_six_times_still_stops_the_lidar(void)
{
    begin();
    start();
    (void)world_run_ms(&world, 4000);
    world.deaf = true;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&world.lidar));
    (void)world_run_ms(&world, 3600);
    TEST_ASSERT_TRUE(count(TMINI_EVENT_COMMAND_FAILED) >= 1);
    world.deaf = false;
    (void)world_run_ms(&world, 2000);
    TEST_ASSERT_EQUAL_INT(SIM_IDLE, sim_mode(&world.sim));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_IDLE, tmini_state(&world.lidar));
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_STOPPED));
}

void test_a_stop_ends_a_start_that_waits_for_power(void)
{
    begin();
    sim_power(&world.sim, false, world.now_us);
    start();
    (void)world_run_ms(&world, 10000);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&world.lidar));
    (void)world_run_ms(&world, 1000);
    sim_power(&world.sim, true, world.now_us);
    (void)world_run_ms(&world, 30000);
    TEST_ASSERT_EQUAL_INT(SIM_IDLE, sim_mode(&world.sim));
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_STARTED));
}

void test_without_recovery_a_start_fails_once_and_can_be_asked_for_again(void)
{
    config.recovery = TMINI_RECOVERY_OFF;
    begin();
    sim_power(&world.sim, false, world.now_us);
    start();
    (void)world_run_ms(&world, 60000);
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_COMMAND_FAILED));
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_UNKNOWN, tmini_state(&world.lidar));
    sim_power(&world.sim, true, world.now_us);
    (void)world_run_ms(&world, 5000);
    start();
    (void)world_run_ms(&world, 5000);
    scans_at(600);
}

/* ---- Listen only ---- */

void test_a_listener_takes_what_comes_and_sends_nothing(void)
{
    static const uint8_t start_command[2] = {0xA5, 0x60};
    config.listen_only = true;
    begin();
    start();
    (void)world_run_ms(&world, 10000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_STARTING, tmini_state(&world.lidar));
    /* Reported after 3, 3.5, 4.5 and 6.5 seconds. */
    TEST_ASSERT_EQUAL_UINT32(4, count(TMINI_EVENT_COMMAND_FAILED));
    sim_link_write(&world.link, start_command, 2, world.now_us); /* From another program. */
    (void)world_run_ms(&world, 5000);
    scans_at(600);
    fail_supply_for(3000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_RECOVERING, tmini_state(&world.lidar));
    (void)world_run_ms(&world, 10000);
    sim_link_write(&world.link, start_command, 2, world.now_us);
    (void)world_run_ms(&world, 5000);
    scans_at(600);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_request_info(&world.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_set_frequency(&world.lidar, 1000));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&world.lidar));
    (void)world_run_ms(&world, 5000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_UNKNOWN, tmini_state(&world.lidar));
    TEST_ASSERT_EQUAL_UINT32(1, count(TMINI_EVENT_STOPPED));
    TEST_ASSERT_EQUAL_UINT32(4, count(TMINI_EVENT_COMMAND_FAILED));
    TEST_ASSERT_EQUAL_UINT32(0, count(TMINI_EVENT_UNWANTED_SCANNING));
    TEST_ASSERT_EQUAL_UINT32(0, world.writes);
}

/* ---- Results ---- */

void test_information_and_health_stay_while_the_lidar_scans(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(&world.lidar));
    (void)world_run_ms(&world, 1000);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_health(&world.lidar));
    (void)world_run_ms(&world, 1000);
    start();
    (void)world_run_ms(&world, 5000);
    TEST_ASSERT_EQUAL_UINT8(world.config.sim.information.model, tmini_info(&world.lidar)->model);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_health(&world.lidar)->faults);
}

/* ---- Stories ---- */

#ifndef STORIES
#define STORIES 60 /* 3000 in manual runs. */
#endif

typedef struct {
    bool scanning;
    uint16_t frequency_chz;
} wish_t;

static void act(wish_t *wish, random_t *random)
{
    const uint16_t chz = (uint16_t)(600 + 10 * random_below(random, 61));
    switch (random_below(random, 9)) {
    case 0:
    case 1:
        start();
        wish->scanning = true;
        break;
    case 2:
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&world.lidar));
        wish->scanning = false;
        break;
    case 3:
        (void)tmini_request_info(&world.lidar);
        break;
    case 4:
        if (tmini_set_frequency(&world.lidar, chz) == TMINI_OK) {
            wish->frequency_chz = chz;
        }
        break;
    case 5:
        (void)tmini_reboot(&world.lidar);
        break;
    case 6:
        fail_supply_for(random_below(random, 4000));
        break;
    case 7:
        world.deaf = !world.deaf;
        break;
    default:
        sim_link_force(&world.link, SIM_LINK_GARBLE, random_below(random, 3000), world.now_us);
        break;
    }
}

/* After the trouble every wish is fulfilled. Exception: if the lidar was deaf when the frequency
 * was set again, it may be wrong by more than 5 %, and a fault reports that. */
static void is_fulfilled(const wish_t *wish, unsigned seed)
{
    char text[40];
    (void)snprintf(text, sizeof text, "story %u", seed);
    TEST_ASSERT_EQUAL_INT_MESSAGE(wish->scanning ? SIM_SCANNING : SIM_IDLE, sim_mode(&world.sim),
                                  text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(wish->scanning, tmini_state(&world.lidar) == TMINI_STATE_SCANNING,
                                  text);
    const bool is_reported = (tmini_faults(&world.lidar) & TMINI_FAULT_FREQUENCY) != 0;
    if (wish->scanning && wish->frequency_chz != 0 && !is_reported) {
        TEST_ASSERT_UINT16_WITHIN_MESSAGE(wish->frequency_chz / 20, wish->frequency_chz,
                                          sim_frequency_chz(&world.sim), text);
    }
}

static void tell_story(unsigned seed)
{
    wish_t wish = {0};
    random_t random;
    random_seed(&random, seed);
    config.seed = seed;
    config.report = false;
    begin();
    for (unsigned i = 0; i < 12; i++) {
        act(&wish, &random);
        (void)world_run_ms(&world, random_below(&random, 4000));
    }
    world.deaf = false;
    (void)world_run_ms(&world, 45000);
    world.counts.violations[VIOLATION_SLOW_RECOVERY] = 0; /* A deaf lidar does not recover. */
    is_fulfilled(&wish, seed);
    tearDown();
}

void test_after_any_story_of_wishes_and_trouble_each_wish_is_fulfilled(void)
{
    for (unsigned seed = 1; seed <= STORIES; seed++) {
        tell_story(seed);
    }
}
