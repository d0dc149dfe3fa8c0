/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar that is lost: how it is noticed, the ladder of attempts, how it comes back, and what
 * outlives a loss (tale.h). */

#include "tale.h"

/* Pauses of 0.5, 1, 2 and 2 s; a reboot before the fourth attempt and each later one. */
static const tale_phrase_t phrases[] = {
    {"fails", "<600 >60 +2000 !NONE"},
    {"fails-with-reboot", "<600 >40 +1000 >0D <600 >0D <600 >60 +2000 !NONE"},
    {"attempt", ">65 +50 >0D fails"},
    {"reboot-first", ">65 +50 >0D fails-with-reboot"},
    {"mute", "30( >0D +250 ) >65 +50"},
    {"lost-again", "mute >60 <S !RECOVERED +1000 !LOST"},
    {"noise", "14( ~40 <junk )"},
    {NULL, NULL},
};

/* From 11 to 190 degrees, and from 191 to 9: a turn that began with a start packet at 10. */
#define REST_OF_CIRCLE \
    "<x:AA5500028105015F2A0D32A00F32A00F <x:AA550002815F8104AA0C32A00F32A00F !NONE "
#define NO_AGE "age:2147483647 "

static const row_t tales[] IN_FLASH = {
    /* ---- How a loss is noticed ---- */
    ROW(a_second_without_a_packet_is_a_loss, "scans +1000 !LOST @RECOVERING #0 >65"),
    ROW(each_packet_puts_the_loss_off, "scans +999 <P +1000 !LOST >65"),
    ROW(bytes_without_valid_packets_are_a_loss_too,
        "scans ~500 <junk !NONE ~499 <junk !NONE ~1 !LOST >65"),
    ROW(a_line_seen_silent_for_500_ms_is_a_loss_although_polls_are_rare,
        "scans 9( ~101 !NONE ) ~101 !LOST >65"),
    ROW(a_line_seen_silent_for_less_gives_the_lidar_another_100_ms,
        "scans 9( ~108 !NONE ) ~49 !NONE @SCANNING +100 !LOST >65"),
    ROW(a_task_that_slept_until_the_loss_reports_it, "scans ~1009 !LOST >65"),
    ROW(a_poll_after_a_pause_of_the_program_gives_the_lidar_another_100_ms,
        "scans ~951 !NONE ~59 !NONE @SCANNING +100 !LOST >65"),
    ROW(late_polls_give_three_chances, "scans ~5000 !NONE ~500 !NONE ~500 !NONE ~500 !LOST >65"),
    ROW(a_packet_after_a_late_poll_averts_the_loss, "scans ~5000 !NONE ~99 <P +999"),
    /* ---- The ladder ---- */
    ROW(a_lost_lidar_is_stopped_asked_and_started,
        "lost >65 +50 >0D <600 >60 <scan <S !RECOVERED @SCANNING losses:1 recoveries:1 restarts:1 "
        "reboots:0"),
    ROW(a_lidar_that_answers_and_does_not_scan_is_rebooted_after_three_attempts,
        "lost >65 +50 >0D fails +500 >65 +50 >0D fails +1000 >65 +50 >0D fails +2000 >65 +50 >0D "
        "fails-with-reboot +2000 >65 +50 >0D fails-with-reboot +2000 >65 +50 >0D fails-with-reboot "
        "+2000 >65 reboots:3 restarts:6"),
    ROW(a_lidar_without_power_is_asked_without_a_pause_and_gets_no_reboot,
        "lost >65 +50 6( 30( >0D +250 ) >65 +50 ) >0D <600 >60 <scan <S !RECOVERED reboots:0"),
    ROW(a_line_that_does_not_fall_quiet_is_a_failed_attempt,
        "lost >65 noise ~40 >65 noise ~40 +500 >65"), /* Asking fails, then starting. */
    ROW(noise_and_then_silence_cause_no_reboot,
        "start >65 noise ~40 >65 noise ~40 !FAILED +500 >65 noise ~40 >65 noise ~40 !FAILED +1000 "
        ">65 noise ~40 >65 noise ~40 !FAILED +2000 >65 +50 30( >0D +250 ) >65 +50 >60"),
    ROW(a_loss_before_a_whole_turn_continues_the_ladder,
        "lost >65 +50 >0D fails +500 >65 +50 >0D <600 >60 <scan <S !RECOVERED +1000 !LOST +1000 "
        ">65"),
    /* The third loss counts as a new first attempt: two more failures lead to a reboot. */
    ROW(a_lidar_that_never_answers_is_lost_again_and_again_without_a_reboot,
        "start >65 +50 mute >60 <S !STARTED +1000 !LOST >65 +50 lost-again +500 >65 +50 lost-again "
        "+1000 >65 +50 lost-again +2000 >65 +50 lost-again +2000 >65 +50 >0D fails +2000 >65 +50 "
        ">0D fails +2000 >65 +50 >0D <600 >40 +1000 >0D <600 >0D <600 >60"),
    ROW(a_loss_after_a_whole_turn_begins_it_again,
        "lost >65 +50 >0D fails +500 >65 +50 >0D <600 >60 <scan <S !RECOVERED turns:2:60 +1000 "
        "!LOST >65"),
    ROW(the_first_pause_is_no_longer_than_the_longest,
        "backoff:400 lost >65 +50 >0D fails +400 >65"),
    ROW(the_longest_pause_may_be_65_s,
        "backoff:65535 lost attempt +500 attempt +1000 attempt +2000 reboot-first +4000 "
        "reboot-first +8000 reboot-first +16000 reboot-first +32000 reboot-first +64000 "
        "reboot-first +65535 >65"),
    ROW(a_port_that_fails_makes_the_attempt_fail, "lost takes:-1 !NONE !NONE ~500 takes:2 >65"),
    /* The lidar has heard nothing. */
    ROW(attempts_that_the_port_fails_cause_no_reboot,
        "lost takes:-1 !NONE !NONE ~500 !NONE !NONE ~1000 !NONE !NONE ~2000 !NONE !NONE ~2000 "
        "!NONE !NONE takes:2 ~2000 >65 +50 >0D <600 >60"),
    ROW(the_port_restarts_its_reception_at_a_loss_and_after_each_failed_attempt,
        "scans +1000 !LOST port-restarts:1 starts-again +2000 !NONE port-restarts:2"),
    ROW(a_port_may_have_no_restart, "no-restart scans +1000 !LOST >65"),
    ROW(a_stop_ends_the_recovery,
        "lost >65 stop >65 +50 !STOPPED @IDLE / lost >65 +50 >0D fails +100 stop >65 +50 !STOPPED"),
    /* ---- How it comes back ---- */
    ROW(point_packets_are_no_recovery_and_a_start_packet_is,
        "lost >65 +50 >0D <600 >60 <scan <P @RECOVERING +100 <P !NONE <S !RECOVERED"),
    ROW(ranges_without_a_start_packet_for_three_seconds_are_a_failed_attempt,
        "lost >65 +50 >0D <600 >60 <P !NONE 29( ~100 <P !NONE ) ~100 +500 >65"),
    ROW(a_blocked_rotor_has_recovered,
        "lost >65 +50 >0D <600 >60 <scan <PZ !NONE 29( ~100 <PZ !NONE ) ~100 !RECOVERED @SCANNING"),
    ROW(a_rotor_that_comes_free_gets_time_for_its_start_packet,
        "lost >65 +50 >0D <600 >60 <PZ ~2900 <P <PZ ~2900 <P !NONE <S !RECOVERED"),
    ROW(a_lidar_that_comes_back_in_the_pause_has_recovered,
        "lost >65 +50 >0D fails <P @RECOVERING <S !RECOVERED"),
    ROW(packets_between_the_stop_and_a_quiet_line_are_no_recovery,
        "lost >65 <S <P +50 >0D <600 >60 <S !RECOVERED"),
    ROW(a_frequency_that_could_not_be_set_again_is_reported,
        "wish:700 idle start >0D <700 !FREQUENCY >60 <scan <S !STARTED turns:2:70 +1000 !LOST >65 "
        "+50 >0D <99 >65 +50 >60 <scan <S !FAILED !RECOVERED ?REPLY"),
    ROW(a_frequency_that_could_not_be_set_is_reported_once,
        "off wish:700 idle start >0D <99 >65 +50 >60 <scan <S !STARTED !FAILED +1000 !LOST <S "
        "!RECOVERED"),
    ROW(a_wish_that_could_not_be_set_after_a_loss_does_not_interrupt_the_scans_at_once,
        "scans-at-10 set:900 +1000 !LOST >65 +50 >0D <99 >65 +50 >60 <scan <S !FAILED !RECOVERED "
        "turns:8:100"),
    ROW(a_recovery_that_was_not_polled_is_not_told_after_a_stop,
        "wish:700 idle start >0D <700 !FREQUENCY >60 <scan <S !STARTED turns:2:70 +1000 !LOST >65 "
        "+50 >0D <99 >65 +50 >60 <scan <S !FAILED stop >65 +50 !STOPPED"),
    /* ---- Without recovery ---- */
    ROW(without_recovery_a_loss_is_reported_and_nothing_sent,
        "off lost +70000 +1000 <P @RECOVERING <S !RECOVERED @SCANNING"),
    ROW(without_recovery_a_start_after_a_loss_starts,
        "off lost start @STARTING >65 +50 >0D <600 >60 <scan <S !STARTED"),
    ROW(without_recovery_a_new_wish_after_a_loss_waits,
        "off lost set:700 +60000 start >65 +50 >0D <700 !FREQUENCY >60"),
    /* ---- How old the newest complete scan is ---- */
    ROW(before_the_first_complete_scan_its_age_is_at_its_maximum,
        "!NONE " NO_AGE "idle ~250 !NONE " NO_AGE "start >0D <600 >60 <scan <S !STARTED " NO_AGE),
    ROW(the_age_of_the_newest_complete_scan_counts_from_its_end,
        "scans " REST_OF_CIRCLE "~160 <S !SCAN age:0 ~100 age:100 turns:3:60 age:580 ~20 age:600"),
    /* 1310 bytes that wait in the port came after it: 99 ms. */
    ROW(a_scan_that_is_delivered_late_is_as_old_as_its_end,
        "scans " REST_OF_CIRCLE "~160 <S held:1310 !SCAN age:99 ~1 age:100"),
    /* 22 bytes follow its last one, which take 1 ms. At 0 would mean: never. */
    ROW(a_scan_that_ends_at_0_counts_as_ended_at_1,
        "clock:-210 scans " REST_OF_CIRCLE "~160 <S <P !SCAN age:0 ~100 age:99"),
    ROW(a_clock_that_is_set_back_a_little_makes_no_scan_younger,
        "idle completed:50 ~250 !NONE age:300 back:200 age:300 !NONE age:300"),
    ROW(a_clock_may_begin_at_zero, "clock:0 !NONE " NO_AGE "~1 !NONE " NO_AGE "~1 !NONE " NO_AGE),
    ROW(a_clock_that_wraps_around_to_zero_makes_no_scan_younger,
        "idle clock:-50 !NONE completed:500 clock:0 !NONE clock:50 !NONE age:600"),
    ROW(an_age_of_24_days_is_known_without_a_poll,
        "idle completed:0 !NONE ~2147483646 age:2147483646 ~1 " NO_AGE "/ idle completed:100 !NONE "
        "~2147483600 " NO_AGE),
    ROW(an_age_of_24_days_remains,
        "idle completed:0 5( ~1073741823 !NONE ) " NO_AGE "~1000 " NO_AGE),
    /* ---- How long a task may sleep ---- */
    ROW(an_idle_lidar_needs_no_poll_for_a_minute, "idle !NONE next:65535 ~70000 next:0"),
    ROW(a_task_sleeps_until_the_line_is_quiet_in_steps_of_50_ms_at_most,
        "stop >65 !NONE next:50 ~20 next:30 !NONE ~20 !NONE next:10 ~10 next:0 !STOPPED / "
        "quiet:200 stop >65 !NONE next:50 ~50 !NONE next:50 ~50 !NONE ~50 !NONE ~50 !STOPPED / "
        "quiet:300 6( ~50 !NONE ) stop >65 !NONE next:50 / quiet:20 ~100 !NONE stop >65 !NONE "
        "next:20 ~20 next:0 !STOPPED"),
    ROW(a_task_sleeps_no_longer_than_a_line_may_be_noisy,
        "quiet:599 stop >65 !NONE 3( ~300 <junk !NONE ) ~240 !NONE next:9 ~9 >65 / stop >65 6( ~40 "
        "<junk !NONE ) ~30 !NONE next:20 / quiet:300 stop >65 5( ~50 !NONE ) ~10 <junk !NONE "
        "next:50"),
    ROW(a_task_sleeps_until_a_reply_is_overdue,
        "idle info >90 !NONE next:2000 ~500 next:1500 ~1600 next:0 >65"),
    ROW(an_event_or_a_byte_that_waits_for_the_port_is_polled_at_once,
        "idle takes:0 info next:1 takes:2 >90 !NONE next:2000 <info !INFO next:0 !NONE info >90 "
        "takes:0 stop next:0 !FAILED takes:2 >65 +50 !STOPPED"),
    ROW(a_task_sleeps_until_a_candidate_is_given_up,
        "scans !NONE next:1000 <x:AA ~10 !NONE next:50 ~50 !NONE next:50 ~10 !NONE next:40 ~50 "
        "next:0 / frame:300 scans <x:AA ~10 !NONE next:50 5( ~50 !NONE ) ~20 !NONE next:30"),
    ROW(a_candidate_with_no_time_at_all_is_polled_after_a_millisecond,
        "frame:0 scans <x:AA ~10 !NONE next:1"),
    /* ---- What outlives a loss ---- */
    ROW(after_a_recovery_no_scan_continues_one_from_before_the_loss,
        "scans +1000 !LOST starts-again <P <S !RECOVERED !NONE scans:0"),
    ROW(a_turn_cut_by_a_loss_is_no_data_fault,
        "no-scans scans 2( <blind !NONE ) +1000 !LOST starts-again <PZ <SZ !RECOVERED !NONE <blind "
        "!NONE <blind !FAULTS"),
    ROW(a_range_from_before_a_loss_does_not_clear_a_data_fault,
        "no-scans scans 2( <blind !NONE ) <blind !FAULTS <P !NONE +1000 !LOST starts-again <PZ "
        "<plain !RECOVERED !NONE <plain !NONE <plain !FAULTS"),
    ROW(a_turn_from_before_a_stop_is_not_trusted_after_the_next_start, /* Right by chance. */
        "no-scans scans <ct:0x10 !NONE idle start >0D <600 >60 <scan <ct:0x10 !STARTED !NONE "
        "known:0"),
    ROW(faults_outlive_a_loss,
        "no-scans scans 2( <ct:0x08 !NONE ) <ct:0x08 !FAULTS +1000 !LOST faults:0x08 >65"),
    ROW(what_the_unit_reported_of_itself_is_not_known_after_a_loss,
        "no-scans scans 3( <ct:0 !NONE ) user:1 +1000 !LOST known:0 user:0 >65"),
};

void test_tales(void)
{
    tale_phrases = phrases;
    run_rows(tales, tale_tell_row);
}
