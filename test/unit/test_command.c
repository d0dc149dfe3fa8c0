/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One command at a time: sending, replies, attempts, and setting the frequency (tale.h). */

#include "tale.h"

/* The header of a packet of 40 samples. */
#define CUT_PACKET "<x:AA550028010001000000 "

static const row_t tales[] IN_FLASH = {
    /* ---- Sending ---- */
    ROW(a_question_in_an_unknown_state_first_stops_and_waits_for_a_quiet_line,
        "info @BUSY >65 +50 >90 <info !INFO @IDLE"),
    ROW(an_idle_lidar_is_asked_at_once,
        "idle info >90 <info !INFO @IDLE health >92 <health !HEALTH @IDLE"),
    ROW(bytes_while_the_line_is_to_be_quiet_begin_the_wait_again,
        "info >65 ~40 <junk +50 >90 <info !INFO"),
    ROW(a_line_that_is_never_quiet_fails_an_attempt_after_600_ms,
        "attempts:1 info >65 ~300 <junk !NONE ~299 <junk !NONE ~1 !FAILED ?TIMEOUT @UNKNOWN"),
    ROW(the_time_for_a_quiet_line_grows_with_quiet_line_ms,
        "quiet:599 attempts:1 info >65 ~549 <junk !NONE 59( ~10 !NONE ) ~9 >90 <info !INFO"),
    ROW(with_quiet_line_0_the_command_follows_at_once, "quiet:0 info >65 >90 <info !INFO"),
    ROW(a_port_that_takes_one_byte_per_call_gets_the_other_at_the_next_poll,
        "takes:1 info >A5 >!65 +50 >A5 ~99 >!90 <info !INFO / idle info >90 !NONE ~2000 takes:1 "
        ">A5 >!65"),
    ROW(the_time_to_send_runs_from_the_first_offer,
        "takes:0 info ~99 !NONE ~1 !FAILED ?WRITE @UNKNOWN"),
    ROW(a_command_made_long_before_the_next_poll_is_still_offered_for_100_ms,
        "wish:600 idle start >0D <600 takes:0 !FREQUENCY ~99 !NONE ~99 !NONE takes:2 >60"),
    ROW(a_port_that_fails_ends_the_command, "takes:-1 info !NONE ~1 !FAILED ?WRITE @UNKNOWN"),
    ROW(a_command_that_the_port_refuses_is_offered_again_a_millisecond_later,
        "idle !NONE ~1 takes:-1 health ~1 takes:2 >92"),
    ROW(a_failed_command_may_be_repeated_in_a_loop_that_polls_until_none,
        "takes:-1 info !NONE ~1 !FAILED info !NONE !NONE ~1 !FAILED"),
    ROW(a_first_byte_that_was_taken_is_not_sent_again,
        "idle takes:1 info >A5 takes:2 stop >!65 !FAILED ?ABORTED +50 !STOPPED"),
    ROW(a_port_that_reports_more_bytes_than_it_got_has_taken_all,
        "idle takes:256 info >90 !NONE <info !INFO"),
    /* ---- Replies and attempts ---- */
    ROW(a_question_without_an_answer_is_asked_three_times,
        "idle info >90 +2000 >65 +50 >90 +2000 >65 +50 >90 +2000 !FAILED ?TIMEOUT @UNKNOWN "
        "timeouts:3"),
    ROW(an_answer_to_a_later_attempt_leaves_the_state_unknown,
        "idle info >90 +2000 >65 +50 >90 <info !INFO @UNKNOWN"),
    ROW(the_time_for_a_reply_begins_when_the_port_has_taken_the_command,
        "idle takes:0 info ~90 !NONE takes:2 >90 +2000 >65"),
    ROW(max_attempts_0_means_one, "attempts:0 info >65 +50 >90 +2000 !FAILED"),
    ROW(reply_timeout_0_waits_without_limit, "reply:0 info >65 +50 >90 +60000 <info !INFO"),
    ROW(what_came_before_a_question_is_no_answer_to_it, "info >65 <info +50 >90 +1999 <info !INFO"),
    ROW(a_reply_of_another_length_is_not_taken, "idle info >90 <600 !NONE <info !INFO @IDLE"),
    ROW(a_late_reply_to_a_command_that_this_driver_never_sends_disturbs_no_answer, /* Section 9. */
        "idle frequency >0D <x:A55A040000001000000000 ~10 !NONE <1000 !FREQUENCY #1000"),
    ROW(a_stale_reply_after_a_packet_cut_off_by_the_stop_is_no_answer,
        "scans stop >65 " CUT_PACKET "<800 +50 !STOPPED frequency >0D +200 <600 !FREQUENCY #600"),
    ROW(a_stop_that_cuts_a_packet_does_not_delay_the_next_answer,
        "scans stop >65 " CUT_PACKET "+50 !STOPPED frequency >0D ~3 <600 !FREQUENCY #600"),
    ROW(a_packet_instead_of_an_answer_means_that_the_stop_was_lost,
        "idle info >90 <P >65 +50 >90 <info !INFO @UNKNOWN"),
    ROW(a_lidar_that_no_stop_reaches_fails_the_question_in_the_end,
        "attempts:1 idle info >90 30( <P >65 +50 >90 ) <P !NONE ~2000 !FAILED ?TIMEOUT"),
    ROW(bytes_after_the_answer_leave_the_state_unknown, "idle info >90 <info <junk !INFO @UNKNOWN"),
    /* ---- Stop ---- */
    ROW(a_stop_ends_on_a_quiet_line, "stop @STOPPING >65 +50 !STOPPED @IDLE"),
    ROW(a_stop_is_repeated_while_packets_come_and_then_fails,
        "stop >65 2( 14( ~40 <P ) ~40 >65 ) 14( ~40 <P ) ~40 !FAILED ?TIMEOUT @UNKNOWN"),
    ROW(a_repeated_stop_ends_on_a_quiet_line_too,
        "stop >65 14( ~40 <P ) ~40 >65 +50 !STOPPED @IDLE"),
    ROW(a_lidar_that_scans_on_after_its_stop_failed_is_stopped_again_after_half_a_second,
        "attempts:1 stop >65 ~300 <P !NONE ~299 <P !NONE ~1 !FAILED +500 !NONE <P !UNWANTED >65 "
        "+50 !STOPPED @IDLE"),
    ROW(packets_right_after_a_failed_stop_mean_nothing,
        "attempts:1 stop >65 ~300 <P !NONE ~299 <P !NONE ~1 !FAILED ~499 <P"),
    ROW(an_idle_lidar_that_scans_is_stopped_each_time_and_its_tail_is_not_reported,
        "idle +500 <S !UNWANTED >65 @STOPPING <P +50 !STOPPED @IDLE +500 <P !UNWANTED >65"),
    ROW(a_lidar_that_scans_after_a_question_or_a_reboot_is_stopped,
        "idle health >92 <health !HEALTH +500 <P !UNWANTED >65 / idle reboot >40 +1000 >0D <600 "
        "!REBOOTED +500 <P !UNWANTED >65"),
    ROW(a_port_that_cannot_send_the_stop_is_asked_twice_a_second,
        "idle takes:-1 1000( +10 <P drain ) events:41"), /* Two events each time, one STOPPED. */
    ROW(packets_soon_after_a_stop_may_have_been_held_by_a_layer_below,
        "idle ~499 <P @IDLE !NONE @UNKNOWN"),
    ROW(a_byte_from_an_idle_lidar_makes_its_state_unknown,
        "idle <junk !NONE @UNKNOWN info >65 +50 >90 <info !INFO"),
    /* ---- Asking for the frequency ---- */
    ROW(the_first_question_is_repeated_each_250_ms_until_its_answer,
        "idle frequency >0D +250 >0D +250 >0D <600 !FREQUENCY #600 @IDLE"),
    ROW(a_lidar_that_never_answers_is_asked_30_times,
        "idle frequency 29( >0D +250 ) timeouts:0 >0D +250 !FAILED ?TIMEOUT @UNKNOWN #0 "
        "timeouts:1"),
    ROW(an_implausible_frequency_is_an_error, /* In 16 bits the last two would be 0 and 600. */
        "idle frequency >0D <0 !FAILED ?REPLY #0 / idle frequency >0D <99 !FAILED ?REPLY / idle "
        "frequency >0D <2001 !FAILED ?REPLY / idle frequency >0D <65535 !FAILED ?REPLY / idle "
        "frequency >0D <65536 !FAILED ?REPLY / idle frequency >0D <66136 !FAILED ?REPLY #0"),
    ROW(a_plausible_frequency_is_taken,
        "idle frequency >0D <100 !FREQUENCY #100 frequency >0D <2000 !FREQUENCY #2000"),
    /* ---- Setting it ---- */
    ROW(steps_of_1_hz_then_of_a_tenth_lead_to_the_wish,
        "idle set:820 >0D <600 +50 >0B <700 +50 >0B <800 +50 >09 <810 +50 >09 <820 +50 >0D <820 "
        "!FREQUENCY #820 @IDLE"),
    ROW(steps_down,
        "idle set:890 >0D <1000 +50 >0C <900 +50 >0A <890 +50 >0D <890 !FREQUENCY #890"),
    ROW(a_lidar_that_has_the_wish_gets_no_step,
        "idle set:1000 >0D <1000 !FREQUENCY / idle set:1000 >0D <1005 !FREQUENCY / idle set:1000 "
        ">0D <995 !FREQUENCY"),
    ROW(a_frequency_outside_the_tolerance_gets_one,
        "idle set:1000 >0D <994 +50 >09 <1004 +50 >0D <1004 !FREQUENCY"),
    ROW(a_wish_that_changes_meanwhile_is_followed,
        "idle set:800 >0D <600 +50 >0B set:600 <700 +50 >0C <600 +50 >0D <600 !FREQUENCY"),
    ROW(a_last_question_that_shows_another_frequency_leads_to_another_step,
        "idle set:700 >0D <600 +50 >0B <700 +50 >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY"),
    ROW(a_lidar_that_never_gets_there_fails_after_64_steps,
        "idle set:1200 >0D <600 +50 32( >0B <700 +50 >0B <600 +50 ) !FAILED ?REPLY frequency >65 "
        "+50 >0D <600 +50 >0B"),
    ROW(a_late_copy_of_the_reply_before_is_not_taken_for_a_refusal,
        "idle set:800 >0D <600 +50 >0B <600 +1000 <700 +50 >0B <800 +50 >0D <800 !FREQUENCY"),
    ROW(a_step_without_change_is_asked_about_after_the_time_for_a_reply,
        "idle set:800 >0D <600 +50 >0B <600 ~1999 !NONE ~1 >0D <700 +50 >0B <800 +50 >0D <800 "
        "!FREQUENCY"),
    ROW(a_lidar_that_refuses_steps_fails_with_an_error_of_its_reply,
        "idle set:800 >0D <600 +50 4( >0B <600 ~2000 >0D <600 +50 ) !FAILED ?REPLY "
        "timeouts:4"),
    ROW(another_reply_to_a_step_is_awaited_for_2_s_even_if_replies_have_no_limit,
        "reply:0 idle set:700 >0D <600 +50 >0B <600 !NONE +2000 >0D <600 +50 >0B"),
    ROW(a_step_without_an_answer_makes_the_driver_ask_anew,
        "idle set:800 >0D <600 +50 >0B +2000 >0D <700 +50 >0B <800 +50 >0D <800 !FREQUENCY"),
    ROW(an_answer_that_may_be_late_is_confirmed, "idle set:700 >0D <600 +50 >0B +2000 >0D <700 +50 "
                                                 ">0D <710 +50 >0A <700 +50 >0D <700 !FREQUENCY"),
    ROW(a_lidar_that_loses_its_power_between_steps_is_asked_until_it_answers,
        "idle set:800 >0D <600 +50 >0B +2000 29( >0D +250 ) >0D +250 !FAILED ?TIMEOUT #0"),
    ROW(a_lidar_that_is_deaf_after_each_step_gets_the_whole_time_again,
        "idle set:800 >0D <600 +50 3( >0B +2000 29( >0D +250 ) >0D <600 +50 ) >0B +2000 !FAILED "
        "?TIMEOUT #0"),
    ROW(the_longest_change_of_all_may_have_three_steps_in_vain,
        "idle set:1190 >0D <600 +50 3( >0B +2000 >0D <600 +50 ) >0B <700 +50 >0B <800 +50 >0B <900 "
        "+50 >0B <1000 +50 >0B <1100 +50 >09 <1110 +50 >09 <1120 +50 >09 <1130 +50 >09 <1140 +50 "
        ">09 <1150 +50 >09 <1160 +50 >09 <1170 +50 >09 <1180 +50 >09 <1190 +50 >0D <1190 "
        "!FREQUENCY"),
    ROW(a_last_question_without_an_answer_is_repeated_but_not_for_ever,
        "idle set:700 >0D <600 +50 >0B <700 +50 4( >0D +2000 >0D <700 +50 ) >0D +2000 !FAILED "
        "?TIMEOUT #0"),
    ROW(a_lidar_that_answers_and_scans_on_is_not_stopped_for_ever,
        "idle set:700 >0D <600 +50 >0B <700 +50 >0D 15( <P >65 +50 >0D <700 +50 >0D ) <P !NONE "
        "+2000 >0D"),
    ROW(a_late_first_answer_leaves_all_questions_for_what_follows,
        "idle set:700 29( >0D +250 ) >0D <600 +50 >0B <P >65 +50 28( >0D +250 ) >0D <600 +50 >0B"),
    ROW(a_packet_while_the_frequency_is_set_means_that_the_stop_was_lost,
        "idle set:700 >0D <P >65 +50 >0D <600 +50 >0B <P >65 +50 >0D <600 +50 >0B <600 !NONE <P "
        ">65 +50 >0D <700 +50 >0D <700 !FREQUENCY"),
    /* ---- Reboot ---- */
    ROW(a_reboot_ends_when_the_lidar_answers_again,
        "idle reboot >40 @BUSY +1000 >0D +250 >0D <600 !REBOOTED @IDLE #600"),
    ROW(a_lidar_that_does_not_come_back_from_its_reboot_fails_it,
        "idle frequency >0D <600 !FREQUENCY reboot >40 +1000 29( >0D +250 ) >0D +250 !FAILED "
        "?TIMEOUT #0"),
    ROW(a_packet_after_a_reboot_leads_to_a_stop_and_not_to_another_reboot,
        "idle reboot >40 +1000 >0D <P >65 +50 >0D <600 !REBOOTED"),
    ROW(packets_during_a_reboot_mean_nothing, "idle reboot >40 <P +1000 >0D <600 !REBOOTED"),
    /* ---- Time ---- */
    ROW(a_clock_that_is_set_back_begins_the_time_of_the_phase_again,
        "idle info >90 +1000 back:100000 +2000 >65 +50 >90 <info !INFO"),
};

void test_tales(void)
{
    run_rows(tales, tale_tell_row);
}
