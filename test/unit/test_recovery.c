/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar that is lost while it scans, and the ladder of attempts that recovers it. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "unity.h"

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

/* ---- Loss ---- */

void test_a_second_without_a_packet_is_a_loss(void)
{
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    is_in(TMINI_STATE_RECOVERING);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().losses);
}

void test_each_packet_puts_the_loss_off(void)
{
    rig_go_scanning();
    passes(999);
    rig_feed_point_packet(1000);
    passes(999);
    is_in(TMINI_STATE_SCANNING);
}

void test_bytes_without_valid_packets_are_a_loss_too(void)
{
    rig_go_scanning();
    for (unsigned ms = 0; ms < 1000; ms += 20) {
        rig_feed_byte(0xAA);
        passes(20);
    }
    polls_to(TMINI_EVENT_LOST);
}

void test_a_poll_that_comes_less_than_50_ms_late_reports_the_loss(void)
{
    rig_go_scanning();
    rig.now_ms += 1049;
    polls_to(TMINI_EVENT_LOST);
}

void test_a_poll_that_comes_later_gives_the_lidar_another_100_ms(void)
{
    rig_go_scanning();
    rig.now_ms += 1050;
    polls_to(TMINI_EVENT_NONE);
    passes(99);
    is_in(TMINI_STATE_SCANNING);
    passes_to(1, TMINI_EVENT_LOST);
}

void test_a_packet_in_the_100_ms_after_a_late_poll_averts_the_loss(void)
{
    rig_go_scanning();
    rig.now_ms += 3000;
    polls_to(TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    passes(999);
    is_in(TMINI_STATE_SCANNING);
    passes_to(1, TMINI_EVENT_LOST);
}

void test_packets_that_came_between_two_polls_are_no_loss(void)
{
    rig_go_scanning();
    rig_feed_point_packet(1000);
    rig.now_ms += 5000;
    polls_to(TMINI_EVENT_NONE);
    passes(999);
    is_in(TMINI_STATE_SCANNING);
}

/* ---- Recovery ---- */

void test_a_lost_lidar_is_stopped_and_when_the_line_is_quiet_started(void)
{
    rig_go_recovering(); /* The stop has been sent. */
    finds_quiet_and_sends(START);
    was_sent();
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().restarts);
}

void test_the_first_packet_recovers(void)
{
    rig_go_asking_again();
    rig_feed_scan_reply();
    polls_to(TMINI_EVENT_NONE);
    is_in(TMINI_STATE_RECOVERING);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    is_in(TMINI_STATE_SCANNING);
    (void)rig_drain();
    passes(999);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().recoveries);
}

/* An attempt has just failed: its pause, then the stop of the next attempt. */
static void pauses_and_stops(uint32_t pause_ms)
{
    passes_to(pause_ms, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
}

static void gets_no_reply(void)
{
    passes_to(2000, TMINI_EVENT_NONE);
}

static void tries_in_vain(uint32_t pause_ms)
{
    pauses_and_stops(pause_ms);
    finds_quiet_and_sends(START);
    gets_no_reply();
}

static void tries_with_a_reboot_in_vain(uint32_t pause_ms)
{
    pauses_and_stops(pause_ms);
    finds_quiet_and_sends(REBOOT);
    passes_to(5000, TMINI_EVENT_NONE);
    polls_and_sends(STOP);
    was_sent();
    finds_quiet_and_sends(START);
    gets_no_reply();
}

void test_the_ladder_starts_three_times_then_reboots_with_pauses_that_double_up_to_4_s(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    tries_in_vain(1000);
    tries_with_a_reboot_in_vain(2000);
    tries_in_vain(4000);
    tries_in_vain(4000);
    tries_with_a_reboot_in_vain(4000);
    tries_in_vain(4000);
    is_in(TMINI_STATE_RECOVERING);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().losses);
    TEST_ASSERT_EQUAL_UINT16(8, rig_counters().restarts);
    TEST_ASSERT_EQUAL_UINT16(2, rig_counters().reboots);
    TEST_ASSERT_EQUAL_UINT16(8, rig_counters().timeouts);
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().recoveries);
}

void test_the_ladder_has_no_end(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    tries_in_vain(1000);
    tries_with_a_reboot_in_vain(2000);
    for (unsigned round = 0; round < 200; round++) {
        tries_in_vain(4000);
        tries_in_vain(4000);
        tries_with_a_reboot_in_vain(4000);
    }
}

void test_a_loss_after_a_new_start_begins_the_ladder_again(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes_to(50, TMINI_EVENT_STOPPED);
    begins_with(START, tmini_start(&rig.lidar));
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    (void)rig_drain();
    passes_to(1000, TMINI_EVENT_LOST);
    sends(STOP); /* Sent without a pause. */
    polls_to(TMINI_EVENT_NONE);
}

void test_a_loss_after_a_whole_turn_begins_the_ladder_again(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    tries_in_vain(1000);
    rig_feed_start_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    rig_feed_start_packet(1000);
    (void)rig_drain();
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    gets_no_reply();
    tries_in_vain(500);
}

/* A weak supply: the lidar starts and fails again under the motor's current, several times. */
void test_an_attempt_that_brings_no_whole_turn_has_not_succeeded(void)
{
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    for (uint32_t pause_ms = 500; pause_ms < 2000; pause_ms *= 2) {
        rig_feed_point_packet(1000);
        polls_to(TMINI_EVENT_RECOVERED);
        (void)rig_drain();
        passes_to(1000, TMINI_EVENT_LOST);
        pauses_and_stops(pause_ms);
        finds_quiet_and_sends(START);
    }
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    (void)rig_drain();
    passes_to(1000, TMINI_EVENT_LOST);
    tries_with_a_reboot_in_vain(2000);
}

/* The same after the first attempts have failed. */
void test_a_loss_before_a_whole_turn_continues_the_ladder(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    rig_feed_start_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    rig_feed_point_packet(1000);
    (void)rig_drain();
    passes_to(1000, TMINI_EVENT_LOST);
    tries_with_a_reboot_in_vain(2000);
}

/* The turn has two stray bytes, but shows that there are ranges again. */
void test_a_turn_that_is_not_whole_but_ends_a_fault_does_not_count_as_whole(void)
{
    rig_go_scanning();
    rig_plain_turns(3, 0);
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    gets_no_reply();
    tries_in_vain(500);
    rig_feed_point_packet(1000);
    rig_feed_start_packet(1000);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_RECOVERED), rig_drain());
    rig_feed_byte(0);
    rig_feed_byte(0);
    rig_feed_point_packet(1000);
    rig_feed_start_packet(1000);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED) | BIT(TMINI_EVENT_SCAN), rig_drain());
    passes_to(1000, TMINI_EVENT_LOST);
    tries_with_a_reboot_in_vain(2000);
}

void test_the_first_pause_is_no_longer_than_the_longest(void)
{
    rig.timing.back_off_max_ms = 300;
    rig_init();
    rig_go_backing_off();
    pauses_and_stops(300);
}

void test_a_pause_doubles_up_to_the_longest_that_can_be_configured(void)
{
    rig.timing.back_off_max_ms = 65535;
    rig_init();
    rig_go_backing_off();
    for (unsigned failed = 1; failed < 8; failed++) {
        if (failed % 3 == 0) {
            tries_with_a_reboot_in_vain(250u << failed);
        } else {
            tries_in_vain(250u << failed);
        }
    }
    tries_in_vain(64000);
    pauses_and_stops(65535);
}

void test_a_pause_of_a_millisecond_can_be_configured(void)
{
    rig.timing.back_off_max_ms = 1;
    rig_init();
    rig_go_backing_off();
    rig.now_ms += 1;
    polls_to(TMINI_EVENT_NONE);
    polls_and_sends(STOP);
}

void test_a_start_that_is_acknowledged_but_brings_no_packet_is_a_failed_attempt(void)
{
    rig_go_asking_again();
    rig_feed_scan_reply();
    passes_to(3000, TMINI_EVENT_NONE);
    pauses_and_stops(500);
}

void test_a_line_that_does_not_fall_quiet_is_a_failed_attempt(void)
{
    rig_go_recovering();
    for (unsigned ms = 0; ms < 600; ms += 20) {
        rig_feed_byte(0x00);
        passes(20);
    }
    polls_to(TMINI_EVENT_NONE);
    pauses_and_stops(500);
}

void test_a_port_that_fails_makes_the_attempt_fail(void)
{
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    sends_both_taking(STOP, -1);
    polls_to(TMINI_EVENT_NONE);
    pauses_and_stops(500);
}

void test_a_port_that_takes_nothing_is_a_failed_attempt_and_nothing_is_sent_in_the_pause(void)
{
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
    sends_both_taking(STOP, 0);
    polls_to(TMINI_EVENT_NONE);
    rig.now_ms += 100;
    sends_both_taking(STOP, 0);
    polls_to(TMINI_EVENT_NONE);
    pauses_and_stops(500);
}

void test_a_lidar_that_comes_back_by_itself_in_the_pause_has_recovered(void)
{
    rig_go_backing_off();
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    (void)rig_drain();
    passes(999);
    is_in(TMINI_STATE_SCANNING);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().recoveries);
}

void test_a_lidar_that_comes_back_by_itself_while_it_is_being_rebooted_has_recovered(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    tries_in_vain(1000);
    pauses_and_stops(2000);
    finds_quiet_and_sends(REBOOT);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    (void)rig_drain();
    rig_feed_point_packet(1000);
    (void)rig_drain();
    passes(999);
    is_in(TMINI_STATE_SCANNING);
}

void test_a_lidar_that_comes_back_by_itself_after_a_reboot_that_failed_has_recovered(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    tries_in_vain(1000);
    passes_to(2000, TMINI_EVENT_NONE);
    sends_both_taking(STOP, -1); /* The stop before the reboot. */
    polls_to(TMINI_EVENT_NONE);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
}

void test_a_start_reply_that_comes_in_the_pause_does_not_end_it(void)
{
    rig_go_backing_off();
    rig_feed_scan_reply();
    pauses_and_stops(500);
}

void test_packets_between_the_stop_and_a_quiet_line_are_not_yet_a_recovery(void)
{
    rig_go_recovering();
    rig_feed_point_packet(1000);
    passes(50);
    is_in(TMINI_STATE_RECOVERING);
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().recoveries);
    polls_to(TMINI_EVENT_NONE);
    polls_and_sends(START);
}

void test_packets_before_the_reboot_of_the_ladder_are_not_yet_a_recovery(void)
{
    rig_go_backing_off();
    tries_in_vain(500);
    tries_in_vain(1000);
    pauses_and_stops(2000);
    rig_feed_point_packet(1000);
    finds_quiet_and_sends(REBOOT);
}

void test_after_a_recovery_no_scan_continues_one_from_before_the_loss(void)
{
    rig_go_scanning();
    rig_feed_start_packet(1000);
    (void)rig_drain();
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    rig_feed_point_packet(1000);
    rig_feed_start_packet(1000);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_RECOVERED), rig_drain());
    TEST_ASSERT_EQUAL_UINT32(0, rig_counters().scans);
}

void test_a_turn_cut_by_a_loss_is_no_data_fault(void)
{
    rig_go_scanning();
    (void)rig_plain_turn_events(0);
    (void)rig_plain_turn_events(0); /* One turn without a range, and most of a second one. */
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    rig_feed_point_packet(0);
    rig_feed_start_packet(0);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_RECOVERED), rig_drain());
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(0));
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_plain_turn_events(0));
}

void test_a_range_from_before_a_loss_does_not_clear_a_data_fault(void)
{
    rig_go_scanning();
    rig_plain_turns(3, 0);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_NONE);
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(START);
    rig_feed_point_packet(0);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_RECOVERED), rig_plain_turn_events(1000));
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(1000)); /* The first turn with a range. */
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_plain_turn_events(1000));
}

void test_a_turn_from_before_a_stop_is_not_trusted_after_the_next_start(void)
{
    tmini_ct_info_t turn;

    rig_go_scanning();
    rig_feed_turn(TMINI_FAULT_LD, 1000);
    (void)rig_drain();
    rig_go_idle();
    begins_with(START, tmini_start(&rig.lidar));
    rig_feed_scan_reply();
    /* The stray byte before it is the right LastCRC by chance. */
    rig_feed_turn(TMINI_FAULT_LD, 1000);
    (void)rig_drain();
    tmini_ct_info(&rig.lidar, &turn);
    TEST_ASSERT_EQUAL_HEX16(0, turn.known);
}

void test_faults_outlive_a_loss(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 3; i++) {
        (void)rig_turn_events(TMINI_FAULT_PD);
    }
    passes_to(1000, TMINI_EVENT_LOST);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_PD, tmini_faults(&rig.lidar));
}

void test_stop_ends_the_recovery(void)
{
    rig_go_backing_off();
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes_to(50, TMINI_EVENT_STOPPED);
    passes(60000);
    is_in(TMINI_STATE_IDLE);
}

/* ---- Without recovery ---- */

static void go_lost_without_recovery(void)
{
    rig.config.recovery = TMINI_RECOVERY_OFF;
    rig_init();
    rig_go_scanning();
    passes_to(1000, TMINI_EVENT_LOST);
}

void test_without_recovery_a_loss_is_reported_and_nothing_sent(void)
{
    go_lost_without_recovery();
    is_in(TMINI_STATE_RECOVERING);
    passes(1000000);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().losses);
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().restarts);
}

void test_without_recovery_a_lidar_that_comes_back_by_itself_has_recovered(void)
{
    go_lost_without_recovery();
    passes(60000);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_RECOVERED);
    is_in(TMINI_STATE_SCANNING);
}

void test_without_recovery_the_user_stops_and_starts(void)
{
    go_lost_without_recovery();
    begins_with(STOP, tmini_stop(&rig.lidar));
    passes_to(50, TMINI_EVENT_STOPPED);
    begins_with(START, tmini_start(&rig.lidar));
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
}

void test_without_recovery_a_start_after_a_loss_starts(void)
{
    go_lost_without_recovery();
    begins_with(STOP, tmini_start(&rig.lidar));
    is_in(TMINI_STATE_STARTING);
    begins(tmini_start(&rig.lidar)); /* Already starting: nothing more is sent. */
    finds_quiet_and_sends(START);
    rig_feed_point_packet(1000);
    polls_to(TMINI_EVENT_STARTED);
    is_in(TMINI_STATE_SCANNING);
}

void test_without_recovery_a_start_after_a_loss_may_fail_and_be_made_again(void)
{
    rig.timing.max_attempts = 1;
    go_lost_without_recovery();
    begins_with(STOP, tmini_start(&rig.lidar));
    finds_quiet_and_sends(START);
    passes_to(2000, TMINI_EVENT_COMMAND_FAILED);
    is_in(TMINI_STATE_UNKNOWN);
    begins_with(STOP, tmini_start(&rig.lidar));
    is_in(TMINI_STATE_STARTING);
}

/* ---- A clock that is set back ---- */

/* The current timeout begins again: it ends neither at once nor much later. Up to 10 ms may have
 * passed since the line was examined. */
void test_a_clock_that_is_set_back_delays_a_time_out_by_its_own_length(void)
{
    static const uint32_t back_ms[] = {1010, 3600000, 0x7FFFFFFF};

    for (unsigned i = 0; i < 3; i++) {
        rig_open();
        rig_go_scanning();
        passes_to(600, TMINI_EVENT_NONE);
        rig.now_ms -= back_ms[i];
        passes_to(1000, TMINI_EVENT_LOST);
    }
}

/* The clock is set to one millisecond before the command was sent. */
void test_a_clock_that_is_set_back_by_the_time_passed_fails_no_command(void)
{
    rig_go_starting();
    passes_to(1500, TMINI_EVENT_NONE);
    rig.now_ms -= 1501;
    passes_to(2000, TMINI_EVENT_COMMAND_FAILED);
}

void test_a_clock_that_is_set_back_ends_no_pause_of_the_ladder(void)
{
    rig_go_backing_off();
    rig.now_ms -= 2000;
    pauses_and_stops(500);
}

/* ---- Another unit ---- */

void test_what_the_unit_reported_of_itself_is_not_known_after_a_loss(void)
{
    tmini_ct_info_t turn;

    rig_go_scanning();
    for (unsigned i = 0; i < 3; i++) {
        (void)rig_turn_events(0);
    }
    tmini_ct_info(&rig.lidar, &turn);
    TEST_ASSERT_EQUAL_UINT8(1, turn.user_major);
    passes_to(1000, TMINI_EVENT_LOST);
    tmini_ct_info(&rig.lidar, &turn);
    TEST_ASSERT_EQUAL_HEX16(0, turn.known);
    TEST_ASSERT_EQUAL_UINT8(0, turn.user_major);
}
