/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar that is lost: how it is noticed, the ladder of attempts, and how it comes back
 * (tale.h). */

#include "tale.h"

#include "invariants.h"
#include "mock_port_functions.h"
#include "tmini_driver.h"

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    tale_end();
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

#define IDLE "stop >65 +50 !STOPPED @IDLE "
#define SCANS IDLE "start >0D <600 >60 <scan <S !STARTED @SCANNING "
#define LOST SCANS "turns:2:60 +1000 !LOST @RECOVERING "

/* ---- How a loss is noticed ---- */

void test_a_second_without_a_packet_is_a_loss(void)
{
    tell(SCANS "+1000 !LOST @RECOVERING #0 >65");
}

void test_each_packet_puts_the_loss_off(void)
{
    tell(SCANS "+999 <P +1000 !LOST >65");
}

void test_bytes_without_valid_packets_are_a_loss_too(void)
{
    tell(SCANS "~500 <junk !NONE ~499 <junk !NONE ~1 !LOST >65");
}

void test_a_poll_less_than_50_ms_after_another_reports_the_loss(void)
{
    tell(SCANS "~962 !NONE ~48 !LOST >65");
}

void test_a_task_that_slept_until_the_loss_reports_it(void)
{
    tell(SCANS "~1009 !LOST >65");
}

void test_a_poll_after_a_pause_of_the_program_gives_the_lidar_another_100_ms(void)
{
    tell(SCANS "~951 !NONE ~59 !NONE @SCANNING +100 !LOST >65");
}

void test_late_polls_give_three_chances(void)
{
    tell(SCANS "~5000 !NONE ~500 !NONE ~500 !NONE ~500 !LOST >65");
}

void test_a_packet_after_a_late_poll_averts_the_loss(void)
{
    tell(SCANS "~5000 !NONE ~99 <P +999");
}

/* ---- The ladder ---- */

void test_a_lost_lidar_is_stopped_asked_and_started(void)
{
    tell(LOST ">65 +50 >0D <600 >60 <scan <S !RECOVERED @SCANNING");
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().losses);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().recoveries);
    TEST_ASSERT_EQUAL_UINT16(1, rig_counters().restarts);
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().reboots);
}

/* Pauses of 0.5, 1, 2 and 2 s; a reboot before the fourth attempt and each later one. */
#define FAILS "<600 >60 +2000 !NONE "
#define FAILS_WITH_REBOOT "<600 >40 +1000 >0D <600 >0D <600 >60 +2000 !NONE "
void test_a_lidar_that_answers_and_does_not_scan_is_rebooted_after_three_attempts(void)
{
    tell(LOST ">65 +50 >0D " FAILS "+500 >65 +50 >0D " FAILS "+1000 >65 +50 >0D " FAILS
              "+2000 >65 +50 >0D " FAILS_WITH_REBOOT "+2000 >65 +50 >0D " FAILS_WITH_REBOOT
              "+2000 >65 +50 >0D " FAILS_WITH_REBOOT "+2000 >65");
    TEST_ASSERT_EQUAL_UINT16(3, rig_counters().reboots);
    TEST_ASSERT_EQUAL_UINT16(6, rig_counters().restarts);
}

void test_a_lidar_without_power_is_asked_without_a_pause_and_gets_no_reboot(void)
{
    tell(LOST ">65 +50");
    for (unsigned round = 0; round < 6; round++) {
        for (unsigned asks = 0; asks < 30; asks++) {
            go_on(">0D +250");
        }
        go_on(">65 +50");
    }
    go_on(">0D <600 >60 <scan <S !RECOVERED");
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().reboots);
}

void test_a_line_that_does_not_fall_quiet_is_a_failed_attempt(void)
{
    tell(LOST ">65");
    for (unsigned attempt = 0; attempt < 2; attempt++) { /* Asking fails, then starting. */
        for (unsigned i = 0; i < 14; i++) {
            go_on("~40 <junk");
        }
        go_on(attempt == 0 ? "~40 >65" : "~40 +500 >65");
    }
}

void test_noise_and_then_silence_cause_no_reboot(void)
{
    static const char *const pauses[] = {"~40 !FAILED +500 >65", "~40 !FAILED +1000 >65",
                                         "~40 !FAILED +2000 >65"};
    tell("start >65");
    for (unsigned i = 0; i < 6; i++) { /* Asking fails, then starting, three times. */
        for (unsigned j = 0; j < 14; j++) {
            go_on("~40 <junk");
        }
        go_on(i % 2 == 0 ? "~40 >65" : pauses[i / 2]);
    }
    go_on("+50");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on(">65 +50 >60");
}

void test_a_loss_before_a_whole_turn_continues_the_ladder(void)
{
    tell(LOST ">65 +50 >0D " FAILS "+500 >65 +50 >0D <600 >60 <scan <S !RECOVERED +1000 !LOST "
              "+1000 >65");
}

void test_a_loss_after_a_whole_turn_begins_it_again(void)
{
    tell(LOST ">65 +50 >0D " FAILS "+500 >65 +50 >0D <600 >60 <scan <S !RECOVERED turns:2:60 +1000 "
              "!LOST >65");
}

void test_the_first_pause_is_no_longer_than_the_longest(void)
{
    tell("backoff:400 " LOST ">65 +50 >0D " FAILS "+400 >65");
}

void test_a_port_that_fails_makes_the_attempt_fail(void)
{
    tell(LOST "takes:-1 !NONE !NONE ~500 takes:2 >65");
}

/* The lidar has heard nothing. */
void test_attempts_that_the_port_fails_cause_no_reboot(void)
{
    tell(LOST "takes:-1 !NONE !NONE ~500 !NONE !NONE ~1000 !NONE !NONE ~2000 !NONE !NONE ~2000 "
              "!NONE !NONE takes:2 ~2000 >65 +50 >0D <600 >60");
}

static unsigned restarts;

static void count_restart(void *context)
{
    TEST_ASSERT_EQUAL_PTR(&rig.port, context);
    restarts++;
}

void test_the_port_restarts_its_reception_at_a_loss_and_after_each_failed_attempt(void)
{
    rig_open();
    restarts = 0;
    tell(SCANS);
    rig.port.restart = count_restart;
    go_on("+1000 !LOST");
    TEST_ASSERT_EQUAL_UINT(1, restarts);
    go_on(">65 +50 >0D <600 >60 +2000 !NONE");
    TEST_ASSERT_EQUAL_UINT(2, restarts);
}

void test_a_stop_ends_the_recovery(void)
{
    tell(LOST ">65 stop >65 +50 !STOPPED @IDLE");
    tell(LOST ">65 +50 >0D " FAILS "+100 stop >65 +50 !STOPPED");
}

/* ---- How it comes back ---- */

void test_point_packets_are_no_recovery_and_a_start_packet_is(void)
{
    tell(LOST ">65 +50 >0D <600 >60 <scan <P @RECOVERING +100 <P !NONE <S !RECOVERED");
}

void test_ranges_without_a_start_packet_for_three_seconds_are_a_failed_attempt(void)
{
    tell(LOST ">65 +50 >0D <600 >60 <P !NONE");
    for (unsigned i = 0; i < 29; i++) {
        go_on("~100 <P !NONE");
    }
    go_on("~100 +500 >65");
}

void test_a_blocked_rotor_has_recovered(void)
{
    tell(LOST ">65 +50 >0D <600 >60 <scan <Z !NONE");
    for (unsigned i = 0; i < 29; i++) {
        go_on("~100 <Z !NONE");
    }
    go_on("~100 !RECOVERED @SCANNING");
}

void test_a_rotor_that_comes_free_gets_time_for_its_start_packet(void)
{
    tell(LOST ">65 +50 >0D <600 >60 <Z ~2900 <P <Z ~2900 <P !NONE <S !RECOVERED");
}

void test_a_lidar_that_comes_back_in_the_pause_has_recovered(void)
{
    tell(LOST ">65 +50 >0D " FAILS "<P @RECOVERING <S !RECOVERED");
}

void test_packets_between_the_stop_and_a_quiet_line_are_no_recovery(void)
{
    tell(LOST ">65 <S <P +50 >0D <600 >60 <S !RECOVERED");
}

void test_a_frequency_that_could_not_be_set_again_is_reported(void)
{
    tell("wish:700 " IDLE "start >0D <700 !FREQUENCY >60 <scan <S !STARTED turns:2:70 +1000 !LOST "
         ">65 +50 >0D <99 >65 +50 >60 <scan <S !FAILED !RECOVERED ?REPLY");
}

/* ---- Without recovery ---- */

void test_without_recovery_a_loss_is_reported_and_nothing_sent(void)
{
    tell("off " LOST "+60000 <P @RECOVERING <S !RECOVERED @SCANNING");
}

void test_without_recovery_a_start_after_a_loss_starts(void)
{
    tell("off " LOST "start @STARTING >65 +50 >0D <600 >60 <scan <S !STARTED");
}

void test_without_recovery_a_new_wish_after_a_loss_waits(void)
{
    tell("off " LOST "set:700 +60000 start >65 +50 >0D <700 !FREQUENCY >60");
}

/* ---- Start packets that stop ---- */

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

/* ---- How old the newest complete scan is ---- */

/* A turn of the rig is not a full circle, so a builder's verdict is put in its place. */
void test_before_the_first_complete_scan_its_age_is_at_its_maximum(void)
{
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(&rig.lidar));
    tell(IDLE "age:2147483647 ~250 !NONE age:2147483647 start >0D <600 >60 <scan <S !STARTED "
              "age:2147483647");
}

void test_the_age_of_a_scan_counts_from_its_end(void)
{
    tell(SCANS);
    rig.lidar.complete_ms = rig.now_ms - 100;
    go_on("age:100 turns:3:60 age:580 ~20 age:600");
}

void test_a_clock_that_is_set_back_a_little_makes_no_scan_younger(void)
{
    tell(IDLE);
    rig.lidar.complete_ms = rig.now_ms - 50;
    go_on("~250 !NONE age:300");
    rig.now_ms -= 200;
    go_on("age:300 !NONE age:300");
}

void test_a_clock_may_begin_at_zero(void)
{
    rig_init();
    for (rig.now_ms = 0; rig.now_ms < 3; rig.now_ms++) {
        polls_to(TMINI_EVENT_NONE);
        TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(&rig.lidar));
    }
}

void test_a_clock_that_wraps_around_to_zero_makes_no_scan_younger(void)
{
    tell(IDLE);
    rig.now_ms = UINT32_MAX - 49;
    go_on("!NONE");
    rig.lidar.complete_ms = rig.now_ms - 500;
    rig.now_ms = 0;
    go_on("!NONE");
    rig.now_ms = 50;
    go_on("!NONE age:600");
}

void test_an_age_of_24_days_remains(void)
{
    tell(IDLE);
    rig.lidar.complete_ms = rig.now_ms;
    for (unsigned i = 0; i < 5; i++) {
        rig.now_ms += UINT32_MAX / 4;
        go_on("!NONE");
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(&rig.lidar));
    rig.now_ms += 1000;
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(&rig.lidar));
}

/* ---- How long a task may sleep ---- */

void test_an_idle_lidar_needs_no_poll(void)
{
    tell(IDLE "!NONE next:65535");
}

void test_a_task_sleeps_until_the_line_is_quiet_in_steps_of_50_ms_at_most(void)
{
    tell("stop >65 !NONE next:50 ~20 next:30 !NONE ~20 !NONE next:10 ~10 next:0 !STOPPED");
    tell("quiet:200 stop >65 !NONE next:50 ~50 !NONE next:50 ~50 !NONE ~50 !NONE ~50 !STOPPED");
    tell("quiet:300 ~50 !NONE ~50 !NONE ~50 !NONE ~50 !NONE ~50 !NONE ~50 !NONE "
         "stop >65 !NONE next:50");
    tell("quiet:20 ~100 !NONE stop >65 !NONE next:20 ~20 next:0 !STOPPED");
    tell("quiet:599 stop >65 !NONE ~300 <junk !NONE ~300 <junk !NONE ~300 <junk !NONE ~240 !NONE "
         "next:9 ~9 >65");
}

void test_a_task_sleeps_until_a_reply_is_overdue(void)
{
    tell(IDLE "info >90 !NONE next:2000 ~500 next:1500 ~1600 next:0 >65");
}

void test_a_task_sleeps_until_a_candidate_is_given_up(void)
{
    tell(SCANS "!NONE next:1000");
    rig_feed_byte(0xAA);
    go_on("~10 !NONE next:50 ~50 !NONE next:50 ~10 !NONE next:40 ~50 next:0");
}

void test_a_candidate_with_no_time_at_all_is_polled_after_a_millisecond(void)
{
    rig_open();
    tell(SCANS);
    rig.timing.frame_timeout_ms = 0;
    rig_feed_byte(0xAA);
    go_on("~10 !NONE next:1");
}

void test_an_event_or_a_byte_that_waits_for_the_port_is_polled_at_once(void)
{
    tell(IDLE "takes:0 info next:1 takes:2 >90 !NONE next:2000 <info !INFO next:0 !NONE info >90");
    go_on("stop >65 next:0 !FAILED +50 !STOPPED");
}

/* ---- What outlives a loss ---- */

void test_after_a_recovery_no_scan_continues_one_from_before_the_loss(void)
{
    rig_go_scanning();
    rig_feed_start_packet(1000);
    (void)rig_drain();
    passes_to(1000, TMINI_EVENT_LOST);
    polls_and_sends(STOP);
    finds_quiet_and_sends(GET_FREQUENCY);
    answers_and_gets(600, START);
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
    finds_quiet_and_sends(GET_FREQUENCY);
    answers_and_gets(600, START);
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
    finds_quiet_and_sends(GET_FREQUENCY);
    answers_and_gets(600, START);
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
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    answers_and_gets(600, START);
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
