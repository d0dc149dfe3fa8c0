/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Wishes: what the driver does for them, in which order, and what the program hears (tale.h); and
 * what the configuration may wish. */

#include "tale.h"

static tmini_point_t spare[RIG_POINTS];

static void step(const void *data, tmini_scan_t *scan)
{
    TEST_ASSERT_EQUAL_PTR(&rig, data);
    for (unsigned i = 0; i < scan->count; i++) {
        scan->points[i].distance_mm++;
    }
}

/* "step": one that makes all distances 1 mm longer is applied to each scan; "step-data": its data
 * alone; "spare": there are spare points; "spare-mm:800": the distance of the first of them. */
static bool tell(char *word)
{
    const row_number_t numbers[] = {{"spare-mm", spare[0].distance_mm}};
    if (row_is(word, "step") || row_is(word, "step-data")) {
        rig.config.step = row_is(word, "step") ? step : NULL;
        rig.config.step_data = &rig;
    } else if (row_is(word, "spare")) {
        rig.config.spare_points = spare;
    } else {
        return row_expects(word, numbers);
    }
    return true;
}

#define WAITS                                                                                   \
    "info >90 <info !INFO frequency >0D health start 29( +250 >0D ) +250 !FAILED ?TIMEOUT >65 " \
    "+50 >92 <health !HEALTH "

static const row_t tales[] IN_FLASH = {
    ROW(a_stop_takes_back_a_failure_that_waits_after_a_start,
        "wish:800 idle start >0D <99 >65 +50 >60 <scan <S !STARTED stop >65 +50 !STOPPED"),
    ROW(a_change_of_frequency_has_pauses_of_its_own, /* Not those of the start before it. */
        "wish:800 idle start >0D <800 !FREQUENCY >60 +2000 !FAILED +500 >65 +50 >0D <800 "
        "!FREQUENCY >60 +2000 !FAILED +1000 >65 +50 >0D <800 !FREQUENCY >60 <scan <S !STARTED "
        "set:700 turns:3:80 <turn:80 !SCAN !PAUSED >65 +50 >0D <700 !FREQUENCY >60 +2000 !FAILED "
        "+500 >65"),
    /* ---- Start ---- */
    ROW(a_start_stops_asks_and_starts,
        "start @STARTING >65 +50 >0D <600 >60 <scan +100 <P !STARTED @SCANNING #600"),
    ROW(a_lidar_that_boots_is_asked_until_it_answers_and_started_once,
        "start >65 +50 >0D +250 >0D +250 >0D <600 >60 <scan <S !STARTED"),
    ROW(the_frequency_is_set_before_the_start, "wish:700 start >65 +50 >0D <600 +50 >0B <700 +50 "
                                               ">0D <700 !FREQUENCY >60 <scan <P !STARTED #700"),
    ROW(without_a_wish_a_start_reports_no_frequency,
        "idle start >0D <600 >60 <scan <S !STARTED #600"),
    ROW(a_question_about_the_frequency_is_answered_by_the_start,
        "idle frequency >0D start @STARTING <600 !FREQUENCY >60 <scan <S !STARTED"),
    ROW(a_packet_starts_even_if_the_reply_was_lost, "idle start >0D <600 >60 <P !STARTED"),
    ROW(a_start_while_it_starts_or_scans_changes_nothing,
        "idle start >0D start <600 >60 start <scan <S !STARTED start @SCANNING"),
    ROW(a_frequency_that_cannot_be_set_is_reported_when_it_scans,
        "wish:700 idle start >0D <99 >65 +50 >60 <scan <S !STARTED !FAILED ?REPLY @SCANNING"),
    ROW(a_lidar_that_has_never_answered_is_started_even_so,
        "idle start 30( >0D +250 ) >65 +50 >60 <P !STARTED #0"),
    ROW(a_lidar_that_has_answered_before_is_asked_on,
        "idle info >90 <info !INFO start 30( >0D +250 ) !FAILED ?TIMEOUT @STARTING >65 +50 >0D "
        "<600 >60 <scan <S !STARTED"),
    ROW(each_failed_attempt_is_reported_and_the_next_comes_after_a_pause,
        "idle start >0D <600 >60 +2000 !FAILED ?TIMEOUT @STARTING +500 >65 +50 >0D <600 >60 +2000 "
        "!FAILED +1000 >65 +50 >0D <600 >60 +2000 !FAILED +2000 >65 +50 >0D <600 >40 +1000 >0D "
        "<600 >0D <600 >60 <scan <S !STARTED"),
    ROW(without_recovery_a_start_has_three_attempts_and_then_fails,
        "off idle start >0D <600 >60 +2000 >65 +50 >60 +2000 >65 +50 >60 +2000 !FAILED ?TIMEOUT "
        "@UNKNOWN"),
    ROW(without_a_pause_configured_there_is_no_second_attempt,
        "backoff:0 idle start >0D <600 >60 +2000 !FAILED +60000 @STARTING stop >65 !FAILED "
        "?ABORTED +50 !STOPPED"),
    ROW(without_a_pause_configured_a_lidar_that_does_not_answer_is_not_asked_again,
        "backoff:0 idle start 30( >0D +250 ) >65 +50 >60 +2000 !FAILED +60000"),
    ROW(a_port_that_always_fails_is_reported_at_growing_intervals,
        "start >65 takes:-1 +50 !FAILED ?WRITE +500 !FAILED !NONE +1000 !FAILED !NONE +2000 "
        "!FAILED"),
    ROW(a_port_that_fails_after_the_lidar_was_asked_in_vain_is_no_endless_loop,
        "idle start 30( >0D +250 ) takes:-1 !FAILED ?WRITE 101( !NONE )"),
    ROW(a_lidar_that_has_never_answered_gets_no_reboot,
        "start >65 takes:-1 +50 !FAILED +500 !FAILED !NONE +1000 !FAILED !NONE takes:2 +2000 >65 "
        "+50 30( >0D +250 ) >65 +50 >60 <S !STARTED"),
    ROW(a_start_that_succeeds_leaves_the_error_of_the_command_that_failed_last,
        "attempts:1 idle info >90 +2000 !FAILED start >65 +50 >0D <600 >60 <scan <S !STARTED "
        "?TIMEOUT"),
    ROW(a_question_about_the_frequency_that_the_start_cannot_answer_fails,
        "idle frequency >0D start +250 28( >0D +250 ) >0D +250 !FAILED ?TIMEOUT >65 +50 >60 <S "
        "!STARTED"),
    ROW(a_frequency_that_nobody_tried_to_set_is_no_failure,
        "off scans-at-10 turns:3:100 +1000 !LOST <S !RECOVERED turns:3:100"),
    ROW(an_implausible_answer_leaves_the_frequency_unknown,
        "scans-at-10 stop >65 +50 !STOPPED start >0D <0 >65 +50 >60 <S !STARTED !FAILED ?REPLY #0"),
    /* ---- Stop ---- */
    ROW(a_stop_ends_a_start_which_is_reported,
        "idle start >0D stop >65 !FAILED ?ABORTED @STOPPING +50 !STOPPED @IDLE"),
    ROW(a_stop_ends_a_scan, "scans stop >65 @STOPPING <P +50 !STOPPED @IDLE"),
    ROW(a_stop_ends_a_question_and_those_that_wait,
        "idle info >90 health stop >65 !FAILED ?ABORTED +50 !STOPPED @IDLE"),
    ROW(a_stop_during_a_stop_takes_back_what_was_to_follow,
        "stop >65 start @STARTING stop @STOPPING !FAILED ?ABORTED +50 !STOPPED @IDLE"),
    ROW(a_stop_during_a_stop_changes_nothing, "stop >65 +20 stop +30 !STOPPED"),
    ROW(a_packet_that_waits_when_the_lidar_is_stopped_brings_no_scan,
        "idle start >0D <600 >60 <scan <S <S !STARTED stop >65 +50 !STOPPED"),
    ROW(a_question_after_a_stop_leaves_the_report_of_what_the_stop_ended,
        "idle start >0D stop >65 info !FAILED ?ABORTED +50 !STOPPED >90 <info !INFO"),
    ROW(a_start_follows_a_stop,
        "scans stop >65 start @STARTING +50 !STOPPED >0D <600 >60 <scan <S !STARTED"),
    ROW(stop_set_start_sets_before_it_starts,
        "scans stop >65 set:700 start +50 !STOPPED >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY "
        ">60 <scan <S !STARTED #700"),
    /* ---- Questions ---- */
    ROW(questions_are_answered_one_after_the_other,
        "info health frequency >65 +50 >90 <info !INFO >92 <health !HEALTH >0D <600 !FREQUENCY "
        "@IDLE"),
    ROW(a_question_that_fails_does_not_end_the_others,
        "attempts:1 info health >65 +50 >90 +2000 !FAILED @BUSY >65 +50 >92 <health !HEALTH"),
    ROW(questions_come_before_the_start,
        "info start @STARTING >65 +50 >90 <info !INFO >0D <600 >60 <scan <S !STARTED"),
    ROW(a_reboot_comes_before_the_start_and_is_reported,
        "idle reboot >40 start +1000 >0D <600 !REBOOTED >0D <600 >60 <scan <S !STARTED reboots:0"),
    ROW(a_question_that_waits_outlives_an_attempt_that_fails,
        "idle " WAITS ">0D / off idle " WAITS "@IDLE"),
    ROW(the_same_question_twice_is_one, "idle info >90 info <info !INFO @IDLE"),
    ROW(an_answer_that_has_not_been_polled_is_not_taken_for_the_next_one,
        "idle info >90 +2000 >65 +50 >90 +2000 >65 +50 >90 ~2000 <info !INFO"),
    ROW(a_lidar_that_is_to_scan_refuses_questions,
        "idle start >0D info=STATE reboot=STATE <600 >60 health=STATE <scan <S !STARTED info=STATE "
        "frequency=STATE +1000 !LOST >65 info=STATE"),
    ROW(a_stopping_lidar_answers_afterwards,
        "scans stop >65 info @STOPPING +50 !STOPPED >90 <info !INFO @IDLE"),
    /* ---- Frequency ---- */
    ROW(an_idle_lidar_is_set_at_once,
        "idle set:700 >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY @IDLE"),
    ROW(a_frequency_is_rounded_to_the_nearest_tenth,
        "idle set:604 >0D <600 !FREQUENCY set:605 >0D <600 +50 >09 <610 +50 >0D <610 !FREQUENCY"),
    ROW(only_what_is_out_of_range_is_refused,
        "idle set:599=ARGUMENT set:1201=ARGUMENT set:0=ARGUMENT"),
    ROW(the_same_wish_for_an_idle_lidar_asks_again,
        "wish:700 idle set:700 >0D <700 !FREQUENCY set:700 >0D <700 !FREQUENCY"),
    ROW(the_same_wish_during_a_command_asks_after_it,
        "wish:700 idle info >90 set:700 <info !INFO >0D <700 !FREQUENCY @IDLE"),
    ROW(a_wish_during_a_command_is_carried_out_after_it,
        "idle info >90 set:700 <info !INFO >0D <700 !FREQUENCY @IDLE"),
    ROW(a_wish_that_is_still_for_four_turns_pauses_the_scans,
        "scans-at-10 turns:5:100 set:900 turns:3:100 <turn:100 !SCAN !PAUSED @STARTING >65 +50 >0D "
        "<1000 +50 >0C <900 +50 >0D <900 !FREQUENCY >60 <scan <S !STARTED #900"),
    ROW(a_slider_does_not_stop_the_scans_before_it_rests,
        "scans-at-10 turns:5:100 10( set:900 turns:3:100 set:800 turns:3:100 ) <turn:100 !SCAN "
        "!PAUSED >65 +50 >0D <800 !FREQUENCY >60 <scan <S !STARTED turns:9:80"),
    ROW(a_slider_that_never_rests_holds_a_start_up_for_64_steps_and_its_last_wish_is_reached,
        "wish:800 idle start >0D <600 +50 32( >0B <700 set:600 +50 >0C <600 set:800 +50 ) >65 "
        "+50 >60 <scan <S !STARTED !FAILED ?REPLY turns:2:60 <turn:60 !SCAN !PAUSED >65 +50 >0D "
        "<600 +50 >0B <700 +50 >0B <800 +50 >0D <800 !FREQUENCY >60 <scan <S !STARTED turns:9:80"),
    ROW(the_steps_of_a_lidar_that_is_not_to_scan_are_counted_for_each_wish,
        "idle set:700 >0D <600 +50 >0B <650 set:800 +50 31( >0B <700 +50 >0B <600 +50 ) >0B <800 "
        "+50 >0D <800 !FREQUENCY"),
    ROW(a_wish_that_is_taken_back_pauses_nothing,
        "scans-at-10 turns:5:100 set:900 turns:2:100 set:1000 turns:9:100"),
    ROW(the_same_wish_disturbs_no_scan, "scans-at-10 turns:3:100 set:1000 turns:9:100"),
    ROW(a_wish_during_a_start_is_carried_out_by_it_or_while_it_scans,
        "idle start >0D set:700 <600 +50 >0B <700 +50 >0D <700 !FREQUENCY >60 set:800 <scan <S "
        "!STARTED turns:2:70 <turn:70 !SCAN !PAUSED >65 +50 >0D <700 +50 >0B <800 +50 >0D <800 "
        "!FREQUENCY >60 <scan <S !STARTED"),
    ROW(a_wish_while_recovering_ends_with_recovered,
        "scans-at-10 +1000 !LOST >65 set:900 +50 >0D <1000 +50 >0C <900 +50 >0D <900 !FREQUENCY "
        ">60 <scan <S !RECOVERED #900"),
    /* ---- Listening ---- */
    ROW(a_listener_scans_from_the_first_packet,
        "listen start @STARTING +2999 <P !STARTED @SCANNING"),
    ROW(a_listener_that_hears_nothing_reports_it_at_growing_intervals,
        "listen start +3000 !FAILED ?TIMEOUT +500 !FAILED +1000 !FAILED +2000 !FAILED +2000 "
        "!FAILED <P !STARTED"),
    ROW(without_recovery_a_listener_that_hears_nothing_gives_up,
        "listen off start +3000 !FAILED ?TIMEOUT @UNKNOWN"),
    ROW(a_listener_that_hears_nothing_for_a_second_has_lost_its_lidar,
        "listen start <S !STARTED +1000 !LOST @RECOVERING +60000 <P !NONE <S !RECOVERED"),
    ROW(the_stop_of_a_listener_is_told_by_the_next_poll, "listen !NONE stop !STOPPED"),
    ROW(a_listener_stops_at_once,
        "listen start <P !STARTED stop !STOPPED @UNKNOWN <P <S +500 <P !NONE / listen "
        "start stop !STOPPED !FAILED ?ABORTED"),
    ROW(a_listener_sends_nothing, "listen info=LISTEN_ONLY health=LISTEN_ONLY "
                                  "frequency=LISTEN_ONLY reboot=LISTEN_ONLY set:700=LISTEN_ONLY"),
    /* ---- The configuration ---- */
    ROW(no_port_is_refused, "no-port refused"),
    ROW(a_port_without_write_is_refused, "no-write refused"),
    ROW(a_listener_needs_no_write, "no-write listen !NONE"),
    ROW(a_port_without_a_clock_is_refused, "no-clock refused"),
    ROW(no_receive_buffer_is_refused, "no-rx refused"),
    ROW(a_receive_buffer_that_is_no_power_of_two_is_refused, "rx:255 refused"),
    ROW(a_receive_buffer_holds_the_largest_packet, /* 80 samples are 250 bytes, 39 are 127. */
        "rx:128 refused / rx:128 samples:39 !NONE"),
    ROW(with_dma_half_the_buffer_holds_the_largest_packet, "dma refused / dma samples:39 !NONE"),
    ROW(points_without_room_and_room_without_points_are_refused,
        "points:0 refused / no-points refused / packets !NONE"),
    ROW(a_stop_has_time_for_a_quiet_line, "quiet:599 !NONE / quiet:600 refused"),
    ROW(an_unknown_filter_and_one_without_points_are_refused,
        "filter:1 refused / packets filter:0x80 refused / packets filter:12 refused"),
    ROW(an_unknown_recovery_is_refused, "recovery:7 refused"),
    ROW(a_wanted_frequency_is_6_to_12_hz,
        "wish:1 refused / wish:590 refused / wish:599 refused / wish:1201 refused / wish:1210 "
        "refused / wish:600 !NONE / wish:1200 !NONE"),
    ROW(a_listener_sets_no_frequency, "listen wish:600 refused"),
    ROW(steps_and_spare_points_need_points_and_data_needs_a_step,
        "step !NONE / step-data refused / step packets refused / spare packets refused"),
    ROW(a_step_changes_each_scan_once_before_it_is_delivered,
        "step starts <scan <P !STARTED <small:700 <small:800 !SCAN first-mm:701 second-mm:1001 "
        "<small:900 !SCAN first-mm:801"),
    ROW(with_spare_points_a_scan_stays_until_the_next, /* The third is stored over the first. */
        "spare starts <scan <P !STARTED <small:700 <small:800 !SCAN count:9 first-mm:700 !NONE "
        "first-mm:700 spare-mm:800 <small:900 !SCAN count:9 spare-mm:800 first-mm:700 !NONE "
        "spare-mm:800 first-mm:900"),
    ROW(nothing_is_sent_before_the_first_wish, "+10000 @UNKNOWN faults:0 ?OK #0"),
};

void test_tales(void)
{
    tale_words = tell;
    run_rows(tales, tale_tell_row);
}
