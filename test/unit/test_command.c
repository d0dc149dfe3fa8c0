/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* When commands are sent: every command, its replies (also late and lost ones), its waits and its
 * failures. test_states.c tests which command may begin in which state. */

#include "invariants.h"
#include "rig.h"
#include "tmini_driver.h"

#include "mock_port_functions.h"
#include "unity.h"

#include <string.h>

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

static void fails_with(tmini_status_t status)
{
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_INT(status, tmini_command_error(&rig.lidar));
    is_in(TMINI_STATE_UNKNOWN);
}

/* ---- Before a command: the line is made quiet ---- */

void test_from_an_unknown_state_a_command_first_stops_the_lidar_and_waits_for_a_quiet_line(void)
{
    begins_with(STOP, tmini_request_info(&rig.lidar));
    is_in(TMINI_STATE_BUSY);
    was_sent();
    finds_quiet_and_sends(GET_INFO);
}

void test_in_the_idle_state_a_command_is_sent_at_once(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
}

void test_each_byte_that_is_heard_puts_the_command_off_by_the_quiet_time(void)
{
    begins_with(STOP, tmini_request_info(&rig.lidar));
    passes(30);
    rig_feed_byte(0x00);
    finds_quiet_and_sends(GET_INFO);
}

/* This many bytes come, a stop is sent, and there is no poll for 60 ms. */
static void stop_unwatched_after(size_t bytes)
{
    for (size_t i = 0; i < bytes; i++) {
        rig_feed_byte(0x00);
    }
    begins_with(STOP, tmini_stop(&rig.lidar));
    rig.now_ms += 60;
}

/* The ring is full: further bytes wait in a layer below, or are refused. Only a refused byte is
 * visible in the ring. */
static void is_quiet_only_after_room_was_made(size_t bytes)
{
    stop_unwatched_after(bytes);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_STOPPING);
    passes_to(49, TMINI_EVENT_NONE);
    passes_to(1, TMINI_EVENT_STOPPED);
}

void test_a_line_is_not_known_to_be_quiet_while_the_ring_is_full(void)
{
    is_quiet_only_after_room_was_made(RIG_RX_SIZE);
}

void test_a_line_is_not_known_to_be_quiet_while_the_ring_is_closed(void)
{
    is_quiet_only_after_room_was_made(RIG_RX_SIZE + 1);
}

void test_with_room_for_a_byte_more_the_line_is_known_to_be_quiet(void)
{
    stop_unwatched_after(RIG_RX_SIZE - 1);
    polls_to(TMINI_EVENT_STOPPED);
}

void test_bytes_that_were_lost_put_the_command_off_by_the_quiet_time(void)
{
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes_to(30, TMINI_EVENT_NONE);
    tmini_feed_gap(&rig.lidar);
    polls_to(TMINI_EVENT_NONE);
    passes_to(49, TMINI_EVENT_NONE);
    passes_to(1, TMINI_EVENT_STOPPED);
}

/* The lost bytes may have been a packet. */
void test_bytes_that_were_lost_while_idle_count_as_heard(void)
{
    rig_go_idle();
    tmini_feed_gap(&rig.lidar);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_UNKNOWN);
    begins_with(STOP, tmini_request_info(&rig.lidar));
}

void test_packets_of_the_tail_after_a_stop_are_no_scan(void)
{
    rig_go_scanning();
    begins_with(STOP, tmini_stop(&rig.lidar));
    for (unsigned ms = 0; ms < 300; ms += 10) {
        rig_feed_start_packet(1000);
        passes(10);
    }
    passes(40); /* The last packet came 10 ms ago. */
    polls_to(TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_IDLE);
}

void test_a_stop_that_gets_lost_is_sent_again(void)
{
    rig_go_scanning();
    begins_with(STOP, tmini_stop(&rig.lidar));
    for (unsigned ms = 0; ms < 600; ms += 20) {
        rig_feed_point_packet(1000);
        passes(20);
    }
    polls_to(TMINI_EVENT_NONE); /* The line was not quiet in time. */
    sends(STOP);                /* So the stop is repeated. */
    polls_to(TMINI_EVENT_NONE);
    was_sent();
    TEST_ASSERT_EQUAL_UINT(1, rig_counters().timeouts);
    passes_to(50, TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_IDLE); /* The number of attempts does not matter. */
}

void test_a_lidar_that_will_not_be_stopped_fails_the_command_after_three_attempts(void)
{
    rig_go_scanning();
    begins_with(STOP, tmini_stop(&rig.lidar));
    for (unsigned attempt = 1; attempt <= 3; attempt++) {
        for (unsigned ms = 0; ms < 600; ms += 20) {
            rig_feed_point_packet(1000);
            passes(20);
        }
        if (attempt < 3) {
            polls_to(TMINI_EVENT_NONE);
            sends(STOP);
        }
    }
    fails_with(TMINI_ERROR_TIMEOUT);
    TEST_ASSERT_EQUAL_UINT(3, rig_counters().timeouts);
}

void test_a_byte_that_comes_while_idle_makes_the_state_unknown_and_the_next_command_stop_first(void)
{
    rig_go_idle();
    rig_feed_byte(0x00);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_UNKNOWN);
    begins_with(STOP, tmini_request_health(&rig.lidar));
}

void test_a_byte_that_no_poll_has_seen_yet_counts_as_heard(void)
{
    rig_go_idle();
    rig_feed_byte(0x00);
    begins_with(STOP, tmini_request_health(&rig.lidar));
}

void test_bytes_after_a_reply_make_the_state_unknown(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed_health(0, 0);
    rig_feed_byte(0x55);
    polls_to(TMINI_EVENT_HEALTH);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_UNKNOWN);
}

/* ---- Each command and its reply ---- */

void test_info_is_what_the_reply_says(void)
{
    /* 151, firmware 1.2 with the minor number first (section 9.4), hardware 1, 16 digits. */
    static const uint8_t reply[] = {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04, 0x97, 0x02,
                                    0x01, 0x01, 2,    0,    2,    5,    0,    4,    2,
                                    4,    0,    0,    0,    9,    0,    1,    9,    4};

    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    is_in(TMINI_STATE_BUSY);
    rig_feed(reply, sizeof reply);
    polls_to(TMINI_EVENT_INFO);
    is_in(TMINI_STATE_IDLE);
    const tmini_info_t *const info = tmini_info(&rig.lidar);
    TEST_ASSERT_EQUAL_UINT8(151, info->model);
    TEST_ASSERT_EQUAL_UINT8(1, info->firmware_major);
    TEST_ASSERT_EQUAL_UINT8(2, info->firmware_minor);
    TEST_ASSERT_EQUAL_UINT8(1, info->hardware);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(&reply[11], info->serial, 16);
}

void test_health_is_what_the_reply_says(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    rig_feed_health(TMINI_FAULT_ENCODER | TMINI_FAULT_LD, 0x1234);
    polls_to(TMINI_EVENT_HEALTH);
    is_in(TMINI_STATE_IDLE);
    TEST_ASSERT_EQUAL_HEX8(0x12, tmini_health(&rig.lidar)->faults);
    TEST_ASSERT_EQUAL_HEX16(0x1234, tmini_health(&rig.lidar)->error_code);
}

void test_the_frequency_is_what_the_reply_says(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(720);
    polls_to(TMINI_EVENT_FREQUENCY);
    is_in(TMINI_STATE_IDLE);
    TEST_ASSERT_EQUAL_UINT16(720, tmini_frequency_chz(&rig.lidar));
}

void test_after_a_reboot_the_state_is_unknown_until_the_next_command(void)
{
    is_idle_and_asked(REBOOT, tmini_reboot(&rig.lidar));
    is_in(TMINI_STATE_BUSY);
    passes_to(5000, TMINI_EVENT_REBOOTED);
    is_in(TMINI_STATE_UNKNOWN);
}

void test_packets_while_the_lidar_reboots_are_no_scan(void)
{
    is_idle_and_asked(REBOOT, tmini_reboot(&rig.lidar));
    rig_feed_start_packet(1000);
    passes_to(5000, TMINI_EVENT_REBOOTED);
}

void test_scanning_begins_with_the_first_packet_after_the_start_reply(void)
{
    rig_go_idle();
    begins_with(START, tmini_start(&rig.lidar));
    is_in(TMINI_STATE_STARTING);
    passes(5);
    rig_feed_scan_reply();
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_STARTING);
    passes(400);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    is_in(TMINI_STATE_SCANNING);
}

void test_a_packet_means_scanning_even_if_the_start_reply_was_lost(void)
{
    rig_go_starting();
    passes(200);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    is_in(TMINI_STATE_SCANNING);
}

void test_the_start_reply_may_come_after_the_first_packet(void)
{
    rig_go_starting();
    rig_feed_point_packet(1000);
    rig_feed_scan_reply();
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    passes(999);
    is_in(TMINI_STATE_SCANNING);
}

void test_stopping_ends_when_the_line_is_quiet(void)
{
    rig_go_scanning();
    begins_with(STOP, tmini_stop(&rig.lidar));
    is_in(TMINI_STATE_STOPPING);
    passes_to(50, TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_IDLE);
}

void test_a_second_stop_while_stopping_sends_nothing(void)
{
    rig_go_scanning();
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes(20);
    begins(tmini_stop(&rig.lidar));
    passes_to(30, TMINI_EVENT_STOPPED);
}

void test_stop_aborts_a_query(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    begins_with(STOP, tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ABORTED, tmini_command_error(&rig.lidar));
    is_in(TMINI_STATE_STOPPING);
    rig_feed_info(); /* This reply is no longer awaited. */
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_a_command_drops_the_end_of_the_one_before_that_was_not_polled_for(void)
{
    begins_with(STOP, tmini_request_info(&rig.lidar));
    begins_with(STOP, tmini_stop(&rig.lidar)); /* Aborts the request. */
    tmini_cancel(&rig.lidar);
    begins_with(STOP, tmini_request_info(&rig.lidar));
    passes(50); /* COMMAND_FAILED is dropped: it would seem to be of this request. */
}

void test_cancelling_a_command_also_cancels_the_start_after_it(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    begins(tmini_start(&rig.lidar));
    tmini_cancel(&rig.lidar);
    begins_with(STOP, tmini_request_info(&rig.lidar));
    finds_quiet_and_sends(GET_INFO);
    rig_feed_info();
    polls_to(TMINI_EVENT_INFO);
    is_in(TMINI_STATE_IDLE);
}

/* ---- Only the awaited reply is taken ---- */

void test_a_frequency_is_not_taken_as_device_information_of_the_same_type(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    rig_feed_frequency(600);
    passes(10);
    rig_feed_info();
    polls_to(TMINI_EVENT_INFO);
}

void test_device_information_is_not_taken_as_a_frequency_of_the_same_type(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_info();
    passes(10);
    rig_feed_frequency(600);
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_UINT16(600, tmini_frequency_chz(&rig.lidar));
}

void test_a_reply_that_was_not_asked_for_is_skipped(void)
{
    rig_go_idle();
    rig_feed_info();
    passes(10);
}

void test_a_late_reply_answers_the_repeated_query(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(GET_INFO);
    rig_feed_info();
    polls_to(TMINI_EVENT_INFO);
    is_in(TMINI_STATE_UNKNOWN); /* The command's reply may still come. */
}

void test_a_reply_that_comes_while_the_line_is_made_quiet_is_not_taken(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    rig_feed_info();
    finds_quiet_and_sends(GET_INFO);
    rig_feed_info();
    polls_to(TMINI_EVENT_INFO);
}

static void asks_in_vain(uint8_t code)
{
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(code);
}

void test_a_query_without_a_reply_is_sent_three_times(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    asks_in_vain(GET_HEALTH);
    asks_in_vain(GET_HEALTH);
    passes(2000);
    fails_with(TMINI_ERROR_TIMEOUT);
    TEST_ASSERT_EQUAL_UINT(3, rig_counters().timeouts);
}

void test_a_reply_that_comes_after_the_last_attempt_is_ignored(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    asks_in_vain(GET_HEALTH);
    asks_in_vain(GET_HEALTH);
    passes(2000);
    fails_with(TMINI_ERROR_TIMEOUT);
    rig_feed_health(0, 0);
    passes(10);
    is_in(TMINI_STATE_UNKNOWN);
}

void test_each_command_has_all_its_attempts(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    asks_in_vain(GET_HEALTH);
    rig_feed_health(0, 0);
    polls_to(TMINI_EVENT_HEALTH);

    begins_with(STOP, tmini_request_health(&rig.lidar));
    finds_quiet_and_sends(GET_HEALTH);
    asks_in_vain(GET_HEALTH);
    asks_in_vain(GET_HEALTH);
    rig_feed_health(0, 0);
    polls_to(TMINI_EVENT_HEALTH);
}

void test_a_start_that_is_acknowledged_but_brings_no_packet_is_reported_and_tried_again(void)
{
    rig_go_spinning_up();
    passes_to(3000, TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_command_error(&rig.lidar));
    is_in(TMINI_STATE_STARTING);
    passes_to(500, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    was_sent();
    TEST_ASSERT_EQUAL_UINT(1, rig_counters().timeouts);
}

void test_a_single_attempt_is_one_attempt(void)
{
    rig.timing.max_attempts = 1;
    rig_init();
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    passes(2000);
    fails_with(TMINI_ERROR_TIMEOUT);
}

void test_two_attempts_are_two(void)
{
    rig.timing.max_attempts = 2;
    rig_init();
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    asks_in_vain(GET_HEALTH);
    passes(2000);
    fails_with(TMINI_ERROR_TIMEOUT);
}

void test_no_attempts_count_as_one(void)
{
    rig.timing.max_attempts = 0;
    rig_init();
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    passes(2000);
    fails_with(TMINI_ERROR_TIMEOUT);
}

/* ---- Setting the frequency ---- */

static void begins_to_set(uint16_t target_chz, uint16_t now_chz)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, target_chz));
    is_in(TMINI_STATE_BUSY);
    rig_feed_frequency(now_chz);
    polls_to(TMINI_EVENT_NONE);
}

/* When the line is quiet, the next command is sent; the reply is this frequency. */
static void steps(uint8_t code, uint16_t answer_chz)
{
    passes(50);
    polls_and_sends(code);
    polls_to(TMINI_EVENT_NONE);
    was_sent();
    rig_feed_frequency(answer_chz);
}

static void arrives_at(uint16_t frequency_chz)
{
    polls_to(TMINI_EVENT_FREQUENCY);
    is_in(TMINI_STATE_IDLE);
    TEST_ASSERT_EQUAL_UINT16(frequency_chz, tmini_frequency_chz(&rig.lidar));
}

void test_a_frequency_is_reached_in_steps_and_read_back(void)
{
    begins_to_set(820, 600);
    steps(FASTER_ONE, 700);
    steps(FASTER_ONE, 800);
    steps(FASTER_TENTH, 810);
    steps(FASTER_TENTH, 820);
    steps(GET_FREQUENCY, 820);
    arrives_at(820);
}

void test_the_frequency_goes_down_as_well(void)
{
    begins_to_set(680, 900);
    steps(SLOWER_ONE, 800);
    steps(SLOWER_ONE, 700);
    steps(SLOWER_TENTH, 690);
    steps(SLOWER_TENTH, 680);
    steps(GET_FREQUENCY, 680);
    arrives_at(680);
}

void test_less_than_a_coarse_step_is_made_in_fine_ones(void)
{
    begins_to_set(690, 600);
    for (uint16_t step = 1; step <= 9; step++) {
        steps(FASTER_TENTH, (uint16_t)(600 + 10 * step));
    }
    steps(GET_FREQUENCY, 690);
    arrives_at(690);
}

void test_less_than_a_coarse_step_down_is_made_in_fine_ones(void)
{
    begins_to_set(610, 700);
    for (uint16_t step = 1; step <= 9; step++) {
        steps(SLOWER_TENTH, (uint16_t)(700 - 10 * step));
    }
    steps(GET_FREQUENCY, 610);
    arrives_at(610);
}

void test_each_change_has_all_its_steps(void)
{
    for (unsigned change = 0; change < 3; change++) {
        begins_to_set(690, 600);
        for (uint16_t step = 1; step <= 9; step++) {
            steps(FASTER_TENTH, (uint16_t)(600 + 10 * step));
        }
        steps(GET_FREQUENCY, 690);
        arrives_at(690);
    }
}

void test_no_step_goes_above_the_highest_frequency(void)
{
    begins_to_set(1200, 1110);
    steps(FASTER_TENTH, 1120);
}

void test_a_coarse_step_may_lead_to_the_highest_frequency(void)
{
    begins_to_set(1200, 1100);
    steps(FASTER_ONE, 1200);
    steps(GET_FREQUENCY, 1200);
    arrives_at(1200);
}

void test_no_step_goes_below_the_lowest_frequency(void)
{
    begins_to_set(600, 690);
    steps(SLOWER_TENTH, 680);
}

void test_a_coarse_step_may_lead_to_the_lowest_frequency(void)
{
    begins_to_set(600, 700);
    steps(SLOWER_ONE, 600);
    steps(GET_FREQUENCY, 600);
    arrives_at(600);
}

void test_a_frequency_that_is_set_already_is_read_back_all_the_same_and_not_stepped(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 600));
    rig_feed_frequency(600);
    arrives_at(600);
}

void test_between_two_steps_the_nearest_frequency_is_enough(void)
{
    begins_to_set(650, 633);
    steps(FASTER_TENTH, 643);
    steps(FASTER_TENTH, 653);
    steps(GET_FREQUENCY, 653);
    arrives_at(653);
}

void test_half_a_fine_step_off_is_near_enough_on_either_side(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 650));
    rig_feed_frequency(645);
    arrives_at(645);

    begins_with(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 650));
    rig_feed_frequency(655);
    arrives_at(655);
}

void test_more_than_half_a_fine_step_off_is_not_near_enough(void)
{
    begins_to_set(650, 656);
    steps(SLOWER_TENTH, 646);
    steps(GET_FREQUENCY, 646);
    arrives_at(646);
}

void test_less_than_half_a_fine_step_short_is_stepped(void)
{
    begins_to_set(650, 644);
    steps(FASTER_TENTH, 654);
    steps(GET_FREQUENCY, 654);
    arrives_at(654);
}

void test_a_step_is_sent_only_when_the_line_is_quiet_after_the_reply(void)
{
    begins_to_set(700, 600);
    passes(40);
    rig_feed_byte(0x00);
    passes(50);
    polls_and_sends(FASTER_ONE);
    polls_to(TMINI_EVENT_NONE);
}

void test_a_line_that_does_not_fall_quiet_between_steps_is_made_quiet(void)
{
    begins_to_set(700, 600);
    for (unsigned ms = 0; ms < 600; ms += 40) {
        rig_feed_byte(0x00);
        passes(40);
    }
    polls_to(TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(GET_FREQUENCY);
}

void test_after_a_lost_reply_to_a_step_the_frequency_is_read(void)
{
    begins_to_set(700, 600);
    finds_quiet_and_sends(FASTER_ONE);
    asks_in_vain(GET_FREQUENCY);
    rig_feed_frequency(700); /* The step was made, although its reply was lost. */
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_UINT16(700, tmini_frequency_chz(&rig.lidar));
}

void test_a_repeated_reply_to_a_step_is_not_taken_as_the_reply_to_the_next(void)
{
    begins_to_set(800, 600);
    steps(FASTER_ONE, 700);
    passes(50);
    polls_and_sends(FASTER_ONE);
    polls_to(TMINI_EVENT_NONE);
    rig_feed_frequency(700); /* The same reply again. */
    passes(10);
    rig_feed_frequency(800); /* The reply to the step. */
    steps(GET_FREQUENCY, 800);
    arrives_at(800);
}

void test_a_lidar_that_refuses_to_step_fails_with_the_reply_after_three_attempts(void)
{
    begins_to_set(700, 600);
    for (unsigned attempt = 1; attempt <= 3; attempt++) {
        steps(FASTER_ONE, 600);
        passes(2000);
        if (attempt < 3) {
            polls_to(TMINI_EVENT_NONE);
            polls_and_sends(STOP);
            finds_quiet_and_sends(GET_FREQUENCY);
            rig_feed_frequency(600);
            polls_to(TMINI_EVENT_NONE);
        }
    }
    fails_with(TMINI_ERROR_REPLY);
}

void test_after_a_late_reply_to_a_step_a_noisy_line_fails_with_a_timeout(void)
{
    rig.timing.max_attempts = 1;
    rig_init();
    begins_to_set(800, 600);
    steps(FASTER_ONE, 600); /* As if the step was refused. */
    passes(10);
    rig_feed_frequency(700); /* But it was only late. */
    for (unsigned ms = 0; ms < 600; ms += 40) {
        passes(40);
        rig_feed_byte(0x00);
    }
    fails_with(TMINI_ERROR_TIMEOUT);
}

void test_a_lidar_that_falls_silent_after_refusing_a_step_fails_with_a_timeout(void)
{
    begins_to_set(700, 600);
    steps(FASTER_ONE, 600);
    asks_in_vain(GET_FREQUENCY);
    asks_in_vain(GET_FREQUENCY);
    passes(2000);
    fails_with(TMINI_ERROR_TIMEOUT);
}

void test_a_port_that_fails_after_a_refused_step_fails_the_command_with_write(void)
{
    begins_to_set(700, 600);
    steps(FASTER_ONE, 600);
    passes_to(2000, TMINI_EVENT_NONE);
    sends_both_taking(STOP, -1);
    fails_with(TMINI_ERROR_WRITE);
}

/* Each step changes the frequency by too little. */
static void fails_after_twenty_steps(void)
{
    begins_to_set(600, 2000);
    for (unsigned step = 1; step <= 20; step++) {
        steps(SLOWER_ONE, (uint16_t)(2000 - step));
    }
    polls_to(TMINI_EVENT_NONE);
    passes(50);
    fails_with(TMINI_ERROR_REPLY);
}

void test_a_frequency_that_is_never_reached_fails_with_the_reply_after_twenty_steps(void)
{
    fails_after_twenty_steps();
}

void test_the_next_command_steps_again(void)
{
    fails_after_twenty_steps();
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(700);
    polls_to(TMINI_EVENT_NONE);
    steps(SLOWER_ONE, 600);
    steps(GET_FREQUENCY, 600);
    arrives_at(600);
}

void test_another_wish_meanwhile_has_twenty_steps_of_its_own(void)
{
    begins_to_set(600, 2000);
    steps(SLOWER_ONE, 1999);
    begins(tmini_set_frequency(&rig.lidar, 700));
    for (unsigned step = 1; step <= 20; step++) {
        steps(SLOWER_ONE, (uint16_t)(1999 - step));
    }
    polls_to(TMINI_EVENT_NONE);
    passes(50);
    fails_with(TMINI_ERROR_REPLY);
}

void test_a_read_back_that_differs_is_stepped_further(void)
{
    begins_to_set(700, 600);
    steps(FASTER_ONE, 700);
    steps(GET_FREQUENCY, 690);
    polls_to(TMINI_EVENT_NONE);
    steps(FASTER_TENTH, 700);
    steps(GET_FREQUENCY, 700);
    arrives_at(700);
}

/* The header of a packet of 250 bytes. */
void test_a_packet_that_was_cut_off_between_two_steps_does_not_hide_the_next_reply(void)
{
    static const uint8_t header[] = {0xAA, 0x55, 0x00, 0x50, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00};

    begins_to_set(700, 600);
    steps(FASTER_ONE, 700);
    rig_feed(header, sizeof header);
    steps(GET_FREQUENCY, 700);
    arrives_at(700);
}

/* 20 Hz; the specified maximum is 12 Hz. */
void test_the_largest_plausible_frequency_is_reported(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(2000);
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_UINT16(2000, tmini_frequency_chz(&rig.lidar));
}

/* 1 Hz. */
void test_the_smallest_plausible_frequency_is_reported(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(100);
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_UINT16(100, tmini_frequency_chz(&rig.lidar));
}

void test_an_absurd_frequency_fails_the_command(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(2001);
    fails_with(TMINI_ERROR_REPLY);
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(65535);
    fails_with(TMINI_ERROR_REPLY);
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(65536 + 600);
    fails_with(TMINI_ERROR_REPLY);
}

void test_frequencies_out_of_range_or_between_steps_are_refused_and_nothing_is_sent(void)
{
    static const uint16_t refused[] = {0, 590, 599, 605, 1195, 1201, 1210, 65530, 65535};

    rig_go_idle();
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_set_frequency(&rig.lidar, refused[i]));
    }
    is_in(TMINI_STATE_IDLE);
}

void test_both_ends_of_the_frequency_range_are_accepted(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 600));
    rig_feed_frequency(600);
    arrives_at(600);
    begins_with(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 1200));
    rig_feed_frequency(1200);
    arrives_at(1200);
}

/* ---- One command after the other ---- */

void test_a_repeated_command_does_not_make_the_state_unknown_after_the_next_one(void)
{
    is_idle_and_asked(GET_HEALTH, tmini_request_health(&rig.lidar));
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(GET_HEALTH);
    rig_feed_health(0, 0);
    polls_to(TMINI_EVENT_HEALTH);
    is_in(TMINI_STATE_UNKNOWN);
    begins_with(STOP, tmini_request_health(&rig.lidar));
    finds_quiet_and_sends(GET_HEALTH);
    rig_feed_health(0, 0);
    polls_to(TMINI_EVENT_HEALTH);
    is_in(TMINI_STATE_IDLE);
}

/* ---- A port that is slow, or fails ---- */

void test_what_the_port_does_not_take_is_offered_again_at_each_poll(void)
{
    sends_both_taking(STOP, 0);
    begins(tmini_stop(&rig.lidar));
    sends_both_taking(STOP, 0);
    polls_to(TMINI_EVENT_NONE);
    sends_both_taking(STOP, 1);
    polls_to(TMINI_EVENT_NONE);
    sends_rest_taking(STOP, 0);
    polls_to(TMINI_EVENT_NONE);
    sends_rest_taking(STOP, 1);
    polls_to(TMINI_EVENT_NONE);
    passes(50); /* Counted from when the last byte was sent. */
    polls_to(TMINI_EVENT_STOPPED);
}

void test_the_rest_of_a_command_is_offered_again_even_if_nothing_has_happened(void)
{
    polls_to(TMINI_EVENT_NONE);
    sends_both_taking(STOP, 1);
    begins(tmini_stop(&rig.lidar));
    sends_rest_taking(STOP, 1);
    polls_to(TMINI_EVENT_NONE);
}

void test_the_wait_for_a_quiet_line_begins_when_the_command_has_left(void)
{
    sends_both_taking(STOP, 0);
    begins(tmini_stop(&rig.lidar));
    rig.now_ms += 60;
    polls_and_sends(STOP);
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_a_port_that_takes_a_command_at_the_last_moment_has_taken_it(void)
{
    sends_both_taking(STOP, 0);
    begins(tmini_stop(&rig.lidar));
    rig.now_ms += 150; /* There was no poll. */
    polls_and_sends(STOP);
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_a_port_that_claims_more_than_it_was_given_has_taken_all(void)
{
    sends_both_taking(STOP, 3);
    begins(tmini_stop(&rig.lidar));
    passes_to(50, TMINI_EVENT_STOPPED);
}

void test_a_port_that_fails_is_asked_once_more_when_time_has_passed_and_then_fails_the_command(void)
{
    sends_both_taking(STOP, -1);
    begins(tmini_stop(&rig.lidar));
    is_in(TMINI_STATE_STOPPING);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms += 1;
    sends_both_taking(STOP, -1);
    fails_with(TMINI_ERROR_WRITE);
    TEST_ASSERT_EQUAL_UINT(0, rig_counters().timeouts);
}

void test_a_port_that_fails_once_fails_no_command(void)
{
    sends_both_taking(STOP, -1);
    begins(tmini_request_info(&rig.lidar));
    rig.now_ms += 1;
    polls_and_sends(STOP);
    finds_quiet_and_sends(GET_INFO);
    rig_feed_info();
    polls_to(TMINI_EVENT_INFO);
}

/* As in a main loop that polls until nothing is left and repeats a failed request at once. */
void test_a_loop_that_repeats_every_failed_command_ends(void)
{
    sends_both_taking(STOP, -1);
    begins(tmini_request_info(&rig.lidar));
    polls_to(TMINI_EVENT_NONE);
    for (unsigned ms = 1; ms < 5; ms++) {
        tmini_event_t event;

        rig.now_ms += 1;
        sends_both_taking(STOP, -1); /* The old request fails. */
        sends_both_taking(STOP, -1); /* The new request begins. */
        while ((event = tmini_poll(&rig.lidar)) != TMINI_EVENT_NONE) {
            TEST_ASSERT_EQUAL_INT(TMINI_EVENT_COMMAND_FAILED, event);
            begins(tmini_request_info(&rig.lidar));
        }
        was_sent();
    }
}

void test_a_port_that_takes_nothing_fails_the_command_after_100_ms(void)
{
    sends_both_taking(STOP, 0);
    begins(tmini_stop(&rig.lidar));
    rig.now_ms += 99;
    sends_both_taking(STOP, 0);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms += 1;
    sends_both_taking(STOP, 0);
    fails_with(TMINI_ERROR_WRITE);
}

void test_a_port_that_takes_half_a_command_fails_it_after_100_ms(void)
{
    sends_both_taking(STOP, 1);
    begins(tmini_stop(&rig.lidar));
    rig.now_ms += 100;
    sends_rest_taking(STOP, 0);
    fails_with(TMINI_ERROR_WRITE);
}

void test_a_command_given_up_is_not_sent_any_further(void)
{
    sends_both_taking(STOP, 0);
    begins(tmini_stop(&rig.lidar));
    rig.now_ms += 100;
    sends_both_taking(STOP, 0);
    fails_with(TMINI_ERROR_WRITE);
    passes(1000);
}

void test_the_first_byte_of_a_command_given_up_serves_for_the_next_one(void)
{
    rig_go_idle();
    sends_both_taking(GET_INFO, 1);
    begins(tmini_request_info(&rig.lidar));
    sends_rest_taking(STOP, 1);
    begins(tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    passes_to(50, TMINI_EVENT_STOPPED);
    begins_with(GET_INFO, tmini_request_info(&rig.lidar));
}

void test_the_first_byte_serves_for_the_next_command_also_when_the_second_failed(void)
{
    rig_go_idle();
    sends_both_taking(GET_INFO, 1);
    begins(tmini_request_info(&rig.lidar));
    sends_rest_taking(GET_INFO, -1);
    fails_with(TMINI_ERROR_WRITE);
    sends_rest_taking(STOP, 1);
    begins(tmini_request_info(&rig.lidar));
}

void test_a_stop_that_fails_is_reported_apart_from_the_command_it_aborts(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    sends_both_taking(STOP, -1);
    begins(tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ABORTED, tmini_command_error(&rig.lidar));
    sends_both_taking(STOP, -1);
    fails_with(TMINI_ERROR_WRITE);
    passes(1000);
}

void test_a_start_that_has_not_left_is_not_sent_into_a_stream_that_is_back(void)
{
    rig_go_idle();
    sends_both_taking(START, 0);
    begins(tmini_start(&rig.lidar));
    rig_feed_point_packet(1000); /* The lidar already scans: it has missed the stop. */
    polls_to(TMINI_EVENT_STARTED);
    (void)rig_drain();
    passes(999);
}

void test_half_a_start_that_has_not_left_is_completed_by_the_next_stop(void)
{
    rig_go_idle();
    sends_both_taking(START, 1);
    begins(tmini_start(&rig.lidar));
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    (void)rig_drain();
    sends_rest_taking(STOP, 1);
    begins(tmini_stop(&rig.lidar));
}

void test_the_time_for_a_reply_begins_when_the_command_has_left(void)
{
    rig_go_idle();
    sends_both_taking(GET_INFO, 0);
    begins(tmini_request_info(&rig.lidar));
    rig.now_ms += 90;
    polls_and_sends(GET_INFO);
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
}
