/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* On Arduino's AVR the work of a poll is less than the largest packet costs: 44 and its 250 bytes,
 * of 256. Each poll goes on even so (tale.h). */

#include "tale.h"

/* A packet of 80 samples without a range. */
#define LARGEST "<x:AA55005001000100AA05 <zeros:240 "

static const row_t tales[] IN_FLASH = {
    ROW(the_largest_packet_that_nobody_asked_for_is_no_work_for_ever,
        "idle " LARGEST "!MORE packets:1 !NONE"),
    ROW(what_follows_the_largest_packet_is_found_when_that_has_ended_a_scan, /* By its angle. */
        "scans !NONE " LARGEST "!SCAN !NONE <P !SCAN !NONE packets:3"),
};

void test_tales(void)
{
    run_rows(tales, tale_tell_row);
}
