/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What polls bring: bytes and silence, scans, packets, pauses of the line, and all this while the
 * clock wraps around (tale.h). */

#include "tale.h"

/* It claims more bytes than come, so it hides what comes after it. */
#define HEADER_OF_80 "<x:AA550050010001000000 "
#define HEADER_OF_40 "<x:AA550028010001000000 "
#define DATA_FAULT "scans 2( <blind drain ) <blind !FAULTS "
/* Half a turn at 6 Hz is 83 ms; eight packets take 12 ms more than the first. */
#define PAUSES "pause:30 scans <small:700 drain "
#define EIGHT_PACKETS "8( <P ) "
#define GARBAGE "pause:30 scans 2( <small:700 drain ~1 ) <P drain "

static const row_t tales[] IN_FLASH = {
    /* ---- Bytes ---- */
    ROW(every_byte_is_accounted_for, /* 35 have come. */
        "idle health >92 <junk <health <junk <P <x:AA !HEALTH !NONE in-packets:22 in-replies:10 "
        "skipped:2 pending:1 overrun:0"),
    ROW(bytes_that_find_the_buffer_full_are_counted,
        "<zeros:256 <zeros:7 !NONE overrun:7 skipped:256"),
    ROW(bytes_of_a_second_overflow_are_counted_with_the_first_ones,
        "<zeros:256 <zeros:7 !NONE <zeros:256 <zeros:5 overrun:12"),
    ROW(packets_in_the_unknown_state_are_counted_but_are_no_event, "<S !NONE packets:1 @UNKNOWN"),
    ROW(a_late_reply_among_packets_costs_none_of_them,
        "scans <P <x:A55A040000001000000000 <P drain packets:3 skipped:11"),
    ROW(the_reply_to_another_query_does_not_change_the_health,
        "idle health >92 <health:2 !HEALTH frequency >0D <600 !FREQUENCY health-faults:2 "
        "health-code:0x1234"),
    ROW(a_quiet_line_may_have_to_be_silent_for_longer_than_256_ms,
        "quiet:300 stop >65 6( !NONE ~50 ) !STOPPED / quiet:7 stop >65 +7 !STOPPED"),
    /* ---- Silence ---- */
    ROW(the_time_between_two_polls_is_silence_for_50_ms_at_most, /* The byte is left after 101. */
        "frame:101 <x:AA !NONE 2( ~60 !NONE ) pending:1 ~1 !NONE pending:0"),
    ROW(a_frame_timeout_may_be_longer_than_256_ms,
        "frame:300 <x:AA !NONE 6( pending:1 ~50 !NONE ) pending:0 / frame:300 <x:AA !NONE 5( ~50 "
        "!NONE ) ~45 !NONE pending:1 ~5 !NONE pending:0"),
    ROW(a_poll_after_a_multiple_of_256_or_65536_ms_does_what_is_due,
        "idle info >90 !NONE ~2304 >65 / idle info >90 !NONE ~65536 >65"),
    ROW(without_a_frame_timeout_a_reply_in_two_parts_is_taken,
        "frame:0 idle health >92 <x:A55A030000 !NONE ~1 <x:0006000000 !HEALTH"),
    ROW(without_a_frame_timeout_a_silent_poll_gives_up_a_reply,
        "frame:0 idle health >92 <x:A55A030000 !NONE pending:5 ~1 !NONE pending:0"),
    ROW(silence_gives_up_one_candidate_after_the_other_so_that_the_packets_they_hide_are_delivered,
        "scans 2( " HEADER_OF_80 "<S ) +100 !SCAN !SCAN scans:2 pending:0"),
    ROW(silence_gives_up_a_single_byte_too, "<x:AA +100 !NONE pending:0 skipped:1"),
    ROW(silence_gives_up_what_hides_a_reply_too, "idle info >90 " HEADER_OF_40 "<info +100 !INFO"),
    /* ---- Scans ---- */
    ROW(a_scan_is_delivered_after_the_fault_that_came_with_it, DATA_FAULT "!SCAN count:17"),
    ROW(a_scan_that_waits_after_a_fault_is_no_loss_however_late_the_next_poll,
        DATA_FAULT "~1500 !SCAN <PZ !NONE @SCANNING"),
    ROW(a_stop_does_not_take_back_a_scan_that_waits_after_a_fault,
        DATA_FAULT "stop >65 !SCAN count:17 +50 !STOPPED"),
    ROW(a_scan_with_more_points_than_the_buffer_holds_says_how_many_were_dropped,
        "points:30 scans <P:40 <S !SCAN count:30 dropped:11 complete:0"),
    ROW(a_new_start_does_not_continue_the_scan_before_the_stop,
        "scans <small:700 !SCAN idle start >0D <600 >60 <scan <small:800 !STARTED !NONE <small:900 "
        "!SCAN first-mm:800 gaps:0"),
    ROW(while_the_program_is_behind_scans_of_two_packets_that_a_doubt_ends_are_withheld,
        "pause:30 scans <S <S <P !SCAN ~160 <S !NONE scans:1 withheld:6 / pause:30 scans <S <P "
        "held:5 !SCAN !NONE ~160 <S !NONE withheld:5 / pause:30 scans <small:700 held:5 !SCAN "
        "!NONE ~160 <S !SCAN complete:0 withheld:0"),
    ROW(and_any_incomplete_one_while_the_port_holds_more,
        "pause:30 scans <S <P <P held:5 !SCAN !NONE ~160 <S held:1 !NONE withheld:9"),
    ROW(else_a_scan_of_one_packet_that_a_doubt_ends_is_delivered,
        "pause:30 scans <S !SCAN !NONE ~160 <S !SCAN count:1 withheld:0"),
    ROW(a_packet_that_comes_in_time_has_a_gap_of_the_bytes_before_it,
        GARBAGE "83( ~1 <x:00 !NONE ) ~1 <P drain gap:83"),
    ROW(a_packet_that_comes_too_late_has_an_unknown_gap_though_the_line_was_never_silent,
        GARBAGE "84( ~1 <x:00 !NONE ) ~1 <P drain gap:65535"),
    /* ---- Pauses of the line ---- */
    ROW(a_scan_goes_on_after_a_pause_that_cannot_hold_half_a_turn,
        PAUSES "~95 " EIGHT_PACKETS "!NONE"),
    ROW(a_longer_pause_ends_the_scan_and_packets_without_a_pause_continue_the_next,
        PAUSES "~96 " EIGHT_PACKETS "!SCAN count:9 complete:0 late:1 <small:800 <small:900 !SCAN "
               "count:32 !SCAN count:9 gaps:0"),
    ROW(pauses_longer_than_a_quarter_of_a_second_can_be_allowed,
        "pause:300 scans <small:700 drain ~250 " EIGHT_PACKETS "!NONE"),
    ROW(pauses_are_ignored_if_the_limit_is_0,
        "pause:0 scans <small:700 drain ~10000 " EIGHT_PACKETS "!NONE"),
    ROW(a_pause_counts_from_poll_to_poll_however_often_it_is_polled,
        PAUSES "95( ~1 !NONE ) ~1 " EIGHT_PACKETS "!SCAN"),
    ROW(packets_cut_to_a_few_bytes_for_too_long_end_the_scan,
        PAUSES "9( ~10 <x:1122334455 !NONE ) <P !SCAN count:9"),
    /* ---- The beginning of the clock ---- */
    ROW(before_the_clocks_first_tick_a_failed_port_is_not_asked_again,
        "clock:0 takes:-1 stop 2( !NONE ) ~1 !FAILED ?WRITE"),
    /* ---- The wraparound of the clock, in every wait ---- */
    ROW(waiting_for_a_quiet_line_survives_it, "clock:-26 stop >65 <junk +50 !STOPPED"),
    ROW(waiting_for_a_stop_survives_it, "clock:-300 stop >65 30( <junk +20 ) >65"),
    ROW(waiting_for_a_reply_survives_it, "idle clock:-1000 info >90 +2000 >65"),
    ROW(waiting_for_the_transmitter_survives_it, "clock:-50 takes:0 stop ~99 !NONE ~1 !FAILED"),
    ROW(waiting_for_the_first_packet_survives_it, "starts clock:-1500 <scan +3000 !FAILED"),
    ROW(waiting_between_steps_survives_it, "idle clock:-26 set:700 >0D <600 +50 >0B"),
    ROW(waiting_for_a_reboot_survives_it, "idle clock:-500 reboot >40 +1000 >0D"),
    ROW(waiting_for_data_survives_it, "scans clock:-500 <P +1000 !LOST >65"),
    ROW(the_pause_between_attempts_survives_it, /* 3420 ms pass before it. */
        "clock:-3670 lost starts-again +2000 !NONE +500 >65"),
    ROW(silence_survives_it, "scans clock:-51 <S !SCAN " HEADER_OF_80 "<S +100 !SCAN"),
};

void test_tales(void)
{
    run_rows(tales, tale_tell_row);
}
