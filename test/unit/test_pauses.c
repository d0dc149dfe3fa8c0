/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Pauses of the line while the lidar scans make packets doubtful: others may be missing before
 * them. The bytes that end a pause explain part of it, 1 ms per 13.1 bytes. It is too long if the
 * rest is more than half a turn (41 ms at 12 Hz) and more than max_pause_ms. Tales (tale.h), which
 * here know these words as well:
 *
 *     ring            the receive buffer has 1024 bytes
 *     silence:44      44 ms pass, with polls each 30 ms (so the line is watched) and 1 ms before
 *                     the end; the next poll is at the end
 *     doubtful:1:2    two packets come out, of which the first is doubtful
 *     lap             of DMA, which was perhaps missed */

#include "tale.h"

#define RING_SIZE 1024u

static uint8_t memory[RING_SIZE];

static void be_silent(uint32_t ms)
{
    for (ms--; ms > 0; ms -= ms < 30 ? ms : 30) {
        rig.now_ms += ms < 30 ? ms : 30;
        tale_tell("!NONE");
    }
    rig.now_ms += 1;
}

static void expect_doubt(unsigned doubtful, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        tale_tell("!PACKET");
        TEST_ASSERT_EQUAL_UINT16(i < doubtful ? TMINI_GAP_UNKNOWN : 0,
                                 tmini_packet(&rig.lidar)->gap);
    }
    tale_tell("!NONE");
}

static bool tell(char *word)
{
    if (row_is(word, "ring")) {
        rig.config.rx_buffer = memory;
        rig.config.rx_size = RING_SIZE;
    } else if (row_is(word, "silence")) {
        be_silent(row_number(word));
    } else if (row_is(word, "lap")) {
        tmini_feed_gap(&rig.lidar);
    } else if (row_is(word, "doubtful")) {
        expect_doubt(row_number(word), row_number(row_text(word)));
    } else {
        return false;
    }
    return true;
}

#define STREAMS_WITH(limit) \
    "ring packets pause:" limit " starts ~1 <P !STARTED !PACKET !NONE 2( ~1 <P !PACKET !NONE ) "
#define STREAMS STREAMS_WITH("30")
#define TWO "2( <P ) " /* 44 bytes, which explain 3 ms. */
#define THEN_TWO "~2 " TWO
/* With this limit a pause is not too long, and one of a millisecond more is. */
#define LONGEST(limit, ms, more_ms)                                                        \
    STREAMS_WITH(limit)                                                                    \
    "silence:" ms " " TWO "doubtful:0:2 / " STREAMS_WITH(limit) "silence:" more_ms " " TWO \
                                                                "doubtful:2:2"
#define FIRST_12 "<x:AA5500040105C105F85E32A0 "
#define OTHER_10 "<x:0F000000000000000000 "
#define LAPS(times, bytes)                                                      \
    "ring packets dma pause:100 starts 3( <P drain ) ~60 " times "( lap ) " TWO \
    "doubtful:2:2 " TWO "doubtful:1:2 overrun:" bytes

static const row_t tales[] IN_FLASH = {
    /* ---- How long a pause may be ---- */
    ROW(a_longer_pause_makes_only_the_packets_around_it_doubtful, /* Perhaps it was after them. */
        STREAMS "silence:45 " TWO "doubtful:2:2 " THEN_TWO "doubtful:1:2 " THEN_TWO "doubtful:0:2"),
    ROW(a_limit_below_half_a_turn_counts_as_half_a_turn,
        LONGEST("1", "44", "45") " / " LONGEST("41", "44", "45")),
    ROW(a_limit_may_be_higher, LONGEST("42", "45", "46") " / " LONGEST("249", "252", "253")),
    ROW(a_packet_is_doubtful_if_it_begins_among_the_bytes_after_a_pause, /* With its first byte. */
        STREAMS "silence:45 <P <x:AA doubtful:1:1 ~2 <x:5500040105C105F85E32A0 " OTHER_10 TWO
                "doubtful:2:3"),
    ROW(after_a_start_only_the_first_packet_is_doubtful_if_the_line_was_watched, /* 65,536 + 10. */
        "ring packets pause:30 idle clock:65546 start >0D <600 >60 +1000 ~29 <scan " TWO
        "!STARTED doubtful:1:2 / ring packets pause:30 idle clock:65546 start >0D <600 >60 +1000 "
        "~30 <scan " TWO "!STARTED doubtful:2:2"),
    ROW(ignored_packets_end_a_doubt, /* Else it would seem to lie ahead again 2^29 bytes later. */
        "ring packets pause:30 listen start <P !STARTED !PACKET stop !STOPPED ~45 2( <P !NONE ) "
        "start ~2 <P !STARTED doubtful:0:1 / ring packets pause:30 listen start <P !STARTED "
        "!PACKET stop !STOPPED ~45 <P !NONE start ~2 <P !STARTED doubtful:1:1"),
    /* ---- Bytes that a layer below has held back ---- */
    ROW(after_a_pause_between_polls_the_first_packet_after_it_is_doubtful_too,
        STREAMS "~50 " TWO "doubtful:2:2 " THEN_TWO "doubtful:1:2 " THEN_TWO "doubtful:0:2"),
    ROW(unexplained_time_counts_again_with_the_next_pause, /* Each alone, and both together. */
        STREAMS "silence:44 " TWO "doubtful:0:2 ~3 " TWO "doubtful:0:2 " THEN_TWO
                "doubtful:0:2 silence:44 " TWO "doubtful:0:2 ~4 " TWO "doubtful:2:2 " THEN_TWO
                "doubtful:1:2"),
    ROW(a_pause_that_has_been_judged_does_not_count_for_the_next_one, /* 54 bytes explain 4 ms. */
        STREAMS "~50 " FIRST_12 "!NONE silence:45 " OTHER_10 TWO "doubtful:2:3"),
    /* ---- Bytes that the port reports to hold ---- */
    ROW(bytes_that_the_port_holds_explain_a_pause_as_well, /* 544 bytes explain 41 ms. */
        STREAMS "silence:82 " TWO "held:500 doubtful:0:2 silence:83 " TWO "held:500 doubtful:2:2"),
    /* ---- Laps of DMA between two polls: the ring then holds three packets that were delivered
     * before, which do not come again, and two new ones. ---- */
    ROW(after_laps_of_dma_the_bytes_at_hand_and_the_next_packet_are_doubtful,
        LAPS("1", "1024") " / " LAPS("2", "2048") " / " LAPS("4", "4096")),
    ROW(held_bytes_more_than_65535_ahead_explain_nothing, /* The place counts as passed. */
        STREAMS "held:65579 silence:900 " TWO "doubtful:0:2 held:65580 silence:45 " TWO
                "doubtful:2:2"),
};

void test_tales(void)
{
    tale_words = tell;
    run_rows(tales, tale_tell_row);
}
