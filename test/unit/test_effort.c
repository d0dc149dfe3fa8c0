/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The work of one poll is bounded, whatever has arrived: it looks at 1536 bytes and one packet,
 * less the 44 that each frame costs and the poll itself. The ring here is large and full of the
 * bytes that cost most. */

#include "tale.h"
#include "tmini_driver.h"

static uint8_t memory[8192];

/* "large": the receive buffer has 8192 bytes; "forget-info": nothing is to be told of information
 * any more. */
static bool tell(char *word)
{
    if (row_is(word, "large")) {
        rig.config.rx_buffer = memory;
        rig.config.rx_size = sizeof memory;
    } else if (row_is(word, "forget-info")) {
        tmini_withdraw(&rig.lidar, TMINI_EVENT_INFO);
    } else {
        return false;
    }
    return true;
}

static const row_t tales[] IN_FLASH = {
    /* A packet of one sample costs 44 and twice its 13 bytes: 1536 / 70, rounded up. */
    ROW(packets_that_were_not_asked_for_are_bounded,
        "large 200( <P:1 ) !MORE packets:22 drain packets:200"),
    ROW(packets_of_a_scan_are_bounded,
        "large scans <S drain packets:2 200( <P:1 ) !MORE packets:24 drain packets:202"),
    /* A packet of 25 samples costs 44 and twice its 85 bytes, one of 24 six less, the poll 44: six
     * of the first and one of the other cost 1536. */
    ROW(a_poll_ends_when_its_effort_is_exactly_used_up,
        "large 6( <P:25 ) <P:24 <P:1 !MORE packets:7 next:0 !NONE packets:8"),
    /* A packet of 7 samples costs 106, and that of 13 bytes which ended the scan 57: 1541. */
    ROW(the_packet_that_ended_a_scan_counts_when_it_is_decoded_again,
        "large scans <P <S 30( <P:7 ) !SCAN !MORE packets:17 drain"),
    /* Ten packets of 4 samples cost 88 each, and the poll 44: 612 are left for the garbage. */
    ROW(packets_and_the_garbage_after_them_share_a_polls_effort,
        "large 10( <P ) 16( <zeros:256 ) !MORE packets:10 skipped:612 drain"),
    /* The header of a packet of 80 samples, repeated: candidates that are complete and plausible,
     * but wrong. A poll looks at 250 bytes to skip ten, and of the last one it skips only one. */
    ROW(a_poll_that_has_more_to_do_says_so_and_goes_on_with_the_next, /* 376 are complete. */
        "large 400( <x:AA550050010001000000 ) !MORE errors:6 skipped:51 40( !MORE ) drain "
        "errors:376 ~100 drain"),
    ROW(garbage_without_a_candidate_is_bounded_too,
        "large 32( <zeros:256 ) !MORE skipped:1492 drain skipped:8192"),
    /* Each costs 14 and two skipped bytes: 1492 / 16, rounded up. LSN would be 85. The last 8
     * bytes are no whole header. */
    ROW(candidates_without_a_packet_are_bounded_too,
        "large 4096( <x:AA55 ) !MORE skipped:188 drain skipped:8184 errors:0"),
    /* Twelve cost 14 and one skipped byte, 82 as above: 1492. */
    ROW(no_candidate_follows_when_the_effort_is_exactly_used_up,
        "large 12( <x:AA ) 2000( <x:AA55 ) !MORE skipped:176 drain"),
    /* 99 candidates cost 14 and one skipped byte each. For the last one and the garbage after it,
     * 7 of 1492 are left. */
    ROW(garbage_after_candidates_is_bounded_with_them,
        "large 100( <x:AA ) 31( <zeros:256 ) !MORE skipped:106 drain"),
    ROW(a_question_withdrawn_does_not_end_what_a_poll_has_left_over,
        "large 60( <P:1 ) !MORE forget-info drain packets:60"),
};

void test_tales(void)
{
    tale_words = tell;
    run_rows(tales, tale_tell_row);
}
