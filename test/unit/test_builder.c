/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Scans: which packets form one revolution, and its quality (sections 6 and 9). The revolutions
 * here have few packets of few samples: within a packet, samples may be any angle apart. */

#include "receiver.h"
#include "rows.h"
#include "stream.h"

#include "tmini/parts/tmini_builder.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define DEGREE 64u
#define ROOM 40u

static uint8_t memory[512];
static uint8_t bytes[300];
static stream_t stream;
static receiver_t receiver;
static tmini_point_t points[ROOM + 1];
static tmini_builder_t builder;
static const tmini_scan_t *const scan = &builder.scan;
static uint32_t now_ms;
static unsigned strays; /* Stray bytes before the next packet. */

static void begin_with(size_t capacity, unsigned filter)
{
    memset(points, 0xEE, sizeof points);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&builder, points, capacity, filter));
    TEST_ASSERT_EQUAL_PTR(points, scan->points);
}

void setUp(void)
{
    stream = (stream_t){bytes, 0, sizeof bytes};
    receiver_open(&receiver, memory, 512, 0);
    now_ms = 5000;
    strays = 0;
    begin_with(ROOM, TMINI_FILTER_NONE);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, points[ROOM].angle_q6);
}

/* A packet arrives and is opened. */
static void receive(uint8_t ct, uint8_t count, uint32_t first_q6, uint32_t last_q6)
{
    stream.size = 0;
    for (; strays > 0; strays--) {
        stream_add_byte(&stream, 0x11);
    }
    (void)stream_add_packet(&stream, ct, count, (uint16_t)(first_q6 % 23040u),
                            (uint16_t)(last_q6 % 23040u));
    receiver_feed(&receiver, bytes, stream.size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
}

/* The same, and adds the packet, unless it closes the current scan: then returns true. */
static bool arrive(uint8_t ct, uint8_t count, uint32_t first_q6, uint32_t last_q6)
{
    receive(ct, count, first_q6, last_q6);
    return tmini_builder_add(&builder, &receiver.packet, now_ms);
}

/* Adds the packet, which must close no scan. Also adds a packet that has just closed one. */
static void add(void)
{
    TEST_ASSERT_FALSE(tmini_builder_add(&builder, &receiver.packet, now_ms));
}

/* A start packet, at 6.0 Hz. Returns whether it has closed a scan. */
static bool start(uint32_t at_q6)
{
    const bool closes = arrive(0x79, 1, at_q6, at_q6);
    if (closes) {
        add();
    }
    return closes;
}

/* A point packet of five samples. Returns whether it has closed a scan. */
static bool point(uint32_t first_q6, uint32_t last_q6)
{
    const bool closes = arrive(0x00, 5, first_q6, last_q6);
    if (closes) {
        add();
    }
    return closes;
}

/* A point packet of a quarter turn, one degree from its neighbours. */
static void quarter(uint32_t from_q6)
{
    TEST_ASSERT_FALSE(point(from_q6 + DEGREE, from_q6 + 90 * DEGREE));
}

/* A whole turn without its start packet. */
static void rest_of_turn(uint32_t from_q6)
{
    for (uint32_t turned = 0; turned < 360 * DEGREE; turned += 90 * DEGREE) {
        quarter(from_q6 + turned);
    }
}

/* A turn that begins at 0 degrees. */
static void whole_turn(void)
{
    (void)start(0);
    rest_of_turn(0);
}

/* A start packet comes and closes a scan with these properties. */
static void expect_scan(uint32_t at_q6, uint16_t gaps, bool complete)
{
    TEST_ASSERT_TRUE(arrive(0x7B, 1, at_q6, at_q6));
    TEST_ASSERT_EQUAL_UINT16(gaps, scan->gaps);
    TEST_ASSERT_EQUAL(complete, scan->complete);
}

/* ----------------------------------------------------------------------------------------- init */

static void is_refused(tmini_builder_t *refusing, tmini_point_t *buffer, size_t capacity)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_builder_init(refusing, buffer, capacity, 0));
}

void test_a_buffer_has_room_for_1_to_65535_points(void)
{
    is_refused(NULL, points, ROOM);
    is_refused(&builder, NULL, ROOM);
    is_refused(&builder, points, 0);
    if (SIZE_MAX > 65535u) {
        is_refused(&builder, points, (size_t)65535 + 1);
        is_refused(&builder, points, SIZE_MAX);
    }
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&builder, points, 1, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&builder, points, 65535, 0));
}

void test_only_defined_filters_are_taken(void)
{
    for (unsigned filter = 0; filter < 256; filter++) {
        const bool is_defined = filter == TMINI_FILTER_NONE || filter == TMINI_FILTER_SPECULAR ||
                                filter == TMINI_FILTER_AMBIENT || filter == TMINI_FILTER_BOTH;
        TEST_ASSERT_EQUAL_INT(is_defined ? TMINI_OK : TMINI_ERROR_ARGUMENT,
                              tmini_builder_init(&builder, points, ROOM, filter));
    }
}

/* ---------------------------------------------------------------------------------- revolutions */

void test_counts_stop_at_65535(void)
{
    begin_with(2, TMINI_FILTER_NONE);
    (void)start(0);
    builder.scan.gaps = 65534;
    builder.scan.packets = 65534;
    builder.scan.dropped = 65530;
    strays = 1;
    quarter(0); /* Four points do not fit. */
    TEST_ASSERT_EQUAL_UINT16(65535, scan->gaps);
    TEST_ASSERT_EQUAL_UINT16(65535, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(65534, scan->dropped);
    strays = 1;
    quarter(90 * DEGREE);
    TEST_ASSERT_EQUAL_UINT16(65535, scan->gaps);
    TEST_ASSERT_EQUAL_UINT16(65535, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(65535, scan->dropped);
}

/* --------------------------------------------------------------------------- lost start packets */

/* Two revolutions from `from_q6` on, but the start packet of the second is missing: the rest of it
 * is a separate scan. */
static void expect_two_scans_without_start(uint32_t from_q6)
{
    begin_with(ROOM, TMINI_FILTER_NONE);
    (void)start(from_q6);
    rest_of_turn(from_q6);
    TEST_ASSERT_TRUE(arrive(0x00, 5, from_q6 + DEGREE, from_q6 + 90 * DEGREE));
    TEST_ASSERT_EQUAL_UINT16(21, scan->count);
    TEST_ASSERT_EQUAL_UINT16(5, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
    TEST_ASSERT_FALSE(scan->complete);
    add();
    quarter(from_q6 + 90 * DEGREE);
    quarter(from_q6 + 180 * DEGREE);
    quarter(from_q6 + 270 * DEGREE);
    expect_scan(from_q6, 1, false);
    TEST_ASSERT_EQUAL_UINT16(20, scan->count);
    TEST_ASSERT_EQUAL_UINT16(4, scan->packets);
    add();
    rest_of_turn(from_q6);
    expect_scan(from_q6, 0, true);
    add();
}

void test_a_lost_start_packet_never_merges_two_revolutions_wherever_they_start(void)
{
    expect_two_scans_without_start(0);
    for (uint32_t degrees = 4; degrees < 360; degrees += 28) {
        expect_two_scans_without_start(degrees * DEGREE);
        expect_two_scans_without_start(degrees * DEGREE + 1);
    }
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows. Angles are sixty-fourths of a degree, with "d" degrees: 180d+1.
 *
 *     S:0 P:1d,90d    a start packet at this angle, a packet of five samples: it closes no scan.
 *     S!:0 P!:1d,90d  it closes the scan, and is not added yet: add. P40: of 40 samples; S75: of
 *                     this CT, hexadecimal
 *     end:0           a start packet that closes the scan, and reports 6.1 Hz
 *     turn rest:0 quarter:90d     as above; rest: without its start packet
 *     pause:1d,90d pause-S:0      a packet that closes the scan because of a pause, and is added
 *     get:1d,90d overrun      a packet that DMA overwrites before it is added
 *     strays:2 garbage:501    bytes before the next packet; bytes, one after the other
 *     room:8 later:167 bad:3  the buffer; the time passes; 3 checksum errors
 *     new specular    from the beginning; with this filter
 *     @3:640,1021,197,3       angle, distance, intensity and flag of this point of the buffer
 *     count:21 …      see tell_word() */

static void garbage(unsigned count)
{
    static const uint8_t byte = 0x11;
    for (; count > 0; count--) {
        receiver_feed(&receiver, &byte, 1);
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next(&receiver));
    }
}

/* The packet ends the scan because of the pause; no byte is missing. */
static void arrive_after_a_pause(uint8_t ct, uint8_t count, uint32_t first_q6, uint32_t last_q6)
{
    receive(ct, count, first_q6, last_q6);
    receiver.packet.gap = TMINI_GAP_UNKNOWN;
    TEST_ASSERT_TRUE(tmini_builder_add(&builder, &receiver.packet, now_ms));
    TEST_ASSERT_FALSE(scan->complete);
    add();
}

static void overrun(void)
{
    memset(bytes, 0, sizeof bytes);
    receiver_feed(&receiver, bytes, 260);
    TEST_ASSERT_FALSE(tmini_frame_intact(tmini_parser_frame(&receiver.parser)));
}

/* "S!:0" or "P40:1d,90d". */
static void tell_packet(const char *word, bool is_start)
{
    const char *const at = strchr(word, ':');
    const unsigned long given = strtoul(word + 1, NULL, is_start ? 16 : 10);
    char *rest;
    const uint32_t first_q6 = (uint32_t)row_angle(at + 1, &rest);
    const uint32_t last_q6 = *rest == ',' ? (uint32_t)row_angle(rest + 1, &rest) : first_q6;
    const uint8_t ct = (uint8_t)(is_start ? (given > 0 ? given : 0x79) : 0);
    const uint8_t count = (uint8_t)(is_start ? 1 : given > 0 ? given : 5);
    TEST_ASSERT_EQUAL_MESSAGE(at[-1] == '!', arrive(ct, count, first_q6, last_q6), word);
}

/* What the word leaves out is not compared. */
static void expect_point(const char *word)
{
    char *rest;
    const tmini_point_t *const point = &points[strtoul(word + 1, &rest, 10)];
    const uint16_t got[] = {point->angle_q6, point->distance_mm, point->intensity, point->flag};
    for (unsigned i = 0; rest[0] != '\0'; i++) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(strtoul(rest + 1, &rest, 0), got[i], word);
    }
}

static void tell_word(char *word)
{
    const row_number_t numbers[] = {
        {"count", scan->count},       {"packets", scan->packets},
        {"gaps", scan->gaps},         {"complete", scan->complete},
        {"dropped", scan->dropped},   {"errors", scan->checksum_errors},
        {"chz", scan->frequency_chz}, {"start-ms", scan->start_ms},
        {"end-ms", scan->end_ms},     {"late", builder.late_scans},
    };
    char *rest;
    const uint32_t number = (uint32_t)row_angle(row_text(word), &rest);
    if (word[0] == '@') {
        expect_point(word);
    } else if (row_is(word, "new")) {
        setUp();
    } else if (row_is(word, "dma")) {
        receiver_open_dma(&receiver, memory, 512, 0);
    } else if (row_is(word, "add")) {
        add();
    } else if (row_is(word, "discard")) {
        tmini_builder_discard(&builder);
    } else if (row_is(word, "refute")) {
        tmini_builder_refute(&builder);
    } else if (row_is(word, "overrun")) {
        overrun();
    } else if (row_is(word, "turn")) {
        whole_turn();
    } else if (row_is(word, "rest")) {
        rest_of_turn(number);
    } else if (row_is(word, "quarter")) {
        quarter(number);
    } else if (row_is(word, "end")) {
        TEST_ASSERT_TRUE(arrive(0x7B, 1, number, number));
    } else if (row_is(word, "get")) {
        receive(0x00, 5, number, (uint32_t)row_angle(rest + 1, &rest));
    } else if (row_is(word, "pause")) {
        arrive_after_a_pause(0x00, 5, number, (uint32_t)row_angle(rest + 1, &rest));
    } else if (row_is(word, "pause-S")) {
        arrive_after_a_pause(0x79, 1, number, number);
    } else if (row_is(word, "strays")) {
        strays = number;
    } else if (row_is(word, "garbage")) {
        garbage(number);
    } else if (row_is(word, "room")) {
        begin_with(number, TMINI_FILTER_NONE);
    } else if (row_is(word, "specular")) {
        begin_with(ROOM, TMINI_FILTER_SPECULAR);
    } else if (row_is(word, "later")) {
        now_ms += (uint32_t)strtol(row_text(word), NULL, 10);
    } else if (row_is(word, "bad")) {
        receiver.parser.counters.checksum_errors += number;
    } else if (!row_expects(word, numbers)) {
        tell_packet(word, word[0] == 'S');
    }
}

#define COMPLETE "gaps:0 complete:1 "
#define LACKS "S:256 P:300,10000 P:10100,20000 P:20100,23030 "
#define REST_FROM_116 "quarter:206d quarter:296d quarter:386d "
#define LOSES_START "dma turn end:0 " COMPLETE "overrun add "

static const row_t rows[] IN_FLASH = {
    /* ---- Revolutions ---- */
    ROW(points_are_in_order_of_arrival,
        "S:3 P:7,47 P:90d,91d count:11 @0:3,1000 @1:7 @2:17 @4:37,1021,197,3 @5:47 @6:5760 "
        "@10:5824,1028,196"),
    ROW(filtered_points_keep_their_place,
        "specular S:0 quarter:0 count:6 @2:1488,1007 @3:2912,0,198,2 @4:4336,1021"),
    ROW(what_precedes_the_first_start_packet_is_no_scan, "quarter:180d quarter:270d S:0 count:1"),
    ROW(a_scan_goes_from_a_start_packet_to_the_next, /* Which reports its frequency. */
        "turn later:167 end:0 " COMPLETE
        "count:21 packets:5 dropped:0 errors:0 start-ms:5000 end-ms:5167 chz:610"),
    ROW(a_scan_does_not_end_before_it_began, /* The estimated times of bytes may step back. */
        "turn later:-1 end:0 " COMPLETE "start-ms:5000 end-ms:5000 new turn later:1 end:0 "
        "end-ms:5001"),
    ROW(a_scan_stays_as_it_is_until_the_packet_that_closed_it_is_added,
        "turn end:17 " COMPLETE
        "@0:0 later:167 add @0:17 count:1 packets:1 start-ms:5167 complete:0"),
    ROW(a_scan_is_closed_once, "S:0 end:0 gaps:0 complete:0 add"),
    ROW(scans_follow_one_another, "S:0 3( rest:0 end:0 " COMPLETE "add )"),
    ROW(the_frequency_has_steps_of_a_tenth_of_a_hertz, /* 0x75 is from a real unit: 5.8 Hz. */
        "S:0 S75!:0 chz:580 add SFF!:0 chz:1270"),
    ROW(a_discarded_scan_is_not_continued, /* Where turns begin is also forgotten. */
        "S:0 quarter:0 discard quarter:90d S:0 count:1"),
    /* ---- A small buffer ---- */
    ROW(points_that_do_not_fit_are_counted_and_not_written,
        "room:8 turn @8:0xEEEE end:0 gaps:0 complete:0 count:8 dropped:13 packets:5"),
    ROW(a_buffer_that_just_fits_makes_a_complete_scan,
        "room:21 turn end:0 " COMPLETE
        "room:20 add rest:0 end:0 gaps:0 complete:0 count:20 dropped:1"),
    ROW(the_next_scan_has_the_whole_buffer_again,
        "room:8 turn end:0 gaps:0 complete:0 add quarter:0 count:6 dropped:0"),
    /* ---- Quality ---- */
    ROW(one_byte_before_a_start_packet_is_last_crc_and_no_gap,
        "turn strays:1 end:0 " COMPLETE "add rest:0 end:0 " COMPLETE),
    ROW(two_bytes_or_257_before_a_start_packet_are_a_gap,
        "turn strays:2 end:0 gaps:1 complete:0 new turn strays:257 end:0 gaps:1 complete:0"),
    ROW(a_gap_before_a_scan_is_not_its_own, "strays:9 turn end:0 " COMPLETE),
    ROW(a_byte_before_a_point_packet_is_a_gap, "S:0 quarter:0 strays:1 quarter:90d quarter:180d "
                                               "strays:1 quarter:270d end:0 gaps:2 complete:0"),
    ROW(more_than_500_skipped_bytes_end_a_scan, /* A turn at 12 Hz has about 1100 bytes. */
        "S:0 quarter:0 garbage:500 P:90d,179d garbage:501 P!:180d,269d gaps:2 complete:0"),
    ROW(a_jump_of_more_than_4_degrees_is_a_gap,
        "S:0 P:256,1000 gaps:0 P:1256,2000 gaps:0 P:2257,3000 gaps:1 P:170d+3000,170d+3100 gaps:2"),
    ROW(a_jump_of_more_than_half_a_turn_ends_the_scan,
        "S:0 P:64,640 P:180d+640,180d+700 new S:0 P:64,640 P!:180d+641,180d+700"),
    ROW(a_turn_that_lacks_more_than_4_degrees_is_incomplete,
        LACKS "S!:0 " COMPLETE "new " LACKS "S!:23039 gaps:0 complete:0"),
    ROW(a_jump_at_the_end_of_a_turn_is_a_gap,
        "S:0 quarter:0 quarter:90d quarter:180d end:0 gaps:1 complete:0"),
    ROW(a_step_back_by_less_than_4_degrees_is_jitter, /* Exactly 4 count as 356 forwards. */
        "S:116d P:115d,200d P:196d+1,270d gaps:0 P:266d+1,300d gaps:0 P!:296d,302d add gaps:1"),
    ROW(a_step_back_across_0_by_4_degrees_is_no_jitter, "S:2d P:358d+1,0 new S:2d P!:358d,0"),
    ROW(a_packet_of_two_samples_goes_from_the_first_angle_to_the_last,
        "S:0 P2:1d,180d P2:181d,360d end:0 " COMPLETE),
    ROW(the_last_angle_of_a_lone_sample_does_not_count, /* Section 9.6: LSA before FSA. */
        "S:0 quarter:0 P1:91d,50d quarter:91d quarter:181d quarter:270d end:0 " COMPLETE),
    ROW(checksum_errors_are_counted_while_the_scan_is_received, /* The lower 16 bits overflow. */
        "bad:65530 turn bad:3 S!:0 errors:3 add bad:263 S!:0 errors:263 add S!:0 errors:0"),
    ROW(a_scan_that_is_refuted_is_not_complete, "turn refute end:0 gaps:1 complete:0"),
    ROW(a_part_of_a_circle_is_not_complete, "S:42d quarter:42d end:133d gaps:0 complete:0"),
    ROW(a_circle_is_complete_to_within_four_degrees, /* Five less; 4 1/64 more. */
        "turn end:4d " COMPLETE "add rest:4d end:1d " COMPLETE
        "new S:0 quarter:0 quarter:90d quarter:180d P:271d,353d end:355d gaps:0 complete:0 new "
        "turn P:360d,360d+16 end:364d+1 gaps:0 complete:0"),
    ROW(half_a_turn_missing_by_its_angle_ends_a_scan, /* The last sample is at 90 degrees. */
        "S:0 quarter:0 P:270d,280d new S:0 quarter:0 P!:270d+1,280d"),
    ROW(a_stream_that_steps_backwards_ends_a_scan, "S:10d P1:8d,8d P1:6d,6d P1!:5d,5d complete:0"),
    /* ---- Lost start packets ---- */
    ROW(packets_lost_around_a_start_do_not_merge_revolutions, /* Five of them. */
        "S:0 quarter:0 quarter:90d P!:91d,180d count:11 complete:0 add S!:0 new S:116d "
        "quarter:116d quarter:206d P!:207d,296d count:11 complete:0 add S!:116d"),
    ROW(a_scan_without_its_start_packet_ends_where_the_next_start_packet_is_missing,
        "S:116d rest:116d P!:156d,206d count:21 add " REST_FROM_116
        "2( P!:156d,206d count:20 add " REST_FROM_116 ") end:116d gaps:1 complete:0 count:20"),
    ROW(a_last_packet_alone_is_a_scan_of_its_own, /* It does not belong to the next turn. */
        "S:0 quarter:0 P2!:358d,359d add P!:1d,90d add count:5 quarter:90d count:10"),
    ROW(a_packet_across_the_end_of_a_turn_is_a_scan_of_its_own, /* It fits in no revolution. */
        "S:0 2( garbage:501 P!:346d,14d add P!:11d,90d add count:5 )"),
    ROW(the_widest_packet_at_the_end_of_a_turn_is_a_scan_of_its_own,
        "S:0 garbage:501 P!:359d,354d add P!:355d,356d add count:5"),
    ROW(each_packet_after_a_gap_of_unknown_size_is_a_scan_of_its_own,
        "S:0 garbage:501 P!:1d,90d add count:5 garbage:501 P!:91d,180d add count:5 garbage:501 "
        "P!:181d,270d add count:5"),
    ROW(a_partial_scan_ends_where_its_turn_ends, "S:0 P!:299d,340d add P!:341d,362d"),
    ROW(a_scan_whose_end_is_missing_has_the_frequency_reported_last,
        "S7B:0 rest:0 P!:1d,90d chz:610 add chz:610 end:0 gaps:2 complete:0 chz:610"),
    /* Measuring 40 samples took 39 * 250 us; their 39 * 3 bytes more took 39 * 130 us. */
    ROW(a_scan_without_its_start_packet_begins_when_its_first_point_was_measured,
        "S:0 garbage:501 P40!:90d,112d add start-ms:4986"),
    ROW(a_scan_without_its_start_packet_counts_its_first_packet_as_swept,
        "S:0 garbage:501 P!:91d,180d add quarter:180d quarter:270d P!:1d,90d"),
    /* The last sample is slightly before the next start packet, whose angle jitters. */
    ROW(a_revolution_may_take_a_quarter_of_a_degree_more_than_a_circle_and_no_more,
        "turn P:1,16 P!:17,17 new turn P!:1,17"),
    ROW(jitter_backwards_does_not_count_as_a_turn, /* Two degrees forwards, two back. */
        "S:0 6( P:10d,12d ) P:13d,350d P:351d,360d+10 P!:11,140"),
    ROW(jitter_backwards_across_0_does_not_count_as_a_turn,
        "S:5 P:10,23030 P:23035,40 P:30,90d gaps:0"),
    ROW(a_start_packet_a_little_before_a_full_turn_closes_the_scan,
        "S:117d rest:117d end:115d " COMPLETE),
    /* ---- Time ---- */
    /* If a turn is missing without a visible gap, the scan takes two turns. */
    ROW(a_scan_that_took_more_than_one_and_a_half_turns_is_not_complete, /* 6.0 Hz, 12.0 Hz. */
        "turn later:250 S79!:0 " COMPLETE "late:0 new turn later:251 S79!:0 gaps:1 complete:0 "
        "late:1 new turn later:125 SF1!:0 " COMPLETE "new turn later:126 SF1!:0 complete:0"),
    ROW(one_and_a_half_turns_are_compared_to_a_millisecond, /* 12.3 Hz: 121.95 ms; 0.1 Hz. */
        "turn later:121 SF7!:0 " COMPLETE "new turn later:122 SF7!:0 complete:0 new turn "
        "later:15000 S3!:0 " COMPLETE "new turn later:15001 S3!:0 complete:0"),
    ROW(a_turn_of_an_unknown_frequency_may_take_any_time, "turn later:2147483647 S1!:0 " COMPLETE),
    ROW(a_turn_of_49_days_is_too_long, /* 3381803 times 1270 is 142,514 modulo 2^32. */
        "turn later:2147483647 S79!:0 gaps:1 complete:0 new turn later:3381803 SFF!:0 complete:0"),
    ROW(scans_that_only_time_has_ended_are_counted_as_late, /* A stray byte may be LastCRC. */
        "S:0 quarter:0 pause:91d,180d late:1 quarter:180d quarter:270d strays:1 pause-S:0 late:2"),
    ROW(scans_that_bytes_or_angles_also_end_are_not_counted_as_late,
        "S:0 garbage:501 P!:1d,90d add strays:1 pause:91d,180d pause:185d,190d strays:2 "
        "pause-S:191d late:0"),
    ROW(a_jump_of_4_degrees_is_not_what_ends_a_scan,
        "S:0 quarter:0 pause:94d,180d late:1 pause:184d+1,190d late:1"),
    /* ---- DMA: after an overwritten packet its turn is unknown ---- */
    ROW(a_packet_that_dma_has_overwritten_is_a_gap_and_no_point,
        "dma S:0 quarter:0 get:91d,180d overrun add count:6 packets:2 gaps:1 dropped:0 "
        "P!:181d,270d count:6 gaps:2 complete:0"),
    ROW(a_packet_after_the_first_that_dma_has_overwritten_leaves_the_scan_open,
        "dma S:0 get:1d,90d overrun add P!:91d,180d count:1 gaps:2"),
    ROW(after_a_start_packet_that_dma_has_overwritten_a_scan_has_a_gap,
        LOSES_START "quarter:0 count:5 packets:1 gaps:1"),
    ROW(a_scan_of_no_packet_is_not_delivered, LOSES_START "S:0 count:1 gaps:0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}
