/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Faults that are derived from packets while the lidar scans, and the frequency's closed loop
 * (tale.h). */

#include "tale.h"

static const tale_phrase_t phrases[] = {
    {"no-answer", "<99 >65 +50 >60 <scan <S !STARTED !FAILED"},
    {"again", "<turn:60 !SCAN !PAUSED >65 +50 >0D no-answer"},
    {NULL, NULL},
};

#define SCANS "no-scans scans "
#define DATA_FAULT SCANS "2( <blind !NONE ) <blind !FAULTS faults:0x20 "
/* Point packets without a range, 4000 samples per second. */
#define STANDS_STILL "<SZ drain 1495( <PZ:8 +2 ) 5( <PZ:8 ) !FAULTS "

static const row_t tales[] IN_FLASH = {
    /* ---- Faults from CT information ---- */
    ROW(a_fault_seen_in_two_trusted_turns_is_reported_once,
        SCANS "2( <ct:1 !NONE ) faults:0 <ct:1 !FAULTS faults:1 <ct:1 !NONE"),
    ROW(a_fault_seen_in_one_turn_only_is_not_reported,
        SCANS "<ct:0 !NONE 3( <ct:1 !NONE <ct:0 !NONE ) <ct:0 !NONE faults:0"),
    ROW(a_fault_is_cleared_by_two_trusted_turns_without_it,
        SCANS "2( <ct:8 drain ) <ct:0 drain faults:8 <ct:0 !NONE <ct:0 !FAULTS faults:0"),
    ROW(a_fault_seen_in_one_trusted_turn_and_one_that_is_not_is_not_reported,
        SCANS "<ct:1 !NONE <ct:0 !NONE bad-crc <ct:0 !NONE faults:0"),
    ROW(a_data_fault_that_ends_in_turns_of_which_a_packet_is_missing_is_reported,
        DATA_FAULT "2( bad-crc <ct:0 !NONE ) bad-crc <ct:0 !FAULTS faults:0"),
    ROW(a_second_fault_is_reported_beside_the_first,
        SCANS "2( <ct:8 drain ) 2( <ct:0x18 drain ) <ct:0 !FAULTS faults:0x18"),
    ROW(a_turn_that_is_not_trusted_neither_reports_nor_clears, /* Only one is trusted at last. */
        SCANS "2( <ct:0 drain ) <ct:1 drain 2( bad-crc <ct:1 !NONE ) <ct:1 !NONE <ct:0 !FAULTS"),
    ROW(a_turn_that_is_not_trusted_between_two_that_are_does_not_part_them,
        SCANS "2( <ct:1 !NONE ) bad-crc <ct:1 !NONE <ct:0 !FAULTS faults:1"),
    ROW(a_unit_that_reports_its_health_is_believed_even_without_any_range,
        SCANS "<ct:0 drain 4( <blind-ct:0 !NONE ) faults:0"),
    ROW(ct_information_is_known_once_a_turn_was_trusted,
        SCANS "<ct:0x10 !NONE known:0 <ct:0x10 !NONE known:0x1A user:1 unit-faults:0x10"),
    /* ---- Faults from distances, on units without CT information ---- */
    ROW(two_turns_without_any_range_are_a_data_fault, DATA_FAULT "<blind !NONE"),
    ROW(a_data_fault_is_cleared_by_two_turns_with_a_range,
        DATA_FAULT "2( <plain !NONE ) <plain !FAULTS faults:0"),
    ROW(one_valid_range_a_turn_is_no_fault, SCANS "4( <SZ <PZ <P:1 <PZ !NONE )"),
    ROW(the_start_packets_own_range_counts, SCANS "4( <S <PZ !NONE )"),
    ROW(turns_of_which_packets_were_lost_are_no_data_fault, SCANS "4( <SZ 20( <junk ) !NONE )"),
    ROW(a_turn_of_which_a_point_packet_was_lost_is_no_data_fault,
        SCANS "4( <SZ <junk <junk <PZ !NONE )"),
    ROW(one_byte_before_a_start_packet_may_be_last_crc_and_the_turn_is_whole,
        SCANS "3( <blind drain <x:00 ) faults:0x20"),
    ROW(a_range_clears_a_data_fault_though_packets_were_lost,
        DATA_FAULT "3( <junk <junk <S drain ) faults:0"),
    ROW(ranges_in_two_incomplete_turns_clear_a_data_fault,
        DATA_FAULT "2( <junk <junk <P <SZ drain ) faults:0"),
    ROW(what_precedes_the_first_start_packet_is_no_turn,
        "no-scans starts <scan <PZ !STARTED <SZ !NONE <S !NONE"),
    ROW(packets_without_scans_are_judged_too,
        "packets starts 3( <blind drain ) faults:0x20 +1000 !LOST >65"),
    /* ---- A blocked rotor, and start packets that stop ---- */
    ROW(packets_without_a_start_for_3_s_are_an_encoder_fault, /* Reported once, and no loss. */
        SCANS STANDS_STILL "faults:2 5000( <PZ:8 +2 ) @SCANNING"),
    ROW(a_rotor_blocked_from_the_start_is_an_encoder_fault,
        "no-scans starts <scan <PZ:8 !STARTED 1495( <PZ:8 +2 ) 5( <PZ:8 ) !FAULTS faults:2"),
    ROW(a_rotor_blocked_in_the_middle_of_a_turn_is_an_encoder_fault,
        SCANS "<SZ <P drain 1495( <PZ:8 +2 ) 5( <PZ:8 ) !FAULTS faults:2"),
    ROW(start_packets_without_a_range_every_now_and_then_are_no_encoder_fault,
        SCANS "3( <junk <junk <SZ drain 1450( <PZ:8 +2 ) ) faults:0"),
    ROW(a_rotor_that_turns_again_clears_the_fault_after_two_turns, /* The blocked one is partial. */
        SCANS STANDS_STILL "2( <plain drain ) <plain !FAULTS faults:0"),
    ROW(a_blocked_turn_does_not_count_as_a_turn_without_a_range,
        SCANS STANDS_STILL "2( <blind drain ) faults:2 <blind drain faults:0x20"),
    ROW(a_blocked_rotor_with_start_packets_is_what_ct_information_says,
        SCANS "3( <blind-ct:2 drain ) faults:2"),
    ROW(a_blocked_rotor_with_start_packets_and_no_ct_information_is_a_data_fault,
        SCANS "30( <blind drain ) faults:0x20"),
    ROW(a_blocked_rotor_keeps_the_faults_reported_before,
        SCANS "3( <ct:8 drain ) <crc " STANDS_STILL "faults:0x0A"),
    ROW(three_seconds_of_ranges_without_a_start_packet_are_a_fault_and_three_more_a_loss,
        "scans <ranges:11999 faults:0 <ranges:1 faults:0x02 <ranges:11960 @SCANNING <ranges:40 "
        "@RECOVERING >65"),
    ROW(without_start_packets_100_of_300_packets_with_a_range_are_a_loss_and_99_are_not,
        "scans <blinds:12000 <ranges:3960 <blinds:8040 @SCANNING <ranges:4000 <blinds:8000 "
        "@RECOVERING >65"),
    ROW(samples_without_a_range_and_without_a_start_packet_are_no_loss, /* The rotor is blocked. */
        "scans <blinds:60000 faults:0x02 @SCANNING"),
    /* ---- The frequency while it scans ---- */
    ROW(three_seconds_of_another_frequency_are_a_fault_and_another_try,
        "scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 #0 +50 >0D <600 +50 >0B <700 "
        "stop >65 !FAILED +50 !STOPPED faults:0x40"),
    ROW(five_percent_off_is_no_fault_and_more_is,
        "scans-at-10 turns:60:95 / scans-at-10 turns:60:105 / off scans-at-10 turns:26:94 <turn:94 "
        "!SCAN faults:0 <turn:94 !FAULTS !SCAN faults:0x40"),
    ROW(two_slow_turns_are_no_fault_and_three_are,
        "off scans-at-10 turns:1:6 <turn:6 !FAULTS !SCAN"),
    ROW(a_right_turn_ends_the_fault, "off scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN <turn:100 "
                                     "!FAULTS !SCAN faults:0 turns:17:60 <turn:60 !FAULTS !SCAN"),
    ROW(the_frequencys_fault_stands_beside_others,
        "off no-scans wish:700 idle start >0D <700 !FREQUENCY >60 <scan <S !STARTED 40( <ct:8 "
        "drain ) faults:0x48"),
    ROW(each_wish_is_tried_twice, "scans-at-10 set:900 turns:3:100 <turn:100 !SCAN !PAUSED >65 +50 "
                                  ">0D <900 !FREQUENCY >60 <scan <S !STARTED turns:16:60 <turn:60 "
                                  "!FAULTS !SCAN !PAUSED >65 +50 >0D <900 !FREQUENCY >60"),
    ROW(without_recovery_another_frequency_is_only_a_fault,
        "off scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN turns:300:60"),
    ROW(a_frequency_that_the_lidar_has_and_does_not_keep_is_set_once_more_only,
        "scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 +50 >0D <1000 !FREQUENCY >60 "
        "<scan <S !STARTED turns:300:60"),
    ROW(a_lidar_that_does_not_answer_is_tried_less_and_less_often, /* 3, 6, 12, 24, 42.5 s. */
        "wish:1000 idle start >0D no-answer turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 +50 >0D "
        "no-answer turns:34:60 again turns:70:60 again turns:142:60 again turns:253:60 again "
        "turns:253:60 again"),
    ROW(a_fault_ends_also_while_it_is_unknown_what_is_set,
        "wish:1000 idle start >0D no-answer turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 +50 >0D "
        "no-answer turns:28:100 <turn:100 !FAULTS !SCAN faults:0"),
    ROW(another_wish_is_tried_as_often_as_the_first,
        "wish:1000 idle start >0D no-answer turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65 +50 >0D "
        "no-answer set:900 !FAULTS turns:3:60 <turn:60 !SCAN !PAUSED >65 +50 >0D no-answer "
        "turns:16:60 <turn:60 !FAULTS !SCAN !PAUSED >65"),
    ROW(a_frequency_of_7_68_hz_is_known, /* 0x300. */
        "no-scans wish:770 idle start >0D <768 !FREQUENCY >60 <scan <S !STARTED turns:60:77"),
    ROW(what_is_not_known_to_be_set_is_asked_again_although_it_turns_well,
        "wish:610 attempts:1 idle start >0D <600 +50 >09 3( +2000 >0D <600 +50 >09 ) +2000 >65 +50 "
        ">60 <scan <S !STARTED !FAILED #0 turns:16:60 <turn:60 !SCAN !PAUSED >65 +50 >0D <610 "
        "!FREQUENCY >60 <scan <S !STARTED"),
    ROW(a_unit_that_never_answers_is_asked_again_once,
        "wish:1000 idle start 30( >0D +250 ) >65 +50 >60 <S !STARTED !FAILED ?TIMEOUT turns:28:100 "
        "<turn:100 !SCAN !PAUSED >65 +50 30( >0D +250 ) >65 +50 >60 <S !STARTED !FAILED "
        "turns:300:100"),
    ROW(a_frequency_that_is_not_reported_is_no_fault, "scans-at-10 turns:60:0"),
    ROW(without_a_wish_any_frequency_is_right, "scans turns:60:90"),
    ROW(another_wish_clears_the_fault,
        "off scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN set:600 !FAULTS faults:0"),
    ROW(a_loss_clears_the_fault,
        "off scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN +1000 !FAULTS !LOST faults:0"),
    ROW(the_same_wish_does_not_clear_it,
        "off scans-at-10 turns:16:60 <turn:60 !FAULTS !SCAN set:1000 faults:0x40"),
};

void test_tales(void)
{
    tale_phrases = phrases;
    run_rows(tales, tale_tell_row);
}
