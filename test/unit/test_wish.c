/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Wishes that stand until changed: a start, a stop, a frequency. Also listening only, and the steps
 * applied to a finished scan. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "unity.h"

static unsigned restarts;

void setUp(void)
{
    rig_open();
    restarts = 0;
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

static void count_restart(void *context)
{
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    restarts++;
}

static void want(uint16_t frequency_chz)
{
    rig.config.frequency_chz = frequency_chz;
    rig_init();
}

/* A start sends a stop and, after the quiet time, the query for the frequency. */
static void asks_for_the_frequency(void)
{
    begins_with(STOP, tmini_start(&rig.lidar));
    finds_quiet_and_sends(GET_FREQUENCY);
}

static void starts_scanning(void)
{
    rig_feed_scan_reply();
    polls_to(TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
}

/* The query for the frequency has been sent. */
static void starts_turning_at(uint16_t frequency_chz)
{
    rig_feed_frequency(frequency_chz);
    polls_to(TMINI_EVENT_FREQUENCY);
    polls_and_sends(START);
    starts_scanning();
}

static void scans_wishing(uint16_t frequency_chz)
{
    want(frequency_chz);
    asks_for_the_frequency();
    starts_turning_at(frequency_chz);
}

/* ---- The frequency, before every start ---- */

void test_a_start_asks_for_the_wanted_frequency_first(void)
{
    want(1000);
    asks_for_the_frequency();
    rig_feed_frequency(1000);
    polls_to(TMINI_EVENT_FREQUENCY);
    is_in(TMINI_STATE_STARTING);
    polls_and_sends(START); /* The line is quiet: no stop. */
    starts_scanning();
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT16(1000, tmini_frequency_chz(&rig.lidar));
}

void test_a_start_sets_another_frequency_first(void)
{
    want(700);
    asks_for_the_frequency();
    rig_feed_frequency(600);
    finds_quiet_and_sends(FASTER_ONE);
    rig_feed_frequency(700);
    finds_quiet_and_sends(GET_FREQUENCY);
    rig_feed_frequency(700);
    polls_to(TMINI_EVENT_FREQUENCY);
    polls_and_sends(START);
}

void test_packets_while_the_frequency_is_asked_for_are_no_start(void)
{
    want(1000);
    asks_for_the_frequency();
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_STARTING);
}

/* The query for the frequency has been sent. The lidar ignores all commands but the start. */
static void starts_without_the_frequency(void)
{
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    starts_scanning();
    polls_to(TMINI_EVENT_COMMAND_FAILED);
}

void test_without_a_reply_the_start_follows_and_the_failure_is_reported_when_it_scans(void)
{
    want(1000);
    asks_for_the_frequency();
    starts_without_the_frequency();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_command_error(&rig.lidar));
    is_in(TMINI_STATE_SCANNING);
}

void test_an_attempt_without_any_reply_is_reported_once(void)
{
    want(1000);
    asks_for_the_frequency();
    passes_to(2000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    passes_to(2000, TMINI_EVENT_COMMAND_FAILED);
    is_in(TMINI_STATE_STARTING);
    passes_to(500, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
}

void test_after_a_loss_the_frequency_is_not_known_and_asked_for_again(void)
{
    scans_wishing(1000);
    passes_to(1000, TMINI_EVENT_LOST);
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&rig.lidar));
    polls_and_sends(STOP);
    finds_quiet_and_sends(GET_FREQUENCY);
    passes(2000); /* No reply; nothing new is reported. */
    polls_to(TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_command_error(&rig.lidar));
}

void test_a_frequency_that_cannot_be_read_again_is_unknown(void)
{
    scans_wishing(1000);
    is_idle_and_asked(GET_FREQUENCY, tmini_start(&rig.lidar));
    starts_without_the_frequency();
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&rig.lidar));
}

void test_a_reboot_leaves_the_frequency_unknown(void)
{
    is_idle_and_asked(GET_FREQUENCY, tmini_request_frequency(&rig.lidar));
    rig_feed_frequency(800);
    polls_to(TMINI_EVENT_FREQUENCY);
    TEST_ASSERT_EQUAL_UINT16(800, tmini_frequency_chz(&rig.lidar));
    begins_with(REBOOT, tmini_reboot(&rig.lidar));
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&rig.lidar));
}

void test_a_wish_during_a_query_is_kept_for_the_start_that_follows(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    begins(tmini_set_frequency(&rig.lidar, 900));
    begins(tmini_start(&rig.lidar));
    is_in(TMINI_STATE_BUSY);
    rig_feed_info();
    polls_to(TMINI_EVENT_INFO);
    is_in(TMINI_STATE_STARTING);
    polls_and_sends(GET_FREQUENCY);
}

void test_a_start_follows_a_stop_that_is_under_way(void)
{
    rig_go_idle();
    begins_with(STOP, tmini_stop(&rig.lidar));
    begins(tmini_start(&rig.lidar));
    passes_to(50, TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_STARTING);
    polls_and_sends(START);
}

void test_a_stop_takes_back_the_start_that_was_to_follow(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
    begins(tmini_start(&rig.lidar));
    begins_with(STOP, tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_COMMAND_FAILED);
    passes_to(50, TMINI_EVENT_STOPPED);
    is_in(TMINI_STATE_IDLE);
}

void test_the_same_wish_again_disturbs_no_scan(void)
{
    scans_wishing(1000);
    begins(tmini_set_frequency(&rig.lidar, 1000));
    begins(tmini_start(&rig.lidar));
    is_in(TMINI_STATE_SCANNING);
    polls_to(TMINI_EVENT_NONE);
}

void test_a_new_wish_while_recovering_still_ends_with_recovered(void)
{
    rig_go_recovering();
    begins_with(STOP, tmini_set_frequency(&rig.lidar, 900));
    is_in(TMINI_STATE_RECOVERING);
    finds_quiet_and_sends(GET_FREQUENCY);
    rig_feed_frequency(900);
    polls_to(TMINI_EVENT_FREQUENCY);
    polls_and_sends(START);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
}

void test_a_new_wish_for_a_lost_lidar_that_is_not_recovered_waits(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    rig_init();
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    begins(tmini_set_frequency(&rig.lidar, 900));
    passes(60000);
    is_in(TMINI_STATE_RECOVERING);
}

/* Silence before the stop does not count as silence after it. */
void test_a_new_wish_after_a_pause_of_polls_awaits_a_quiet_line(void)
{
    rig_go_scanning();
    rig.now_ms += 60;
    begins_with(STOP, tmini_set_frequency(&rig.lidar, 700));
    finds_quiet_and_sends(GET_FREQUENCY);
}

/* Six steps of 1 Hz; after the last one another frequency is wanted. */
static void steps(uint8_t code, uint16_t from_chz, int by_chz, uint16_t then_chz)
{
    for (int i = 1; i <= 6; i++) {
        finds_quiet_and_sends(code);
        rig_feed_frequency((uint16_t)(from_chz + i * by_chz));
    }
    begins(tmini_set_frequency(&rig.lidar, then_chz));
}

/* The user moves a slider: 24 steps, more than a single change needs. */
void test_each_new_wish_has_as_many_steps_as_it_needs(void)
{
    rig_go_idle();
    begins_with(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 1200));
    rig_feed_frequency(600);
    steps(FASTER_ONE, 600, 100, 600);
    steps(SLOWER_ONE, 1200, -100, 1200);
    steps(FASTER_ONE, 600, 100, 600);
    steps(SLOWER_ONE, 1200, -100, 600);
    finds_quiet_and_sends(GET_FREQUENCY);
    rig_feed_frequency(600);
    polls_to(TMINI_EVENT_FREQUENCY);
}

/* The lidar steps up and down. The driver gives up after 20 steps, even if the wish is repeated. */
void test_a_wish_that_is_stated_again_has_no_more_steps(void)
{
    rig_go_idle();
    begins_with(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 1000));
    rig_feed_frequency(600);
    for (int i = 0; i < 20; i++) {
        finds_quiet_and_sends(FASTER_ONE);
        begins(tmini_set_frequency(&rig.lidar, 1000));
        rig_feed_frequency(i % 2 == 0 ? 700 : 600);
    }
    passes_to(50, TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_REPLY, tmini_command_error(&rig.lidar));
}

/* ---- Measured and wanted frequency ---- */

static void turns(unsigned count, uint8_t dhz)
{
    for (unsigned i = 0; i < count; i++) {
        rig.now_ms += 150;
        rig_feed_packet((uint8_t)(dhz << 1 | 1), 1, 1000);
        (void)rig_drain();
    }
}

/* The last of this many revolutions at this frequency makes the driver stop the lidar. */
static void is_stopped_after(unsigned count, uint8_t dhz)
{
    turns(count - 1, dhz);
    is_in(TMINI_STATE_SCANNING);
    sends(STOP);
    turns(1, dhz);
    was_sent();
}

/* At 6.0 Hz, 18 revolutions are 3 seconds. */
void test_three_seconds_of_another_frequency_are_a_fault_and_one_more_try(void)
{
    scans_wishing(1000);
    turns(17, 60);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    is_stopped_after(1, 60);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_UINT16(0, tmini_frequency_chz(&rig.lidar));
    is_in(TMINI_STATE_STARTING);
    finds_quiet_and_sends(GET_FREQUENCY);
    starts_turning_at(1000);
    turns(40, 60); /* No further attempt. */
    is_in(TMINI_STATE_SCANNING);
    turns(1, 100);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

static void is_tried_again_after(const unsigned counts[6], uint8_t dhz)
{
    scans_wishing(1000);
    for (unsigned n = 0; n < 6; n++) {
        is_stopped_after(counts[n], dhz);
        is_in(TMINI_STATE_STARTING);
        TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
        finds_quiet_and_sends(GET_FREQUENCY);
        starts_without_the_frequency();
    }
}

/* 18, 36, 72 and 144 revolutions at 6.0 Hz take 3, 6, 12 and 24 seconds. The limit is 255
 * revolutions. */
void test_a_frequency_that_could_not_be_set_is_tried_again_less_and_less_often(void)
{
    static const unsigned counts[] = {18, 36, 72, 144, 255, 255};

    is_tried_again_after(counts, 60);
}

/* 144 revolutions at 3.0 Hz take 48 seconds. */
void test_a_frequency_is_tried_again_after_48_seconds_at_most(void)
{
    static const unsigned counts[] = {9, 18, 36, 72, 144, 144};

    is_tried_again_after(counts, 30);
}

/* The rotor comes up to speed and beyond: 9, 10, 11 Hz. */
void test_a_rotor_that_passes_through_the_wanted_frequency_is_not_stopped_again(void)
{
    scans_wishing(1000);
    is_stopped_after(33, 110);
    finds_quiet_and_sends(GET_FREQUENCY);
    starts_turning_at(1000);
    turns(3, 90);
    turns(1, 100);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    turns(32, 110);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    turns(1, 110); /* A fault again after three seconds. */
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
    turns(500, 110);
    is_in(TMINI_STATE_SCANNING);
}

/* The lidar replies each time with its old frequency. */
void test_a_frequency_that_the_lidar_refuses_is_tried_once_more_only(void)
{
    scans_wishing(1000);
    is_stopped_after(18, 60);
    finds_quiet_and_sends(GET_FREQUENCY);
    rig_feed_frequency(600);
    finds_quiet_and_sends(FASTER_ONE);
    rig_feed_frequency(600);
    polls_to(TMINI_EVENT_NONE);
    starts_without_the_frequency();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_REPLY, tmini_command_error(&rig.lidar));
    turns(100, 60);
    is_in(TMINI_STATE_SCANNING);
}

void test_a_frequency_that_is_off_after_a_loss_is_a_new_fault(void)
{
    scans_wishing(1000);
    is_stopped_after(18, 60);
    finds_quiet_and_sends(GET_FREQUENCY);
    starts_turning_at(1000);
    passes_to(1000, TMINI_EVENT_LOST);
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_a_new_wish_is_tried_again_after_three_seconds(void)
{
    scans_wishing(1000);
    is_stopped_after(18, 60);
    finds_quiet_and_sends(GET_FREQUENCY);
    starts_turning_at(1000);
    turns(1, 100);
    begins_with(STOP, tmini_set_frequency(&rig.lidar, 900));
    finds_quiet_and_sends(GET_FREQUENCY);
    starts_turning_at(900);
    is_stopped_after(18, 60);
}

void test_a_frequency_five_percent_off_is_no_fault(void)
{
    scans_wishing(1000);
    turns(40, 95);
    turns(40, 105);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    sends(STOP);
    turns(32, 106);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

/* 0.4 Hz is 5.3 % of 7.6 Hz. At 8.0 Hz, 24 turns take 3 s. */
void test_slightly_more_than_five_percent_off_is_a_fault(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(760);
    turns(24, 80);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

/* Off by 2.6 Hz; 260 would be 4 in 8 bits. At 7.4 Hz, 23 turns take 3.1 s. */
void test_a_frequency_far_off_is_a_fault(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(23, 74);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

/* At 0.6 Hz two turns take 3.3 s. */
void test_two_slow_turns_are_no_fault_and_three_are(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(2, 6);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    turns(1, 6);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_another_frequency_is_a_fault_beside_the_others(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    for (unsigned i = 0; i < 18; i++) {
        (void)rig_turn_events(TMINI_FAULT_PD);
    }
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_PD | TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_what_was_off_before_a_stop_does_not_count_after_it(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(17, 60);
    is_idle_and_asked(GET_FREQUENCY, tmini_start(&rig.lidar));
    starts_turning_at(1000);
    turns(17, 60);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    turns(1, 60);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_a_frequency_that_is_right_every_18th_turn_is_no_fault(void)
{
    scans_wishing(1000);
    for (unsigned i = 0; i < 10; i++) {
        turns(17, 60);
        turns(1, 100);
    }
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_without_recovery_another_frequency_is_only_a_fault(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(300, 60);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
    is_in(TMINI_STATE_SCANNING);
}

/* A program may repeat its wish in each pass of its loop. */
void test_a_wish_that_is_stated_again_and_again_hides_no_other_frequency(void)
{
    scans_wishing(1000);
    for (unsigned i = 0; i < 17; i++) {
        turns(1, 60);
        begins(tmini_set_frequency(&rig.lidar, 1000));
    }
    sends(STOP);
    turns(1, 60);
    was_sent();
    is_in(TMINI_STATE_STARTING);
    begins(tmini_set_frequency(&rig.lidar, 1000));
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_a_wish_that_is_stated_again_does_not_clear_the_fault(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(300, 60);
    (void)rig_drain();
    begins(tmini_set_frequency(&rig.lidar, 1000));
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_another_wish_clears_the_fault_which_is_reported(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(300, 60);
    (void)rig_drain();
    begins_with(STOP, tmini_set_frequency(&rig.lidar, 800));
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_another_wish_of_a_lidar_that_is_stopping_clears_the_fault_at_once(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(300, 60);
    begins_with(STOP, tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_NONE);
    begins(tmini_set_frequency(&rig.lidar, 800));
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
}

void test_another_wish_of_an_idle_lidar_clears_the_fault_as_well(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    scans_wishing(1000);
    turns(300, 60);
    (void)rig_drain();
    rig.lidar.state = TMINI_STATE_IDLE;
    begins_with(GET_FREQUENCY, tmini_set_frequency(&rig.lidar, 800));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
}

void test_a_frequency_that_is_not_reported_is_no_fault(void)
{
    scans_wishing(1000);
    turns(100, 0);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_without_a_wish_any_frequency_is_right(void)
{
    rig_go_scanning();
    turns(100, 60);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

/* ---- A lidar without start packets ---- */

static void ranges_without_start(unsigned samples)
{
    for (; samples > 0; samples -= 40) {
        rig_feed_packet(0, 40, 1000);
        (void)rig_drain();
    }
}

void test_three_seconds_of_ranges_without_a_start_packet_are_a_fault_and_three_more_a_loss(void)
{
    rig_go_scanning();
    rig_feed_start_packet(1000);
    (void)rig_drain();
    ranges_without_start(11960);
    rig_feed_packet(0, 39, 1000);
    (void)rig_drain();
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    rig_feed_packet(0, 1, 1000);
    (void)rig_drain();
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
    is_in(TMINI_STATE_SCANNING);
    ranges_without_start(11960);
    is_in(TMINI_STATE_SCANNING);
    sends(STOP);
    ranges_without_start(40);
    is_in(TMINI_STATE_RECOVERING);
}

/* 300 packets are three seconds; `count` of them have a range. */
static void packets_with_a_range(unsigned count)
{
    for (unsigned i = 0; i < 300; i++) {
        rig_feed_packet(0, 40, i < count ? 1000 : 0);
        (void)rig_drain();
    }
}

void test_without_start_packets_100_of_300_packets_with_a_range_are_a_loss_and_99_are_not(void)
{
    rig_go_scanning();
    rig_feed_start_packet(0);
    (void)rig_drain();
    packets_with_a_range(0);
    packets_with_a_range(99);
    is_in(TMINI_STATE_SCANNING);
    sends(STOP);
    packets_with_a_range(100);
    is_in(TMINI_STATE_RECOVERING);
}

/* Without start packets and ranges, the rotor is blocked. */
void test_samples_without_a_range_and_without_a_start_packet_are_no_loss(void)
{
    rig_go_scanning();
    for (unsigned samples = 0; samples < 60000; samples += 40) {
        rig_feed_packet(0, 40, 0);
        (void)rig_drain();
    }
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
    is_in(TMINI_STATE_SCANNING);
}

/* ---- Without recovery ---- */

void test_without_recovery_a_start_fails_once_after_all_its_attempts(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    rig.timing.max_attempts = 1;
    rig_init();
    rig_go_starting();
    passes_to(2000, TMINI_EVENT_COMMAND_FAILED);
    is_in(TMINI_STATE_UNKNOWN);
    passes(60000);
    begins_with(STOP, tmini_start(&rig.lidar));
    is_in(TMINI_STATE_STARTING);
}

/* ---- The port's receiver ---- */

void test_the_port_restarts_its_reception_at_a_loss_and_after_each_attempt_that_failed(void)
{
    rig.port.restart = count_restart;
    rig_go_recovering();
    TEST_ASSERT_EQUAL_UINT(1, restarts);
    finds_quiet_and_sends(START);
    passes_to(2000, TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT(2, restarts);
}

void test_without_recovery_a_start_that_failed_restarts_the_reception_as_well(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    rig.port.restart = count_restart;
    rig.timing.max_attempts = 1;
    rig_init();
    rig_go_starting();
    passes_to(2000, TMINI_EVENT_COMMAND_FAILED);
    TEST_ASSERT_EQUAL_UINT(1, restarts);
}

/* ---- Listening ---- */

static void listen(void)
{
    rig.config.listen_only = true;
    rig.port.write = NULL;
    rig.port.restart = count_restart;
    rig_init();
    begins(tmini_start(&rig.lidar));
}

void test_a_listener_scans_from_the_first_packet(void)
{
    listen();
    is_in(TMINI_STATE_STARTING);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    is_in(TMINI_STATE_SCANNING);
}

/* After three seconds, then at the intervals of the ladder's pauses. */
void test_a_listener_that_hears_nothing_reports_it_at_growing_intervals(void)
{
    static const uint32_t pauses[] = {3000, 500, 1000, 2000, 4000, 4000};
    listen();
    for (unsigned i = 0; i < sizeof pauses / sizeof pauses[0]; i++) {
        passes_to(pauses[i] - 1, TMINI_EVENT_NONE);
        passes_to(1, TMINI_EVENT_COMMAND_FAILED);
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_TIMEOUT, tmini_command_error(&rig.lidar));
        is_in(TMINI_STATE_STARTING);
        TEST_ASSERT_EQUAL_UINT(i + 1, restarts);
    }
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
}

void test_without_recovery_a_listener_that_hears_nothing_gives_up_once(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    listen();
    passes_to(2999, TMINI_EVENT_NONE);
    passes_to(1, TMINI_EVENT_COMMAND_FAILED);
    is_in(TMINI_STATE_UNKNOWN);
    passes_to(60000, TMINI_EVENT_NONE);
}

void test_a_listener_that_hears_nothing_for_a_second_has_lost_its_lidar(void)
{
    listen();
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    passes_to(1000, TMINI_EVENT_LOST);
    passes_to(1000, TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
}

void test_a_listener_stops_at_once_and_hears_no_more(void)
{
    listen();
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    polls_to(TMINI_EVENT_NONE); /* The driver settles. */
    begins(tmini_stop(&rig.lidar));
    polls_to(TMINI_EVENT_STOPPED);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_UNKNOWN);
}

void test_a_listener_refuses_every_query_and_frequency(void)
{
    listen();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_request_info(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_request_health(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_request_frequency(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_reboot(&rig.lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_LISTEN_ONLY, tmini_set_frequency(&rig.lidar, 700));
}

/* ---- Configurations ---- */

static void is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_init(&rig.lidar, &rig.config));
}

void test_a_null_decoder_is_an_argument_error(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_decoder_init(NULL, &rig.lidar.ring, 0));
}

static void is_taken(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&rig.lidar, &rig.config));
}

void test_a_wanted_frequency_is_6_to_12_hz_in_tenths(void)
{
    static const uint16_t wrong[] = {590, 599, 605, 1201, 1210};
    for (unsigned i = 0; i < 5; i++) {
        rig.config.frequency_chz = wrong[i];
        is_refused();
    }
    rig.config.frequency_chz = 600;
    is_taken();
    rig.config.frequency_chz = 1200;
    is_taken();
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_set_frequency(&rig.lidar, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_set_frequency(NULL, 600));
}

void test_a_listener_sets_no_frequency(void)
{
    rig.config.listen_only = true;
    rig.config.frequency_chz = 600;
    is_refused();
}

static void step(const void *data, tmini_scan_t *scan)
{
    TEST_ASSERT_EQUAL_PTR(&rig, data);
    for (unsigned i = 0; i < scan->count; i++) {
        scan->points[i].distance_mm++;
    }
}

void test_steps_and_spare_points_need_points_and_data_needs_a_step(void)
{
    static tmini_point_t spare[RIG_POINTS];
    rig.config.step_data = &rig;
    is_refused();
    rig.config.step = step;
    is_taken();
    rig.config.points = NULL;
    rig.config.max_points = 0;
    is_refused();
    rig.config.step = NULL;
    rig.config.step_data = NULL;
    is_taken();
    rig.config.spare_points = spare;
    is_refused();
}

/* ---- Steps applied to a finished scan, and spare points ---- */

static void scan_turns(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        rig.now_ms += 160;
        rig_feed_plain_turn((uint16_t)(1000 + 100 * i));
    }
}

void test_a_step_changes_each_scan_once_before_it_is_delivered(void)
{
    rig.config.step = step;
    rig.config.step_data = &rig;
    rig_init();
    rig_go_scanning();
    scan_turns(2);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(1001, tmini_scan(&rig.lidar)->points[0].distance_mm);
    scan_turns(1);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_UINT16(1101, tmini_scan(&rig.lidar)->points[0].distance_mm);
}

void test_with_spare_points_a_scan_stays_until_the_next(void)
{
    static tmini_point_t spare[RIG_POINTS];
    rig.config.spare_points = spare;
    rig_init();
    rig_go_scanning();
    scan_turns(2);
    polls_to(TMINI_EVENT_SCAN);
    const tmini_scan_t *const scan = tmini_scan(&rig.lidar);
    TEST_ASSERT_EQUAL_PTR(rig.points, scan->points);
    polls_to(TMINI_EVENT_NONE); /* The next scan is stored elsewhere. */
    TEST_ASSERT_EQUAL_UINT16(17, scan->count);
    TEST_ASSERT_EQUAL_UINT16(1000, scan->points[1].distance_mm);
    scan_turns(1);
    polls_to(TMINI_EVENT_SCAN);
    TEST_ASSERT_EQUAL_PTR(spare, tmini_scan(&rig.lidar)->points);
    polls_to(TMINI_EVENT_NONE);
    TEST_ASSERT_EQUAL_UINT16(1100, spare[1].distance_mm); /* The third is stored over the first. */
    TEST_ASSERT_EQUAL_UINT16(1000, rig.points[1].distance_mm);
}

/* ---- The receive buffer of a port with DMA ---- */

void test_the_receive_buffer_is_for_ports_with_dma(void)
{
    static const tmini_t nothing;
    size_t size = 1;
    TEST_ASSERT_NULL(tmini_rx_buffer(&nothing, &size));
    TEST_ASSERT_NULL(tmini_rx_buffer(&rig.lidar, &size));
    TEST_ASSERT_EQUAL_size_t(0, size);
    rig.config.rx_dma = true;
    rig.config.max_samples = 39;
    rig_init();
    TEST_ASSERT_EQUAL_PTR(rig.rx, tmini_rx_buffer(&rig.lidar, &size));
    TEST_ASSERT_EQUAL_size_t(sizeof rig.rx, size);
}
