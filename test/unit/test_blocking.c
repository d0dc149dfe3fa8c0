/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The commands that wait. Each call of the port's `wait` lets a millisecond pass. A script feeds
 * bytes at the chosen times. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "tmini/tmini_blocking.h"
#include "tmini_driver.h"
#include "unity.h"

static struct {
    uint32_t begun_ms;
    uint32_t at_ms; /* Time of the next call of `feed`, from begun_ms on. */
    void (*feed)(void);
    uint32_t every_ms; /* Interval of further calls; 0: none. */
    uint32_t waits;
    uint16_t
        answer_chz; /* What a repeated question is answered, after a millisecond; 0: nothing. */
} script;

static void wait(void *context, int calls)
{
    (void)calls;
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    script.waits++;
    rig.now_ms++;
    if (script.answer_chz > 0 && rig.lidar.command.phase == TMINI_PHASE_ASKING) {
        rig_feed_frequency(script.answer_chz);
    }
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
    script.answer_chz = 0;
}

/* The lidar is asked, answers, and gets the start. */
static void sends_start(void)
{
    script.answer_chz = 600;
    sends(GET_FREQUENCY);
    sends(START);
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

/* The lidar is idle, and a frequency is wanted for the next start. */
static void wishes_640_chz(void)
{
    rig.config.frequency_chz = 640;
    rig_init();
    rig_go_idle();
    port_wait_StubWithCallback(wait);
}

static void feed_turn(void)
{
    rig_feed_plain_turn(1000);
}

void test_info_is_read(void)
{
    tmini_info_t info;

    comes(5, rig_feed_info);
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&rig.lidar, &info, 100));
    TEST_ASSERT_EQUAL_UINT8(151, info.model);
    TEST_ASSERT_EQUAL_UINT8(4, info.serial[15]);
    TEST_ASSERT_EQUAL_UINT32(5, script.waits);
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
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    rig_feed_frequency(640);
    polls_to(TMINI_EVENT_FREQUENCY);
    polls_and_sends(START);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    is_in(TMINI_STATE_SCANNING);
}

/* The frequency is already wanted, so this call does not try again while the lidar scans. */
void test_a_frequency_that_could_not_be_set_is_not_waited_for_while_scanning(void)
{
    rig.config.frequency_chz = 640;
    rig_init();
    begins_with(STOP, tmini_start(&rig.lidar));
    finds_quiet_and_sends(GET_FREQUENCY);
    rig_feed_frequency(99); /* No lidar turns so slowly. */
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    is_in(TMINI_STATE_SCANNING);
    TEST_ASSERT_EQUAL_UINT32(0, script.waits);
}

static void feed_packet(void)
{
    rig_feed_start_packet(1000);
}

static void feed_refusal(void)
{
    rig_feed_frequency(99);
    script.feed = feed_packet;
}

/* In 55 ms, when the frequency is queried, the reply is an impossible one. 60 ms later, after the
 * start, a packet comes. */
static void refuses_the_frequency(void)
{
    comes(55, feed_refusal);
    script.every_ms = 60;
    sends(GET_FREQUENCY);
    sends(STOP);
    sends(START);
}

void test_a_frequency_that_a_lost_lidar_refuses_is_waited_for_until_it_scans_again(void)
{
    rig_go_recovering();
    port_wait_StubWithCallback(wait);
    refuses_the_frequency();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_REPLY,
                          tmini_blocking_set_frequency(&rig.lidar, 640, TMINI_BLOCKING_TIMEOUT_MS));
    TEST_ASSERT_EQUAL_UINT32(115, script.waits);
    is_in(TMINI_STATE_SCANNING);
}

/* The lidar is still starting. */
void test_the_same_frequency_is_not_waited_for_once_it_has_been_set(void)
{
    wishes_640_chz();
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    rig_feed_frequency(640);
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    TEST_ASSERT_EQUAL_UINT32(0, script.waits);
    is_in(TMINI_STATE_STARTING);
}

void test_the_same_frequency_is_waited_for_while_a_start_asks_for_it(void)
{
    wishes_640_chz();
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    comes(5, feed_frequency);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    TEST_ASSERT_EQUAL_UINT32(5, script.waits);
}

void test_a_frequency_waits_for_the_end_of_another_command(void)
{
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
    comes(5, rig_feed_info);
    script.answer_chz = 600;
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 600, 100));
    is_in(TMINI_STATE_IDLE);
}

void test_a_frequency_of_a_scanning_lidar_is_waited_for(void)
{
    rig_go_scanning();
    port_wait_StubWithCallback(wait);
    comes(10, feed_packet);
    script.every_ms = 100;
    sends(STOP);
    script.answer_chz = 640;
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 1000));
    is_in(TMINI_STATE_STARTING);
}

void test_a_frequency_is_not_waited_for_when_nothing_recovers_the_lidar(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    rig_init();
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    port_wait_StubWithCallback(wait);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    TEST_ASSERT_EQUAL_UINT32(0, script.waits);
    is_in(TMINI_STATE_RECOVERING);
}

static void feed_refusal_then_turns(void)
{
    rig_feed_frequency(99);
    script.feed = feed_turn;
}

void test_a_start_waits_for_a_scan_though_the_frequency_was_refused(void)
{
    wishes_640_chz();
    refuses_the_frequency();
    script.feed = feed_refusal_then_turns;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&rig.lidar, 8000));
}

void test_an_idle_lidar_is_asked_in_any_case(void)
{
    comes(5, feed_frequency);
    script.every_ms = 5;
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    TEST_ASSERT_EQUAL_UINT32(10, script.waits);
}

void test_a_frequency_that_an_idle_lidar_does_not_take_says_why(void)
{
    comes(5, feed_refusal);
    sends(GET_FREQUENCY);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_REPLY, tmini_blocking_set_frequency(&rig.lidar, 640, 100));
    TEST_ASSERT_EQUAL_UINT32(5, script.waits);
}

void test_start_waits_for_the_first_scan(void)
{
    comes(10, feed_turn);
    script.every_ms = 160;
    sends_start();
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

void test_it_does_not_wait_while_there_are_events(void)
{
    comes(10, feed_two_turns);
    sends_start();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&rig.lidar, 1000));
    TEST_ASSERT_EQUAL_UINT32(10, script.waits);
}

void test_start_waits_for_the_first_packet_when_streaming(void)
{
    rig.config.points = NULL;
    rig.config.max_points = 0;
    rig_init();
    port_wait_StubWithCallback(wait);
    comes(60, rig_feed_scan_reply); /* After the stop and the quiet time. */
    sends(STOP);
    sends_start();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_start(&rig.lidar, 100));
    comes(60, feed_turn); /* The lidar is still wanted to scan: this call waits again. */
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

void test_stop_still_waits_after_the_end_of_the_command_that_it_aborts(void)
{
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 100));
    is_in(TMINI_STATE_IDLE);
}

void test_events_that_do_not_belong_to_the_command_are_swallowed(void)
{
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    answers_and_gets(600, START);
    for (unsigned i = 0; i < 2; i++) {
        rig_feed_plain_turn(0);
        (void)rig_drain();
    }
    rig_feed_plain_turn(0); /* The events are a fault and a scan. */
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 100));
    TEST_ASSERT_EQUAL_HEX(0, rig_drain());
}

/* ---- Failures ---- */

void test_a_timeout_gives_the_command_up_and_the_next_one_stops_the_lidar_first(void)
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

void test_a_stop_that_times_out_still_stands(void)
{
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_stop(&rig.lidar, 10));
    is_in(TMINI_STATE_STOPPING);
}

void test_a_question_that_waits_is_withdrawn_and_the_one_under_way_is_not(void)
{
    tmini_info_t info;
    begins_with(GET_HEALTH, tmini_request_health(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 10));
    feed_healthy();
    polls_to(TMINI_EVENT_HEALTH);
    is_in(TMINI_STATE_IDLE);
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

void test_a_start_that_times_out_during_a_recovery_is_kept(void)
{
    comes(10, feed_turn);
    sends_start();
    sends(STOP); /* The lidar is lost after a second. */
    sends_start();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_start(&rig.lidar, 1500));
    is_in(TMINI_STATE_RECOVERING); /* The lidar is still wanted to scan. */
}

void test_a_start_of_a_lost_lidar_waits_for_a_scan_and_not_for_the_recovery(void)
{
    rig_go_recovering();
    port_wait_StubWithCallback(wait);
    comes(60, feed_turn);
    script.every_ms = 10;
    sends_start();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_start(&rig.lidar, 1500));
    tmini_counters_t seen;
    tmini_counters(&rig.lidar, &seen);
    TEST_ASSERT_EQUAL_UINT16(1, seen.recoveries);
    TEST_ASSERT_EQUAL_UINT32(1, seen.scans);
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
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
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
    TEST_ASSERT_EQUAL_UINT32(0, script.waits);
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

static int looks_left; /* Clock readings until it steps back. */
static uint32_t back_ms;

static uint32_t jumping_clock(void *context, int calls)
{
    (void)context;
    (void)calls;
    return rig.now_ms - (looks_left-- > 0 ? 0 : back_ms);
}

/* 70,000 ms are 4464 in 16 bits. */
void test_a_wait_may_be_longer_than_a_minute(void)
{
    tmini_info_t info;

    rig.timing.reply_timeout_ms = 0;
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 70000));
    TEST_ASSERT_EQUAL_UINT32(70000, script.waits);
}

void test_a_start_that_times_out_does_not_end_an_earlier_query(void)
{
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_start(&rig.lidar, 100));
    is_in(TMINI_STATE_STARTING); /* After the answer. */
}

void test_a_clock_that_steps_back_ends_no_waiting(void)
{
    static const uint32_t backs_ms[] = {2, 100, 5000};
    tmini_info_t info;

    for (int i = 0; i < 24; i++) {
        setUp();
        port_now_ms_StubWithCallback(jumping_clock);
        back_ms = backs_ms[i / 8];
        looks_left = 1 + i % 8;
        comes(55, rig_feed_info);
        sends(GET_INFO);
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&rig.lidar, &info, 70000));
    }
}

void test_a_clock_set_back_by_an_hour_prolongs_a_waiting_by_its_own_length_at_most(void)
{
    tmini_info_t info;

    for (int looks = 1; looks < 2000; looks += 100) {
        setUp();
        port_now_ms_StubWithCallback(jumping_clock);
        looks_left = looks;
        back_ms = 3600000;
        rig.timing.reply_timeout_ms = 0;
        sends(GET_INFO);
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT,
                              tmini_blocking_read_info(&rig.lidar, &info, 1000));
        TEST_ASSERT_UINT32_WITHIN(500, 1500, script.waits);
    }
}

void test_with_a_timeout_of_0_it_polls_once(void)
{
    tmini_info_t info;

    rig.port.wait = NULL;
    sends(GET_INFO);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_blocking_read_info(&rig.lidar, &info, 0));
}

void test_a_port_without_wait_is_polled_without_a_pause(void)
{
    rig.port.wait = NULL;
    port_now_ms_StubWithCallback(running_clock);
    sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_stop(&rig.lidar, 1000));
    TEST_ASSERT_EQUAL_UINT32(0, script.waits);
}
