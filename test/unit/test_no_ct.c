/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* With TMINI_NO_CT, units with CT information are treated like units without it. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "unity.h"

void setUp(void)
{
    rig_open();
    rig_go_scanning();
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

void test_nothing_is_known_of_a_unit_that_reports_itself(void)
{
    tmini_ct_info_t info;
    for (unsigned i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_HEX(0, rig_turn_events(TMINI_FAULT_SENSOR));
    }
    tmini_ct_info(&rig.lidar, &info);
    TEST_ASSERT_EQUAL_HEX16(0, info.known);
    TEST_ASSERT_EQUAL_UINT8(0, info.user_major);
    TEST_ASSERT_EQUAL_HEX8(0, tmini_faults(&rig.lidar));
}

void test_turns_without_any_range_are_a_data_fault(void)
{
    rig_plain_turns(3, 0);
    TEST_ASSERT_EQUAL_HEX8(TMINI_FAULT_DATA, tmini_faults(&rig.lidar));
}

void test_last_crc_is_no_gap(void)
{
    rig_feed_turn(0, 1000);
    rig_feed_turn(0, 1000);
    TEST_ASSERT_EQUAL_HEX(BIT(TMINI_EVENT_SCAN), rig_drain());
    TEST_ASSERT_EQUAL_UINT16(0, tmini_scan(&rig.lidar)->gaps);
}

void test_every_function_of_ct_information_is_there(void)
{
    tmini_ct_t ct;
    tmini_ct_info_t info;
    tmini_ct_init(&ct);
    tmini_ct_discard(&ct);
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, tmini_ct_add(&ct, tmini_packet(&rig.lidar), true));
    TEST_ASSERT_EQUAL_HEX(TMINI_FAULTS_UNKNOWN, tmini_ct_faults(&ct));
    tmini_ct_read(&ct, &info);
    TEST_ASSERT_EQUAL_HEX16(0, info.known);
    /* The last step of the CRC's check value. */
    TEST_ASSERT_EQUAL_HEX8(0xA1, tmini_ct_crc8(0x07, '9'));
}
