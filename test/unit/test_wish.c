/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Wishes: what the driver does for them, in which order, and what the program hears (tale.h); and
 * what the configuration may wish. */

#include "tale.h"

#include "mock_port_functions.h"
#include "tmini_driver.h"

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    tale_end();
}

#define IDLE "stop >65 +50 !STOPPED @IDLE "
#define SCANS IDLE "start >0D <600 >60 <scan <S !STARTED @SCANNING "
#define SCANS_AT_10 "wish:1000 " IDLE "start >0D <1000 !FREQUENCY >60 <scan <S !STARTED @SCANNING "

/* ---- Start ---- */

void test_a_start_stops_asks_and_starts(void)
{
    tell("start @STARTING >65 +50 >0D <600 >60 <scan +100 <P !STARTED @SCANNING #600");
}

void test_a_lidar_that_boots_is_asked_until_it_answers_and_started_once(void)
{
    tell("start >65 +50 >0D +250 >0D +250 >0D <600 >60 <scan <S !STARTED");
}

void test_the_frequency_is_set_before_the_start(void)
{
    tell("wish:700 start >65 +50 >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY >60 <scan <P "
         "!STARTED #700");
}

void test_without_a_wish_a_start_reports_no_frequency(void)
{
    tell(IDLE "start >0D <600 >60 <scan <S !STARTED #600");
}

void test_a_question_about_the_frequency_is_answered_by_the_start(void)
{
    tell(IDLE "frequency >0D start @STARTING <600 !FREQUENCY >60 <scan <S !STARTED");
}

void test_a_packet_starts_even_if_the_reply_was_lost(void)
{
    tell(IDLE "start >0D <600 >60 <P !STARTED");
}

void test_a_start_while_it_starts_or_scans_changes_nothing(void)
{
    tell(IDLE "start >0D start <600 >60 start <scan <S !STARTED start @SCANNING");
}

void test_a_frequency_that_cannot_be_set_is_reported_when_it_scans(void)
{
    tell("wish:700 " IDLE "start >0D <99 >65 +50 >60 <scan <S !STARTED !FAILED ?REPLY @SCANNING");
}

void test_a_lidar_that_has_never_answered_is_started_even_so(void)
{
    tell(IDLE "start");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on(">65 +50 >60 <P !STARTED #0");
}

void test_a_lidar_that_has_answered_before_is_asked_on(void)
{
    tell(IDLE "info >90 <info !INFO start");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on("!FAILED ?TIMEOUT @STARTING >65 +50 >0D <600 >60 <scan <S !STARTED");
}

void test_each_failed_attempt_is_reported_and_the_next_comes_after_a_pause(void)
{
    tell(IDLE "start >0D <600 >60 +2000 !FAILED ?TIMEOUT @STARTING +500 >65 +50 >0D <600 >60 +2000 "
              "!FAILED +1000 >65 +50 >0D <600 >60 +2000 !FAILED +2000 >65 +50 >0D <600 >40 "
              "+1000 >0D <600 >0D <600 >60 <scan <S !STARTED");
}

void test_without_recovery_a_start_has_three_attempts_and_then_fails(void)
{
    tell("off " IDLE "start >0D <600 >60 +2000 >65 +50 >60 +2000 >65 +50 >60 +2000 !FAILED "
         "?TIMEOUT @UNKNOWN");
}

void test_without_a_pause_configured_there_is_no_second_attempt(void)
{
    tell("backoff:0 " IDLE "start >0D <600 >60 +2000 !FAILED +60000 @STARTING stop >65 !FAILED "
         "?ABORTED +50 !STOPPED");
}

void test_without_a_pause_configured_a_lidar_that_does_not_answer_is_not_asked_again(void)
{
    tell("backoff:0 " IDLE "start");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on(">65 +50 >60 +2000 !FAILED +60000");
}

void test_a_port_that_always_fails_is_reported_at_growing_intervals(void)
{
    tell("start >65 takes:-1 +50 !FAILED ?WRITE +500 !NONE !FAILED +1000 !NONE !FAILED +2000 !NONE "
         "!FAILED");
}

void test_a_port_that_fails_after_the_lidar_was_asked_in_vain_is_no_endless_loop(void)
{
    tell(IDLE "start");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on("takes:-1 !FAILED ?WRITE");
    for (unsigned polls = 0; polls < 100; polls++) {
        (void)tmini_poll(&rig.lidar);
    }
    go_on("!NONE");
}

void test_a_lidar_that_has_never_answered_gets_no_reboot(void)
{
    tell("start >65 takes:-1 +50 !FAILED +500 !NONE !FAILED +1000 !NONE !FAILED takes:2 +2000 >65 "
         "+50");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on(">65 +50 >60 <S !STARTED");
}

void test_a_listener_needs_no_write_function(void)
{
    rig.port.write = NULL;
    rig.config.listen_only = true;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&rig.lidar, &rig.config));
}

void test_a_question_about_the_frequency_that_the_start_cannot_answer_fails(void)
{
    tell(IDLE "frequency >0D start +250");
    for (unsigned asks = 0; asks < 28; asks++) {
        go_on(">0D +250");
    }
    go_on(">0D +250 !FAILED ?TIMEOUT >65 +50 >60 <S !STARTED");
}

void test_a_frequency_that_nobody_tried_to_set_is_no_failure(void)
{
    tell("off " SCANS_AT_10 "turns:3:100 +1000 !LOST <S !RECOVERED turns:3:100");
}

void test_an_implausible_answer_leaves_the_frequency_unknown(void)
{
    tell(SCANS_AT_10
         "stop >65 +50 !STOPPED start >0D <0 >65 +50 >60 <S !STARTED !FAILED ?REPLY #0");
}

/* ---- Stop ---- */

void test_a_stop_ends_a_start_which_is_reported(void)
{
    tell(IDLE "start >0D stop >65 !FAILED ?ABORTED @STOPPING +50 !STOPPED @IDLE");
}

void test_a_stop_ends_a_scan(void)
{
    tell(SCANS "stop >65 @STOPPING <P +50 !STOPPED @IDLE");
}

void test_a_stop_ends_a_question_and_those_that_wait(void)
{
    tell(IDLE "info >90 health stop >65 !FAILED ?ABORTED +50 !STOPPED @IDLE");
}

void test_a_stop_during_a_stop_takes_back_what_was_to_follow(void)
{
    tell("stop >65 start @STARTING stop @STOPPING !FAILED ?ABORTED +50 !STOPPED @IDLE");
}

void test_a_stop_during_a_stop_changes_nothing(void)
{
    tell("stop >65 +20 stop +30 !STOPPED");
}

void test_a_start_that_has_not_been_polled_is_not_reported_after_a_stop(void)
{
    tell(IDLE "start >0D <600 >60 <scan <S <S !STARTED stop >65 +50 !STOPPED");
}

void test_a_start_follows_a_stop(void)
{
    tell(SCANS "stop >65 start @STARTING +50 !STOPPED >0D <600 >60 <scan <S !STARTED");
}

void test_stop_set_start_sets_before_it_starts(void)
{
    tell(SCANS "stop >65 set:700 start +50 !STOPPED >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY "
               ">60 <scan <S !STARTED #700");
}

/* ---- Questions ---- */

void test_questions_are_answered_one_after_the_other(void)
{
    tell("info health frequency >65 +50 >90 <info !INFO >92 <health !HEALTH >0D <600 !FREQUENCY "
         "@IDLE");
}

void test_a_question_that_fails_does_not_end_the_others(void)
{
    tell("attempts:1 info health >65 +50 >90 +2000 !FAILED @BUSY >65 +50 >92 <health !HEALTH");
}

void test_questions_come_before_the_start(void)
{
    tell("info start @STARTING >65 +50 >90 <info !INFO >0D <600 >60 <scan <S !STARTED");
}

void test_a_reboot_comes_before_the_start_and_is_reported(void)
{
    tell(IDLE "reboot >40 start +1000 >0D <600 !REBOOTED >0D <600 >60 <scan <S !STARTED");
    TEST_ASSERT_EQUAL_UINT16(0, rig_counters().reboots);
}

void test_a_question_that_waits_outlives_an_attempt_that_fails(void)
{
    for (unsigned i = 0; i < 2; i++) {
        tell(i == 0 ? IDLE "info >90 <info !INFO frequency >0D health start"
                    : "off " IDLE "info >90 <info !INFO frequency >0D health start");
        for (unsigned asks = 0; asks < 29; asks++) {
            go_on("+250 >0D");
        }
        go_on("+250 !FAILED ?TIMEOUT >65 +50 >92 <health !HEALTH");
        go_on(i == 0 ? ">0D" : "@IDLE");
    }
}

void test_the_same_question_twice_is_one(void)
{
    tell(IDLE "info >90 info <info !INFO @IDLE");
}

void test_an_answer_that_has_not_been_polled_is_not_taken_for_the_next_one(void)
{
    tell(IDLE "info >90 +2000 >65 +50 >90 +2000 >65 +50 >90 ~2000 <info !INFO");
}

void test_a_lidar_that_is_to_scan_refuses_questions(void)
{
    tell(IDLE "start >0D info=STATE reboot=STATE <600 >60 health=STATE <scan <S !STARTED "
              "info=STATE frequency=STATE +1000 !LOST >65 info=STATE");
}

void test_a_stopping_lidar_answers_afterwards(void)
{
    tell(SCANS "stop >65 info @STOPPING +50 !STOPPED >90 <info !INFO @IDLE");
}

/* ---- Frequency ---- */

void test_an_idle_lidar_is_set_at_once(void)
{
    tell(IDLE "set:700 >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY @IDLE");
}

void test_a_frequency_is_rounded_to_the_nearest_tenth(void)
{
    tell(IDLE "set:604 >0D <600 !FREQUENCY set:605 >0D <600 +50 >09 <610 +50 >0D <610 !FREQUENCY");
}

void test_only_what_is_out_of_range_is_refused(void)
{
    tell(IDLE "set:599=ARGUMENT set:1201=ARGUMENT set:0=ARGUMENT");
}

void test_the_same_wish_for_an_idle_lidar_asks_again(void)
{
    tell("wish:700 " IDLE "set:700 >0D <700 !FREQUENCY set:700 >0D <700 !FREQUENCY");
}

void test_the_same_wish_during_a_command_asks_after_it(void)
{
    tell("wish:700 " IDLE "info >90 set:700 <info !INFO >0D <700 !FREQUENCY @IDLE");
}

void test_a_wish_during_a_command_is_carried_out_after_it(void)
{
    tell(IDLE "info >90 set:700 <info !INFO >0D <700 !FREQUENCY @IDLE");
}

void test_a_wish_that_is_still_for_four_turns_pauses_the_scans(void)
{
    tell(SCANS_AT_10
         "turns:5:100 set:900 turns:3:100 <turn:100 !SCAN !PAUSED @STARTING >65 +50 >0D "
         "<1000 +50 >0C <900 +50 >0D <900 !FREQUENCY >60 <scan <S !STARTED #900");
}

void test_a_slider_does_not_stop_the_scans_before_it_rests(void)
{
    tell(SCANS_AT_10 "turns:5:100");
    for (unsigned i = 0; i < 20; i++) {
        go_on(i % 2 == 0 ? "set:900 turns:3:100" : "set:800 turns:3:100");
    }
    go_on("<turn:100 !SCAN !PAUSED >65 +50 >0D");
    go_on("<800 !FREQUENCY >60 <scan <S !STARTED turns:9:80");
}

void test_a_wish_that_is_taken_back_pauses_nothing(void)
{
    tell(SCANS_AT_10 "turns:5:100 set:900 turns:2:100 set:1000 turns:9:100");
}

void test_the_same_wish_disturbs_no_scan(void)
{
    tell(SCANS_AT_10 "turns:3:100 set:1000 turns:9:100");
}

void test_a_wish_during_a_start_is_carried_out_by_it_or_while_it_scans(void)
{
    tell(IDLE "start >0D set:700 <600 +50 >0B <700 +50 >0D <700 !FREQUENCY >60 set:800 <scan <S "
              "!STARTED turns:2:70 <turn:70 !SCAN !PAUSED >65 +50 >0D <700 +50 >0B <800 +50 >0D "
              "<800 !FREQUENCY >60 <scan <S !STARTED");
}

void test_a_wish_while_recovering_ends_with_recovered(void)
{
    tell(SCANS_AT_10 "+1000 !LOST >65 set:900 +50 >0D <1000 +50 >0C <900 +50 >0D <900 !FREQUENCY "
                     ">60 <scan <S !RECOVERED #900");
}

/* ---- The frequency while it scans ---- */

void test_three_seconds_of_another_frequency_are_a_fault_and_another_try(void)
{
    tell(SCANS_AT_10 "turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 #0 +50 >0D <600 +50 >0B <700 "
                     "stop >65 !FAILED +50 !STOPPED");
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_five_percent_off_is_no_fault_and_more_is(void)
{
    tell(SCANS_AT_10 "turns:60:95");
    tell(SCANS_AT_10 "turns:60:105");
    tell("off " SCANS_AT_10 "turns:26:94 <turn:94 !SCAN");
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    go_on("<turn:94 !FAULTS !SCAN");
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

void test_two_slow_turns_are_no_fault_and_three_are(void)
{
    tell("off " SCANS_AT_10 "turns:1:6 <turn:6 !FAULTS !SCAN");
}

void test_a_right_turn_ends_the_fault(void)
{
    tell("off " SCANS_AT_10 "turns:16:60 <turn:60 !FAULTS !SCAN <turn:100 !FAULTS !SCAN");
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_without_recovery_another_frequency_is_only_a_fault(void)
{
    tell("off " SCANS_AT_10 "turns:16:60 <turn:60 !FAULTS !SCAN turns:300:60");
}

void test_a_frequency_that_the_lidar_has_and_does_not_keep_is_set_once_more_only(void)
{
    tell(SCANS_AT_10 "turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 +50 >0D <1000 !FREQUENCY >60 "
                     "<scan <S !STARTED turns:300:60");
}

/* 3 s, then 6, 12, 24 and 42.5 (255 turns). */
void test_a_lidar_that_does_not_answer_is_tried_less_and_less_often(void)
{
    static const char *const turns[] = {"turns:16:60",  "turns:34:60",  "turns:70:60",
                                        "turns:142:60", "turns:253:60", "turns:253:60"};
    tell("wish:1000 " IDLE "start >0D <99 >65 +50 >60 <scan <S !STARTED !FAILED");
    for (unsigned i = 0; i < 6; i++) {
        go_on(turns[i]);
        go_on(i == 0 ? "<turn:60 !FAULTS !SCAN !PAUSED" : "<turn:60 !SCAN !PAUSED");
        go_on(">65 +50 >0D <99 >65 +50 >60 <scan <S !STARTED !FAILED");
    }
}

void test_what_is_not_known_to_be_set_is_asked_again_although_it_turns_well(void)
{
    tell("wish:610 attempts:1 " IDLE "start >0D <600 +50 >09");
    for (unsigned steps = 0; steps < 3; steps++) {
        go_on("+2000 >0D <600 +50 >09");
    }
    go_on("+2000 >65 +50 >60 <scan <S !STARTED !FAILED #0");
    go_on("turns:16:60 <turn:60 !SCAN !PAUSED >65 +50 >0D <610 !FREQUENCY >60 <scan <S !STARTED");
}

void test_a_unit_that_never_answers_is_asked_again_once(void)
{
    tell("wish:1000 " IDLE "start");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on(">65 +50 >60 <S !STARTED !FAILED ?TIMEOUT turns:28:100 <turn:100 !SCAN !PAUSED >65 +50");
    for (unsigned asks = 0; asks < 30; asks++) {
        go_on(">0D +250");
    }
    go_on(">65 +50 >60 <S !STARTED !FAILED turns:300:100");
}

void test_a_frequency_that_is_not_reported_is_no_fault(void)
{
    tell(SCANS_AT_10 "turns:60:0");
}

void test_without_a_wish_any_frequency_is_right(void)
{
    tell(SCANS "turns:60:90");
}

void test_another_wish_clears_the_fault(void)
{
    tell("off " SCANS_AT_10 "turns:16:60 <turn:60 !FAULTS !SCAN set:600 !FAULTS");
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_the_same_wish_does_not_clear_it(void)
{
    tell("off " SCANS_AT_10 "turns:16:60 <turn:60 !FAULTS !SCAN set:1000");
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_FREQUENCY, tmini_faults(&rig.lidar));
}

/* ---- Listening ---- */

void test_a_listener_scans_from_the_first_packet(void)
{
    tell("listen start @STARTING +2999 <P !STARTED @SCANNING");
}

void test_a_listener_that_hears_nothing_reports_it_at_growing_intervals(void)
{
    tell("listen start +3000 !FAILED ?TIMEOUT +500 !FAILED +1000 !FAILED +2000 !FAILED +2000 "
         "!FAILED <P !STARTED");
}

void test_without_recovery_a_listener_that_hears_nothing_gives_up(void)
{
    tell("listen off start +3000 !FAILED ?TIMEOUT @UNKNOWN");
}

void test_a_listener_that_hears_nothing_for_a_second_has_lost_its_lidar(void)
{
    tell("listen start <S !STARTED +1000 !LOST @RECOVERING +60000 <P !NONE <S !RECOVERED");
}

void test_a_listener_stops_at_once(void)
{
    tell("listen start <P !STARTED stop !STOPPED @UNKNOWN <P <S");
    tell("listen start stop !STOPPED !FAILED ?ABORTED");
}

void test_a_listener_sends_nothing(void)
{
    tell("listen info=LISTEN_ONLY health=LISTEN_ONLY frequency=LISTEN_ONLY reboot=LISTEN_ONLY "
         "set:700=LISTEN_ONLY");
}

/* ---- What a call does in each state ---- */

void test_a_lidar_that_was_not_set_up_refuses_every_call(void)
{
    static tmini_t nothing;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_start(&nothing));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_stop(&nothing));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_request_info(&nothing));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_set_frequency(&nothing, 700));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_reboot(NULL));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX / 2, tmini_scan_age_ms(&nothing));
    TEST_ASSERT_EQUAL_UINT32(0, tmini_next_poll_ms(&nothing));
}

/* ---- The configuration ---- */

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

void test_a_wanted_frequency_is_6_to_12_hz(void)
{
    static const uint16_t wrong[] = {1, 590, 599, 1201, 1210};
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

void test_what_contradicts_itself_is_refused(void)
{
    rig.config.recovery = (tmini_recovery_mode_t)7;
    is_refused();
    rig.config.recovery = TMINI_RECOVERY_ON;
    rig.config.points = NULL;
    rig.config.max_points = 0;
    rig.config.filter = TMINI_FILTER_BOTH;
    is_refused();
    rig.config.filter = 0x80;
    is_refused();
    rig.timing.quiet_line_ms = 600;
    rig.config.filter = 0;
    is_refused();
}

void test_a_lidar_that_was_refused_stores_nothing(void)
{
    rig.config.frequency_chz = 1;
    is_refused();
    tmini_feed_byte(&rig.lidar, 1);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed(&rig.lidar, (const uint8_t *)"12", 2));
}

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
