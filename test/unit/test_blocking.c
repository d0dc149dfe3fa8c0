/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The commands that wait. The port's `wait` lets a millisecond pass, in which bytes come as a
 * script says: what comes when, counted from the test's beginning. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "tmini/tmini_blocking.h"
#include "unity.h"

static struct {
    uint32_t begun_ms;
    uint32_t at_ms; /* When something comes, */
    void (*feed)(void);
    uint32_t every_ms; /* and how often again; 0: once. */
    unsigned waits;
} script;

static void wait(void *context, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    script.waits++;
    rig.now_ms++;
    if (script.feed != NULL && rig.now_ms - script.begun_ms == script.at_ms) {
        script.feed();
        script.at_ms += script.every_ms;
    }
}

/* `feed` is called `at_ms` from now. */
static void comes(uint32_t at_ms, void (*feed)(void))
{
    script.begun_ms = rig.now_ms;
    script.at_ms = at_ms;
    script.feed = feed;
    script.every_ms = 0;
}

void setUp(void)
{
    rig_open();
    rig.port.wait = port_wait;
    rig_init();
    rig_go_idle();
    port_wait_StubWithCallback(wait);
    script.feed = NULL;
    script.waits = 0;
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

static void feed_healthy(void)
{
    rig_feed_health(TMINI_FAULT_LD, 7);
}

static void feed_frequency(void)
{
    rig_feed_frequency(640);
}

void test_info_is_read(void)
{
    tmini_info_t info;

    comes(5, rig_feed_info);
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&rig.lidar, &info, 100));
    TEST_ASSERT_EQUAL_UINT8(151, info.model);
    TEST_ASSERT_EQUAL_UINT8(4, info.serial[15]);
    TEST_ASSERT_EQUAL_UINT(5, script.waits);
    is_in(TMINI_STATE_IDLE);
}

void test_health_is_read(void)
{
    tmini_health_t health;

    comes(5, feed_healthy);
    sends(GET_HEALTH);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_health(&rig.lidar, &health, 100));
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_LD, health.faults);
    TEST_ASSERT_EQUAL_UINT16(7, health.error_code);
}

void test_the_frequency_is_read(void)
{
    uint16_t frequency_chz;

    comes(5, feed_frequency);
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_frequency(&rig.lidar, &frequency_chz, 100));
    TEST_ASSERT_EQUAL_UINT16(640, frequency_chz);
}

void test_the_frequency_is_set(void)
{
    comes(5, feed_frequency);
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    TEST_ASSERT_EQUAL_UINT16(640, tmini_frequency_chz(&rig.lidar));
}

void test_a_frequency_that_is_there_already_is_not_waited_for_while_scanning(void)
{
    comes(5, feed_frequency);
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    sends(GET_FREQUENCY);
    begins(tmini_start(&rig.lidar));
    rig_feed_frequency(640);
    polls_to(TMINI_EVENT_FREQUENCY);
    sends(START);
    polls_to(TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    is_in(TMINI_STATE_SCANNING);
}

void test_a_frequency_that_could_not_be_set_is_waited_for_in_vain_while_scanning(void)
{
    rig.config.frequency_chz = 640;
    rig_init();
    sends(STOP);
    begins(tmini_start(&rig.lidar));
    passes(50);
    polls_to(TMINI_EVENT_NONE);
    sends(GET_FREQUENCY);
    polls_to(TMINI_EVENT_NONE);
    rig_feed_frequency(99); /* No lidar turns so slowly. */
    sends(STOP);
    polls_to(TMINI_EVENT_NONE);
    passes(50);
    polls_to(TMINI_EVENT_NONE);
    sends(START);
    polls_to(TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    is_in(TMINI_STATE_SCANNING);
}

static void feed_turn(void)
{
    rig_feed_plain_turn(1000);
}

void test_start_waits_for_the_first_scan(void)
{
    comes(10, feed_turn);
    script.every_ms = 160;
    sends(START);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&rig.lidar, 1000));
    TEST_ASSERT_EQUAL_UINT32(1170, rig.now_ms - script.begun_ms + 1000);
    TEST_ASSERT_EQUAL_UINT16(17, tmini_scan(&rig.lidar)->count);
    is_in(TMINI_STATE_SCANNING);
}

static void feed_two_turns(void)
{
    feed_turn();
    feed_turn();
}

void test_nothing_is_waited_for_while_there_are_events(void)
{
    comes(10, feed_two_turns);
    sends(START);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&rig.lidar, 1000));
    TEST_ASSERT_EQUAL_UINT(10, script.waits);
}

void test_start_waits_for_the_first_packet_when_streaming(void)
{
    rig.config.points = NULL;
    rig.config.max_points = 0;
    rig_init();
    port_wait_StubWithCallback(wait);
    comes(60, rig_feed_scan_reply); /* Behind the stop and the quiet time. */
    sends(STOP);
    sends(START);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_start(&rig.lidar, 100));
    comes(60, feed_turn); /* The wish stands: it is waited for again. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&rig.lidar, 100));
    TEST_ASSERT_EQUAL_UINT8(1, tmini_packet(&rig.lidar)->count);
}

void test_stop_waits_for_a_quiet_line(void)
{
    script.begun_ms = rig.now_ms;
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 100));
    TEST_ASSERT_EQUAL_UINT32(50, rig.now_ms - script.begun_ms);
    is_in(TMINI_STATE_IDLE);
}

void test_stop_waits_past_the_end_of_the_command_that_it_aborts(void)
{
    sends(GET_INFO);
    begins(tmini_request_info(&rig.lidar));
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 100));
    is_in(TMINI_STATE_IDLE);
}

void test_events_that_do_not_belong_to_the_command_are_swallowed(void)
{
    sends(START);
    begins(tmini_start(&rig.lidar));
    for (unsigned i = 0; i < 2; i++) {
        rig_feed_plain_turn(0);
        (void)rig_drain();
    }
    rig_feed_plain_turn(0); /* A fault and a scan. */
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 100));
    TEST_ASSERT_EQUAL_HEX(0, rig_drain());
}

/* ---- Failures ---- */

void test_time_that_is_up_gives_the_command_up_and_the_next_one_stops_first(void)
{
    tmini_info_t info;

    script.begun_ms = rig.now_ms;
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 100));
    TEST_ASSERT_EQUAL_UINT32(100, rig.now_ms - script.begun_ms);
    is_in(TMINI_STATE_UNKNOWN);
    TEST_ASSERT_EQUAL_HEX(0, rig_drain());
    comes(55, rig_feed_info);
    sends(STOP);
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&rig.lidar, &info, 100));
}

void test_time_runs_across_the_clocks_wrap_around(void)
{
    tmini_info_t info;

    rig.now_ms = UINT32_MAX - 50;
    script.begun_ms = rig.now_ms;
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 100));
    TEST_ASSERT_EQUAL_UINT32(100, rig.now_ms - script.begun_ms);
}

void test_a_command_given_up_half_sent_is_not_sent_any_further(void)
{
    tmini_info_t info;

    sends_both_taking(GET_INFO, 1);
    sends_rest_taking(GET_INFO, 0);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 0));
    TEST_ASSERT_EQUAL_HEX(0, rig_drain());
}

void test_a_start_waited_for_in_vain_while_the_lidar_is_being_recovered_still_stands(void)
{
    comes(10, feed_turn);
    sends(START);
    sends(STOP); /* Lost after a second. */
    sends(START);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_start(&rig.lidar, 1500));
    is_in(TMINI_STATE_RECOVERING); /* The wish stands. */
}

void test_a_result_is_not_touched_by_a_failure(void)
{
    tmini_info_t info = {.model = 1};
    tmini_health_t health = {.faults = 2};
    uint16_t frequency_chz = 3;

    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 10));
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_health(&rig.lidar, &health, 10));
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT,
                          tmini_blocking_read_frequency(&rig.lidar, &frequency_chz, 10));
    TEST_ASSERT_EQUAL_UINT8(1, info.model);
    TEST_ASSERT_EQUAL_UINT8(2, health.faults);
    TEST_ASSERT_EQUAL_UINT16(3, frequency_chz);
}

void test_a_command_that_fails_says_why(void)
{
    tmini_info_t info;

    sends_both_taking(GET_INFO, -1);
    sends_both_taking(GET_INFO, -1);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_blocking_read_info(&rig.lidar, &info, 100));
}

void test_a_command_that_uses_up_its_attempts_says_why(void)
{
    tmini_info_t info;

    sends(GET_INFO);
    sends(STOP);
    sends(GET_INFO);
    sends(STOP);
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT,
                          tmini_blocking_read_info(&rig.lidar, &info, TMINI_BLOCKING_TIMEOUT_MS));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_command_error(&rig.lidar));
}

void test_a_stop_that_fails_after_aborting_says_why(void)
{
    sends(GET_INFO);
    begins(tmini_request_info(&rig.lidar));
    sends_both_taking(STOP, -1);
    sends_both_taking(STOP, -1);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_WRITE, tmini_blocking_stop(&rig.lidar, 100));
}

void test_a_command_that_cannot_be_begun_does_not_wait(void)
{
    tmini_info_t info;
    tmini_health_t health;
    uint16_t frequency_chz;

    rig_go_scanning();
    port_wait_StubWithCallback(wait);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_blocking_read_info(&rig.lidar, &info, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_blocking_read_health(&rig.lidar, &health, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE,
                          tmini_blocking_read_frequency(&rig.lidar, &frequency_chz, 100));
    is_in(TMINI_STATE_SCANNING);
    TEST_ASSERT_EQUAL_UINT(0, script.waits);
}

void test_null_pointers_are_refused(void)
{
    tmini_info_t info;
    tmini_health_t health;
    uint16_t frequency_chz;

    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_read_info(&rig.lidar, NULL, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_read_health(&rig.lidar, NULL, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                          tmini_blocking_read_frequency(&rig.lidar, NULL, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_read_info(NULL, &info, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_read_health(NULL, &health, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                          tmini_blocking_read_frequency(NULL, &frequency_chz, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_set_frequency(NULL, 700, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_start(NULL, 100));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_blocking_stop(NULL, 100));
    is_in(TMINI_STATE_IDLE);
}

/* ---- A port without wait ---- */

static uint32_t running_clock(void *context, int calls)
{
    (void)context;
    (void)calls;
    return rig.now_ms++;
}

static int looks_left; /* Until the clock steps back by 100 ms. */

static uint32_t jumping_clock(void *context, int calls)
{
    (void)context;
    (void)calls;
    return rig.now_ms - (looks_left-- > 0 ? 0 : 100);
}

/* 70,000 ms are 4464 in 16 bits. */
void test_a_clock_that_steps_back_ends_no_waiting(void)
{
    tmini_info_t info;

    for (int looks = 1; looks <= 8; looks++) {
        setUp();
        port_now_ms_StubWithCallback(jumping_clock);
        looks_left = looks;
        comes(55, rig_feed_info);
        sends(GET_INFO);
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&rig.lidar, &info, 70000));
    }
}

void test_a_port_without_wait_is_polled_without_a_pause(void)
{
    rig.port.wait = NULL;
    port_now_ms_StubWithCallback(running_clock);
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 1000));
    TEST_ASSERT_EQUAL_UINT(0, script.waits);
}
