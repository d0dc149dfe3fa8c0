/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Faults that are derived from packets while the lidar scans. */

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

/* ---- Faults from CT information ---- */

void test_a_fault_seen_in_two_trusted_turns_is_reported(void)
{
    rig_go_scanning();
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_turn_events(TMINI_FAULT_SENSOR));
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_SENSOR, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR)); /* Reported only once. */
}

void test_a_fault_seen_in_one_turn_only_is_not_reported(void)
{
    rig_go_scanning();
    (void)rig_turn_events(0);
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
        TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(0));
    }
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(0));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_a_fault_is_cleared_by_two_trusted_turns_without_it(void)
{
    rig_go_scanning();
    (void)rig_turn_events(TMINI_FAULT_PD);
    (void)rig_turn_events(TMINI_FAULT_PD);
    (void)rig_turn_events(0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_PD, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(0));
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_turn_events(0));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_a_fault_seen_in_one_trusted_turn_and_one_that_is_not_is_not_reported(void)
{
    rig_go_scanning();
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(0)); /* One trusted turn has ended. */
    rig.crc ^= 1u;                                /* LastCRC is wrong. */
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(0));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_a_data_fault_that_ends_in_turns_of_which_a_packet_is_missing_is_reported(void)
{
    unsigned events = 0;

    rig_go_scanning();
    rig_plain_turns(3, 0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
    for (unsigned i = 0; i < 3; i++) {
        rig.crc ^= 1u; /* LastCRC is wrong. */
        events |= rig_turn_events(0);
    }
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), events);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_a_second_fault_is_reported_beside_the_first(void)
{
    rig_go_scanning();
    (void)rig_turn_events(TMINI_FAULT_PD);
    (void)rig_turn_events(TMINI_FAULT_PD);
    (void)rig_turn_events(TMINI_FAULT_PD | TMINI_FAULT_LD);
    (void)rig_turn_events(TMINI_FAULT_PD | TMINI_FAULT_LD);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_turn_events(0));
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_PD | TMINI_FAULT_LD, tmini_faults(&rig.lidar));
}

void test_a_turn_that_is_not_trusted_neither_reports_nor_clears(void)
{
    rig_go_scanning();
    (void)rig_turn_events(0);
    (void)rig_turn_events(0); /* From here on the unit is known to report its health. */
    (void)rig_turn_events(TMINI_FAULT_SENSOR);
    rig.crc ^= 1u; /* LastCRC is wrong. */
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
    rig.crc ^= 1u;
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
    TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR)); /* Only one is trusted so far. */
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_turn_events(0));
}

void test_a_unit_that_reports_its_health_is_believed_even_without_any_range(void)
{
    rig_go_scanning();
    (void)rig_turn_events(0);
    for (unsigned i = 0; i < 4; i++) {
        rig.now_ms += 160;
        rig_feed_turn(0, 0);
        TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_SCAN), rig_drain());
    }
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

/* ---- Faults from distances, on units without CT information ---- */

void test_two_turns_without_any_range_are_a_data_fault(void)
{
    rig_go_scanning();
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(0));
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(0));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_plain_turn_events(0));
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(0));
}

void test_a_data_fault_is_cleared_by_two_turns_with_a_range(void)
{
    rig_go_scanning();
    rig_plain_turns(3, 0);
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(1000));
    TEST_ASSERT_EQUAL_HEX(0, rig_plain_turn_events(1000));
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_plain_turn_events(1000));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_one_valid_range_a_turn_is_no_fault(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 4; i++) {
        rig_feed_start_packet(0);
        rig_feed_point_packet(0);
        rig_feed_packet(0, 1, 1);
        rig_feed_point_packet(0);
        TEST_ASSERT_EQUAL_HEX(0, rig_drain() & BIT(TMINI_EVENT_FAULTS_CHANGED));
    }
}

void test_the_start_packets_own_range_counts(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 4; i++) {
        rig_feed_start_packet(1000);
        rig_feed_point_packet(0);
        TEST_ASSERT_EQUAL_HEX(0, rig_drain() & BIT(TMINI_EVENT_FAULTS_CHANGED));
    }
}

void test_turns_of_which_packets_were_lost_are_no_data_fault(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 4; i++) {
        rig_feed_start_packet(0); /* It has no range. */
        for (unsigned k = 0; k < 20; k++) {
            rig_feed_byte(0x00); /* The packets with ranges were damaged. */
        }
        TEST_ASSERT_EQUAL_HEX(0, rig_drain() & BIT(TMINI_EVENT_FAULTS_CHANGED));
    }
}

void test_a_turn_of_which_a_point_packet_was_lost_is_no_data_fault(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 4; i++) {
        rig_feed_start_packet(0);
        rig_feed_byte(0x00);
        rig_feed_byte(0x00);
        rig_feed_point_packet(0);
        TEST_ASSERT_EQUAL_HEX(0, rig_drain() & BIT(TMINI_EVENT_FAULTS_CHANGED));
    }
}

void test_one_byte_before_a_start_packet_may_be_last_crc_and_the_turn_is_whole(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 3; i++) {
        (void)rig_plain_turn_events(0);
        rig_feed_byte(0x00);
    }
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
}

void test_a_range_clears_a_data_fault_though_packets_were_lost(void)
{
    rig_go_scanning();
    rig_plain_turns(3, 0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
    for (unsigned i = 0; i < 3; i++) {
        rig_feed_byte(0x00);
        rig_feed_byte(0x00);
        rig_feed_start_packet(1000);
        (void)rig_drain();
    }
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_what_precedes_the_first_start_packet_is_no_turn(void)
{
    rig_go_idle();
    begins_with(GET_FREQUENCY, tmini_start(&rig.lidar));
    answers_and_gets(600, START);
    rig_feed_scan_reply();
    rig_feed_point_packet(0); /* A partial turn. */
    rig_feed_start_packet(0); /* A turn without a range. */
    (void)rig_drain();
    rig_feed_start_packet(1000);
    TEST_ASSERT_EQUAL_HEX(0, rig_drain() & BIT(TMINI_EVENT_FAULTS_CHANGED));
}

/* ---- A blocked rotor ---- */

/* Point packets without a range, 4000 samples per second; no event comes. */
static void stands_still_for(uint32_t ms)
{
    for (uint32_t end_ms = rig.now_ms + ms; rig.now_ms != end_ms;) {
        rig_feed_packet(0, 8, 0);
        passes(2);
    }
}

static void is_noticed_after_3_s(void)
{
    stands_still_for(2990);
    for (unsigned i = 0; i < 5; i++) {
        rig_feed_packet(0, 8, 0);
    }
    polls_to(TMINI_EVENT_FAULTS_CHANGED);
}

void test_packets_without_a_start_for_3_s_are_an_encoder_fault(void)
{
    rig_go_scanning();
    rig_feed_start_packet(0);
    (void)rig_drain();
    is_noticed_after_3_s();
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
    stands_still_for(10000); /* Reported once; the lidar is not called lost. */
    is_in(TMINI_STATE_SCANNING);
}

void test_a_rotor_blocked_from_the_start_is_an_encoder_fault(void)
{
    rig_go_spinning_up();
    rig_feed_packet(0, 8, 0);
    polls_to(TMINI_EVENT_STARTED);
    is_noticed_after_3_s();
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
}

void test_a_rotor_blocked_in_the_middle_of_a_turn_is_an_encoder_fault(void)
{
    rig_go_scanning();
    rig_feed_start_packet(0);
    rig_feed_point_packet(1000);
    (void)rig_drain();
    is_noticed_after_3_s();
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
}

void test_start_packets_without_a_range_every_now_and_then_are_no_encoder_fault(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 3; i++) {
        rig_feed_byte(0x00);
        rig_feed_byte(0x00); /* A packet was lost, so it is unknown whether the turn had ranges. */
        rig_feed_start_packet(0);
        (void)rig_drain();
        stands_still_for(2900);
    }
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_a_rotor_that_turns_again_clears_the_fault_after_two_turns(void)
{
    rig_go_scanning();
    rig_feed_start_packet(0);
    (void)rig_drain();
    is_noticed_after_3_s();
    /* The blocked turn ends: it had no range, but was not complete. */
    (void)rig_plain_turn_events(1000);
    (void)rig_plain_turn_events(1000);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_FAULTS_CHANGED), rig_plain_turn_events(1000));
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

/* The blocked turn is not complete, so only the next turn without a range counts as the first. */
void test_a_blocked_turn_does_not_count_as_a_turn_without_a_range(void)
{
    rig_go_scanning();
    rig_feed_start_packet(0);
    (void)rig_drain();
    is_noticed_after_3_s();
    (void)rig_plain_turn_events(0);
    (void)rig_plain_turn_events(0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
    (void)rig_plain_turn_events(0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
}

void test_a_blocked_rotor_with_start_packets_is_what_ct_information_says(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 3; i++) {
        rig.now_ms += 160;
        rig_feed_turn(TMINI_FAULT_ENCODER, 0);
        (void)rig_drain();
    }
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
}

void test_a_blocked_rotor_with_start_packets_and_no_ct_information_is_a_data_fault(void)
{
    rig_go_scanning();
    rig_plain_turns(30, 0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
}

void test_a_blocked_rotor_keeps_the_faults_reported_before(void)
{
    rig_go_scanning();
    for (unsigned i = 0; i < 3; i++) {
        (void)rig_turn_events(TMINI_FAULT_PD);
    }
    rig_feed_byte(rig.crc);
    rig_feed_start_packet(0);
    (void)rig_drain();
    is_noticed_after_3_s();
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_PD | TMINI_FAULT_ENCODER, tmini_faults(&rig.lidar));
}
