/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* With TMINI_NO_CT, units with CT information are treated like units without it (tale.h). */

#include "tale.h"

static const row_t tales[] IN_FLASH = {
    ROW(nothing_is_known_of_a_unit_that_reports_itself,
        "no-scans scans 4( <ct:1 !NONE ) known:0 user:0 faults:0"),
    ROW(turns_without_any_range_are_a_data_fault, "scans 3( <blind drain ) faults:0x20"),
    ROW(last_crc_is_no_gap, "starts <scan <P !STARTED 2( <ct:0 back:160 ) !SCAN gaps:0"),
};

void test_tales(void)
{
    run_rows(tales, tale_tell_row);
}

void test_every_function_of_ct_information_is_there(void)
{
    tmini_ct_t ct;
    tmini_ct_info_t info;
    tmini_ct_init(&ct);
    tmini_ct_discard(&ct);
    TEST_ASSERT_EQUAL_INT(TMINI_CT_UNKNOWN, tmini_ct_add(&ct, NULL, true));
    TEST_ASSERT_EQUAL_HEX(TMINI_FAULTS_UNKNOWN, tmini_ct_faults(&ct));
    tmini_ct_read(&ct, &info);
    TEST_ASSERT_EQUAL_HEX16(0, info.known);
    /* The last step of the CRC's check value. */
    TEST_ASSERT_EQUAL_HEX8(0xA1, tmini_ct_crc8(0x07, '9'));
}
