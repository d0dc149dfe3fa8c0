/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One command at a time: sending, replies, attempts, and setting the frequency, told in tales
 * (tale.h). */

#include "tale.h"

#include "mock_port_functions.h"
#include "tmini_driver.h"

void setUp(void) {}

void tearDown(void)
{
    tale_end();
}

/* An idle lidar: its state was unknown, so it is stopped first. */
#define IDLE "stop >65 +50 !STOPPED @IDLE "

/* ---- Sending ---- */

void test_a_question_in_an_unknown_state_first_stops_and_waits_for_a_quiet_line(void)
{
    tell("info @BUSY >65 +50 >90 <info !INFO @IDLE");
}

void test_an_idle_lidar_is_asked_at_once(void)
{
    tell(IDLE "info >90 <info !INFO @IDLE health >92 <health !HEALTH @IDLE");
}

void test_bytes_while_the_line_is_to_be_quiet_begin_the_wait_again(void)
{
    tell("info >65 ~40 <junk +50 >90 <info !INFO");
}

void test_a_line_that_is_never_quiet_fails_an_attempt_after_600_ms(void)
{
    tell("attempts:1 info >65 ~300 <junk !NONE ~299 <junk !NONE ~1 !FAILED ?TIMEOUT @UNKNOWN");
}

void test_the_time_for_a_quiet_line_grows_with_quiet_line_ms(void)
{
    tell("quiet:599 attempts:1 info >65 ~549 <junk !NONE");
    for (unsigned i = 0; i < 59; i++) {
        go_on("~10 !NONE");
    }
    go_on("~9 >90 <info !INFO");
}

void test_with_quiet_line_0_the_command_follows_at_once(void)
{
    tell("quiet:0 info >65 >90 <info !INFO");
}

void test_a_port_that_takes_one_byte_per_call_gets_the_other_at_the_next_poll(void)
{
    tell("takes:1 info >A5 >!65 +50 >A5 ~99 >!90 <info !INFO");
}

void test_the_time_to_send_runs_from_the_first_offer(void)
{
    tell("takes:0 info ~99 !NONE ~1 !FAILED ?WRITE @UNKNOWN");
}

void test_a_command_made_long_before_the_next_poll_is_still_offered_for_100_ms(void)
{
    tell(IDLE "start >0D <600 takes:0 !NONE ~99 !NONE takes:2 >60");
}

void test_a_port_that_fails_ends_the_command(void)
{
    tell("takes:-1 info !NONE ~1 !FAILED ?WRITE @UNKNOWN");
}

void test_a_failed_command_may_be_repeated_in_a_loop_that_polls_until_none(void)
{
    tell("takes:-1 info !NONE ~1 !FAILED info !NONE !NONE ~1 !FAILED");
}

void test_a_first_byte_that_was_taken_is_not_sent_again(void)
{
    tell(IDLE "takes:1 info >A5 takes:2 stop >!65 !FAILED ?ABORTED +50 !STOPPED");
}

void test_a_port_that_reports_more_bytes_than_it_got_has_taken_all(void)
{
    tell(IDLE "info >90 takes:9 <info !INFO info >90 <info !INFO");
}

/* ---- Replies and attempts ---- */

void test_a_question_without_an_answer_is_asked_three_times(void)
{
    tell(IDLE "info >90 +2000 >65 +50 >90 +2000 >65 +50 >90 +2000 !FAILED ?TIMEOUT @UNKNOWN");
}

void test_an_answer_to_a_later_attempt_leaves_the_state_unknown(void)
{
    tell(IDLE "info >90 +2000 >65 +50 >90 <info !INFO @UNKNOWN");
}

void test_max_attempts_0_means_one(void)
{
    tell("attempts:0 info >65 +50 >90 +2000 !FAILED");
}

void test_reply_timeout_0_waits_without_limit(void)
{
    tell("reply:0 info >65 +50 >90 +60000 <info !INFO");
}

void test_what_came_before_a_question_is_no_answer_to_it(void)
{
    tell("info >65 <info +50 >90 +1999 <info !INFO");
}

void test_a_reply_of_another_length_is_not_taken(void)
{
    tell(IDLE "info >90 <600 !NONE <info !INFO @IDLE");
}

void test_a_packet_instead_of_an_answer_means_that_the_stop_was_lost(void)
{
    tell(IDLE "info >90 <P >65 +50 >90 <info !INFO @UNKNOWN");
}

void test_a_lidar_that_no_stop_reaches_fails_the_question_in_the_end(void)
{
    tell("attempts:1 " IDLE "info >90");
    for (unsigned packets = 0; packets < 30; packets++) {
        go_on("<P >65 +50 >90");
    }
    go_on("<P !NONE ~2000 !FAILED ?TIMEOUT");
}

void test_bytes_after_the_answer_leave_the_state_unknown(void)
{
    tell(IDLE "info >90 <info <junk !INFO @UNKNOWN");
}

/* ---- Stop ---- */

void test_a_stop_ends_on_a_quiet_line(void)
{
    tell("stop @STOPPING >65 +50 !STOPPED @IDLE");
}

void test_a_stop_is_repeated_while_packets_come_and_then_fails(void)
{
    tell("stop >65");
    for (unsigned attempt = 0; attempt < 3; attempt++) {
        for (unsigned packet = 0; packet < 14; packet++) {
            go_on("~40 <P");
        }
        go_on(attempt < 2 ? "~40 >65" : "~40 !FAILED ?TIMEOUT @UNKNOWN");
    }
}

void test_a_lidar_that_scans_on_after_its_stop_failed_is_stopped_again_after_half_a_second(void)
{
    tell("attempts:1 stop >65 ~300 <P !NONE ~299 <P !NONE ~1 !FAILED +500 !NONE "
         "<P !UNWANTED >65 +50 !STOPPED @IDLE");
}

void test_packets_right_after_a_failed_stop_mean_nothing(void)
{
    tell("attempts:1 stop >65 ~300 <P !NONE ~299 <P !NONE ~1 !FAILED ~499 <P");
}

void test_an_idle_lidar_that_scans_is_stopped(void)
{
    tell(IDLE "+500 <P !UNWANTED >65 @STOPPING +50 !STOPPED");
}

void test_packets_soon_after_a_stop_may_have_been_held_by_a_layer_below(void)
{
    tell(IDLE "~499 <P @IDLE !NONE @UNKNOWN");
}

void test_a_byte_from_an_idle_lidar_makes_its_state_unknown(void)
{
    tell(IDLE "<junk !NONE @UNKNOWN info >65 +50 >90 <info !INFO");
}

/* ---- Asking for the frequency ---- */

void test_the_first_question_is_repeated_each_250_ms_until_its_answer(void)
{
    tell(IDLE "frequency >0D +250 >0D +250 >0D <600 !FREQUENCY #600 @IDLE");
}

void test_a_lidar_that_never_answers_is_asked_30_times(void)
{
    tell(IDLE "frequency");
    for (unsigned asks = 0; asks < 29; asks++) {
        go_on(">0D +250");
    }
    go_on(">0D +250 !FAILED ?TIMEOUT @UNKNOWN #0");
}

void test_an_implausible_frequency_is_an_error(void)
{
    tell(IDLE "frequency >0D <99 !FAILED ?REPLY");
    tell(IDLE "frequency >0D <2001 !FAILED ?REPLY");
    tell(IDLE "frequency >0D <100 !FREQUENCY #100 frequency >0D <2000 !FREQUENCY #2000");
}

/* ---- Setting it ---- */

void test_steps_of_1_hz_then_of_a_tenth_lead_to_the_wish(void)
{
    tell(IDLE "set:820 >0D <600 +50 >0B <700 +50 >0B <800 +50 >09 <810 +50 >09 <820 +50 >0D <820 "
              "!FREQUENCY #820 @IDLE");
}

void test_steps_down(void)
{
    tell(IDLE "set:890 >0D <1000 +50 >0C <900 +50 >0A <890 +50 >0D <890 !FREQUENCY #890");
}

void test_a_lidar_that_has_the_wish_gets_no_step(void)
{
    tell(IDLE "set:1000 >0D <1000 !FREQUENCY");
    tell(IDLE "set:1000 >0D <1005 !FREQUENCY");
    tell(IDLE "set:1000 >0D <995 !FREQUENCY");
}

void test_a_frequency_outside_the_tolerance_gets_one(void)
{
    tell(IDLE "set:1000 >0D <994 +50 >09 <1004 +50 >0D <1004 !FREQUENCY");
}

void test_a_wish_that_changes_meanwhile_is_followed(void)
{
    tell(IDLE "set:800 >0D <600 +50 >0B set:600 <700 +50 >0C <600 +50 >0D <600 !FREQUENCY");
}

void test_a_last_question_that_shows_another_frequency_leads_to_another_step(void)
{
    tell(IDLE "set:700 >0D <600 +50 >0B <700 +50 >0D <600 +50 >0B <700 +50 >0D <700 !FREQUENCY");
}

void test_a_lidar_that_never_gets_there_fails_after_20_steps(void)
{
    tell(IDLE "set:1200 >0D <600 +50");
    for (unsigned pair = 0; pair < 10; pair++) {
        go_on(">0B <700 +50 >0B <600 +50");
    }
    go_on("!FAILED ?REPLY");
}

void test_a_late_copy_of_the_reply_before_is_not_taken_for_a_refusal(void)
{
    tell(IDLE "set:800 >0D <600 +50 >0B <600 +1000 <700 +50 >0B <800 +50 >0D <800 !FREQUENCY");
}

void test_a_step_without_change_is_asked_about_after_the_time_for_a_reply(void)
{
    tell(IDLE "set:800 >0D <600 +50 >0B <600 ~1999 !NONE ~1 >0D <700 +50 >0B <800 +50 >0D <800 "
              "!FREQUENCY");
}

void test_a_lidar_that_refuses_steps_fails_with_an_error_of_its_reply(void)
{
    tell(IDLE "set:800 >0D <600 +50");
    for (unsigned step = 0; step < 3; step++) {
        go_on(">0B <600 ~2000 >0D <600 +50");
    }
    go_on(">0B <600 ~2000 !FAILED ?REPLY");
}

void test_another_reply_to_a_step_is_awaited_for_2_s_even_if_replies_have_no_limit(void)
{
    tell("reply:0 " IDLE "set:700 >0D <600 +50 >0B <600 !NONE +2000 >0D <600 +50 >0B");
}

void test_a_step_without_an_answer_makes_the_driver_ask_anew(void)
{
    tell(IDLE "set:800 >0D <600 +50 >0B +2000 >0D <700 +50 >0B <800 +50 >0D <800 !FREQUENCY");
}

void test_an_answer_that_may_be_late_is_confirmed(void)
{
    tell(IDLE "set:700 >0D <600 +50 >0B +2000 >0D <700 +50 >0D <710 +50 >0A <700 +50 >0D <700 "
              "!FREQUENCY");
}

void test_a_lidar_that_loses_its_power_between_steps_is_asked_until_it_answers(void)
{
    tell(IDLE "set:800 >0D <600 +50 >0B +2000");
    for (unsigned asks = 0; asks < 21; asks++) {
        go_on(">0D +250");
    }
    go_on(">0D +250 !FAILED ?TIMEOUT #0");
}

void test_a_packet_while_the_frequency_is_set_means_that_the_stop_was_lost(void)
{
    tell(IDLE "set:700 >0D <P >65 +50 >0D <600 +50 >0B <P >65 +50 >0D <600 +50 >0B <600 !NONE <P "
              ">65 +50 >0D <700 +50 >0D <700 !FREQUENCY");
}

/* ---- Reboot ---- */

void test_a_reboot_ends_when_the_lidar_answers_again(void)
{
    tell(IDLE "reboot >40 @BUSY +1000 >0D +250 >0D <600 !REBOOTED @IDLE #600");
}

void test_a_lidar_that_does_not_come_back_from_its_reboot_fails_it(void)
{
    tell(IDLE "reboot >40 +1000");
    for (unsigned asks = 0; asks < 29; asks++) {
        go_on(">0D +250");
    }
    go_on(">0D +250 !FAILED ?TIMEOUT");
}

void test_a_packet_after_a_reboot_leads_to_a_stop_and_not_to_another_reboot(void)
{
    tell(IDLE "reboot >40 +1000 >0D <P >65 +50 >0D <600 !REBOOTED");
}

void test_packets_during_a_reboot_mean_nothing(void)
{
    tell(IDLE "reboot >40 <P +1000 >0D <600 !REBOOTED");
}

/* ---- Time ---- */

void test_a_clock_that_is_set_back_begins_the_time_of_the_phase_again(void)
{
    tell(IDLE "info >90 +1000");
    rig.now_ms -= 100000;
    go_on("+2000 >65 +50 >90 <info !INFO");
}
