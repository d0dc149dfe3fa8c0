/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Scans: which packets form one revolution, and its quality (sections 6 and 9). The revolutions
 * here have few packets of few samples: within a packet, samples may be any angle apart. */

#include "receiver.h"
#include "stream.h"

#include "tmini/parts/tmini_builder.h"
#include "unity.h"

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

void test_null_pointers_are_an_argument_error(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_builder_init(NULL, points, ROOM, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_builder_init(&builder, NULL, ROOM, 0));
}

void test_a_capacity_of_0_is_an_argument_error(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_builder_init(&builder, points, 0, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&builder, points, 1, 0));
}

void test_a_capacity_above_65535_is_an_argument_error(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_builder_init(&builder, points, 65535, 0));
    if (SIZE_MAX > 65535u) {
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                              tmini_builder_init(&builder, points, (size_t)65535 + 1, 0));
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                              tmini_builder_init(&builder, points, SIZE_MAX, 0));
    }
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

void test_what_precedes_the_first_start_packet_is_no_scan(void)
{
    quarter(180 * DEGREE);
    quarter(270 * DEGREE);
    TEST_ASSERT_FALSE(start(0));
    TEST_ASSERT_EQUAL_UINT16(1, scan->count);
}

void test_a_scan_goes_from_a_start_packet_to_the_next(void)
{
    TEST_ASSERT_FALSE(start(0));
    rest_of_turn(0);
    now_ms = 5167;
    expect_scan(0, 0, true);
    TEST_ASSERT_EQUAL_PTR(points, scan->points);
    TEST_ASSERT_EQUAL_UINT16(21, scan->count);
    TEST_ASSERT_EQUAL_UINT16(5, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(0, scan->dropped);
    TEST_ASSERT_EQUAL_UINT16(0, scan->checksum_errors);
    TEST_ASSERT_EQUAL_UINT32(5000, scan->start_ms);
    TEST_ASSERT_EQUAL_UINT32(5167, scan->end_ms);
    TEST_ASSERT_EQUAL_UINT16(610, scan->frequency_chz); /* Reported by the next start packet. */
}

/* The estimated arrival time of held-back bytes may go backwards slightly. */
void test_a_scan_does_not_end_before_it_began(void)
{
    whole_turn();
    now_ms = 4999;
    expect_scan(0, 0, true);
    TEST_ASSERT_EQUAL_UINT32(5000, scan->start_ms);
    TEST_ASSERT_EQUAL_UINT32(5000, scan->end_ms);
}

void test_points_are_in_order_of_arrival(void)
{
    (void)start(3);
    (void)point(7, 47);
    (void)point(90 * DEGREE, 91 * DEGREE);
    TEST_ASSERT_EQUAL_UINT16(11, scan->count);
    TEST_ASSERT_EQUAL_UINT16(3, points[0].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(7, points[1].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(17, points[2].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(47, points[5].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(5760, points[6].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(5824, points[10].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(1000, points[0].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(1028, points[10].distance_mm);
    TEST_ASSERT_EQUAL_UINT8(196, points[10].intensity);
    TEST_ASSERT_EQUAL_UINT8(3, points[4].flag);
}

void test_a_scan_stays_as_it_is_until_the_packet_that_closed_it_is_added(void)
{
    whole_turn();
    expect_scan(17, 0, true);
    TEST_ASSERT_EQUAL_UINT16(0, points[0].angle_q6);
    now_ms = 5167;
    add();
    TEST_ASSERT_EQUAL_UINT16(17, points[0].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(1, scan->count);
    TEST_ASSERT_EQUAL_UINT16(1, scan->packets);
    TEST_ASSERT_EQUAL_UINT32(5167, scan->start_ms);
    TEST_ASSERT_FALSE(scan->complete);
}

void test_a_scan_is_closed_once(void)
{
    (void)start(0);
    expect_scan(0, 0, false);
    add();
}

void test_scans_follow_one_another(void)
{
    (void)start(0);
    for (unsigned i = 0; i < 3; i++) {
        rest_of_turn(0);
        expect_scan(0, 0, true);
        add();
    }
}

void test_the_frequency_has_steps_of_a_tenth_of_a_hertz(void)
{
    (void)start(0);
    TEST_ASSERT_TRUE(arrive(0x75, 1, 0, 0)); /* From a real unit: 5.8 Hz. */
    TEST_ASSERT_EQUAL_UINT16(580, scan->frequency_chz);
    add();
    TEST_ASSERT_TRUE(arrive(0xFF, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(1270, scan->frequency_chz);
}

void test_a_discarded_scan_is_not_continued(void)
{
    (void)start(0);
    quarter(0);
    tmini_builder_discard(&builder);
    quarter(90 * DEGREE); /* The angle at which turns begin is also forgotten. */
    TEST_ASSERT_FALSE(start(0));
    TEST_ASSERT_EQUAL_UINT16(1, scan->count);
}

void test_filtered_points_keep_their_place(void)
{
    begin_with(ROOM, TMINI_FILTER_SPECULAR);
    (void)start(0);
    quarter(0);
    TEST_ASSERT_EQUAL_UINT16(6, scan->count);
    TEST_ASSERT_EQUAL_UINT16(1007, points[2].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(0, points[3].distance_mm);
    TEST_ASSERT_EQUAL_UINT8(2, points[3].flag);
    TEST_ASSERT_EQUAL_UINT16(1021, points[4].distance_mm);
}

/* ------------------------------------------------------------------------------- a small buffer */

void test_points_that_do_not_fit_are_counted_and_not_written(void)
{
    begin_with(8, TMINI_FILTER_NONE);
    whole_turn();
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, points[8].angle_q6);
    expect_scan(0, 0, false);
    TEST_ASSERT_EQUAL_UINT16(8, scan->count);
    TEST_ASSERT_EQUAL_UINT16(13, scan->dropped);
    TEST_ASSERT_EQUAL_UINT16(5, scan->packets);
}

void test_a_buffer_that_just_fits_makes_a_complete_scan(void)
{
    begin_with(21, TMINI_FILTER_NONE);
    whole_turn();
    expect_scan(0, 0, true);
    begin_with(20, TMINI_FILTER_NONE);
    add();
    rest_of_turn(0);
    expect_scan(0, 0, false);
    TEST_ASSERT_EQUAL_UINT16(20, scan->count);
    TEST_ASSERT_EQUAL_UINT16(1, scan->dropped);
}

void test_the_next_scan_has_the_whole_buffer_again(void)
{
    begin_with(8, TMINI_FILTER_NONE);
    whole_turn();
    expect_scan(0, 0, false);
    add();
    quarter(0);
    TEST_ASSERT_EQUAL_UINT16(6, scan->count);
    TEST_ASSERT_EQUAL_UINT16(0, scan->dropped);
}

/* ------------------------------------------------------------------------------------- quality */

void test_one_byte_before_a_start_packet_is_last_crc_and_no_gap(void)
{
    whole_turn();
    strays = 1;
    expect_scan(0, 0, true);
    add();
    rest_of_turn(0);
    expect_scan(0, 0, true);
}

void test_two_bytes_before_a_start_packet_are_a_gap(void)
{
    whole_turn();
    strays = 2;
    expect_scan(0, 1, false);
}

void test_257_bytes_before_a_start_packet_are_a_gap(void)
{
    whole_turn();
    strays = 257;
    expect_scan(0, 1, false);
}

void test_a_gap_before_a_scan_is_not_its_own(void)
{
    strays = 9;
    whole_turn();
    expect_scan(0, 0, true);
}

void test_a_byte_before_a_point_packet_is_a_gap(void)
{
    (void)start(0);
    quarter(0);
    strays = 1;
    quarter(90 * DEGREE);
    quarter(180 * DEGREE);
    strays = 1;
    quarter(270 * DEGREE);
    expect_scan(0, 2, false);
}

static void garbage(unsigned count)
{
    static const uint8_t byte = 0x11;
    for (; count > 0; count--) {
        receiver_feed(&receiver, &byte, 1);
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next(&receiver));
    }
}

/* A turn at 12 Hz has about 1100 bytes, so half a turn or more may be missing. */
void test_more_than_500_skipped_bytes_end_a_scan(void)
{
    (void)start(0);
    quarter(0);
    garbage(500);
    TEST_ASSERT_FALSE(arrive(0x00, 5, 90 * DEGREE, 179 * DEGREE));
    garbage(501);
    TEST_ASSERT_TRUE(arrive(0x00, 5, 180 * DEGREE, 269 * DEGREE));
    TEST_ASSERT_EQUAL_UINT16(2, scan->gaps);
    TEST_ASSERT_FALSE(scan->complete);
}

void test_a_jump_of_more_than_4_degrees_is_a_gap(void)
{
    (void)start(0);
    (void)point(256, 1000);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
    (void)point(1256, 2000);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
    (void)point(2257, 3000);
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
    (void)point(3000 + 170 * DEGREE, 3100 + 170 * DEGREE);
    TEST_ASSERT_EQUAL_UINT16(2, scan->gaps);
}

void test_a_jump_of_more_than_half_a_turn_ends_the_scan(void)
{
    (void)start(0);
    (void)point(64, 640);
    TEST_ASSERT_FALSE(point(640 + 180 * DEGREE, 700 + 180 * DEGREE));
    begin_with(ROOM, TMINI_FILTER_NONE);
    (void)start(0);
    (void)point(64, 640);
    TEST_ASSERT_TRUE(point(641 + 180 * DEGREE, 700 + 180 * DEGREE));
}

/* The turn lacks 4 degrees the first time, and 1/64 degree more the second time. */
void test_a_turn_that_lacks_more_than_4_degrees_is_incomplete(void)
{
    static const uint16_t ends[] = {0, 23039};
    for (unsigned i = 0; i < 2; i++) {
        begin_with(ROOM, TMINI_FILTER_NONE);
        (void)start(256);
        (void)point(300, 10000);
        (void)point(10100, 20000);
        (void)point(20100, 23030);
        TEST_ASSERT_TRUE(arrive(0x79, 1, ends[i], ends[i]));
        TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
        TEST_ASSERT_EQUAL(i == 0, scan->complete);
    }
}

void test_a_jump_at_the_end_of_a_turn_is_a_gap(void)
{
    (void)start(0);
    quarter(0);
    quarter(90 * DEGREE);
    quarter(180 * DEGREE);
    expect_scan(0, 1, false);
}

void test_a_step_back_by_less_than_4_degrees_is_jitter(void)
{
    (void)start(116 * DEGREE);
    (void)point(115 * DEGREE, 200 * DEGREE);
    (void)point(196 * DEGREE + 1, 270 * DEGREE);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
    (void)point(266 * DEGREE + 1, 300 * DEGREE);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
    (void)point(296 * DEGREE, 302 * DEGREE); /* Exactly 4 degrees back count as 356 forwards. */
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
}

void test_a_packet_of_two_samples_goes_from_the_first_angle_to_the_last(void)
{
    (void)start(0);
    (void)arrive(0x00, 2, DEGREE, 180 * DEGREE);
    (void)arrive(0x00, 2, 181 * DEGREE, 360 * DEGREE);
    expect_scan(0, 0, true);
}

void test_the_last_angle_of_a_lone_sample_does_not_count(void)
{
    (void)start(0);
    quarter(0);
    (void)arrive(0x00, 1, 91 * DEGREE, 50 * DEGREE); /* Section 9.6: LSA before FSA. */
    quarter(91 * DEGREE);
    quarter(181 * DEGREE);
    quarter(270 * DEGREE);
    expect_scan(0, 0, true);
}

void test_checksum_errors_are_counted_while_the_scan_is_received(void)
{
    receiver.parser.counters.checksum_errors = 65530;
    whole_turn();
    receiver.parser.counters.checksum_errors += 3;
    TEST_ASSERT_TRUE(arrive(0x79, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(3, scan->checksum_errors);
    add();
    receiver.parser.counters.checksum_errors += 263; /* The lower 16 bits overflow. */
    TEST_ASSERT_TRUE(arrive(0x79, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(263, scan->checksum_errors);
    add();
    TEST_ASSERT_TRUE(arrive(0x79, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(0, scan->checksum_errors);
}

void test_a_count_reaches_65535_exactly(void)
{
    (void)start(0);
    builder.scan.gaps = 65533;
    tmini_builder_refute(&builder);
    TEST_ASSERT_EQUAL_UINT16(65534, scan->gaps);
    tmini_builder_refute(&builder);
    TEST_ASSERT_EQUAL_UINT16(65535, scan->gaps);
    tmini_builder_refute(&builder);
    TEST_ASSERT_EQUAL_UINT16(65535, scan->gaps);
}

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

void test_a_lost_start_packet_never_merges_two_revolutions(void)
{
    expect_two_scans_without_start(0);
}

void test_a_lost_start_packet_is_noticed_wherever_revolutions_start(void)
{
    for (uint32_t degrees = 4; degrees < 360; degrees += 28) {
        expect_two_scans_without_start(degrees * DEGREE);
        expect_two_scans_without_start(degrees * DEGREE + 1);
    }
}

void test_packets_lost_around_a_start_do_not_merge_revolutions(void)
{
    for (uint32_t start_at = 0; start_at <= 116; start_at += 116) {
        begin_with(ROOM, TMINI_FILTER_NONE);
        const uint32_t from_q6 = start_at * DEGREE;
        (void)start(from_q6);
        quarter(from_q6);
        quarter(from_q6 + 90 * DEGREE);
        /* Lost: two point packets, the start packet, the next point packet. */
        TEST_ASSERT_TRUE(arrive(0x00, 5, from_q6 + 91 * DEGREE, from_q6 + 180 * DEGREE));
        TEST_ASSERT_EQUAL_UINT16(11, scan->count);
        TEST_ASSERT_FALSE(scan->complete);
        add();
        TEST_ASSERT_TRUE(start(from_q6));
    }
}

/* If several start packets in a row are missing, turns end at the angle of the last one
 * received. */
void test_a_scan_without_its_start_packet_ends_where_the_next_start_packet_is_missing(void)
{
    const uint32_t from_q6 = 116 * DEGREE;
    (void)start(from_q6);
    rest_of_turn(from_q6);
    for (unsigned turn = 0; turn < 3; turn++) {
        TEST_ASSERT_TRUE(arrive(0x00, 5, from_q6 + 40 * DEGREE, from_q6 + 90 * DEGREE));
        TEST_ASSERT_EQUAL_UINT16(turn == 0 ? 21 : 20, scan->count);
        add();
        quarter(from_q6 + 90 * DEGREE);
        quarter(from_q6 + 180 * DEGREE);
        quarter(from_q6 + 270 * DEGREE);
    }
    expect_scan(from_q6, 1, false);
    TEST_ASSERT_EQUAL_UINT16(20, scan->count);
}

/* The last part of a turn does not belong to the next one. */
void test_a_last_packet_alone_is_a_scan_of_its_own(void)
{
    (void)start(0);
    quarter(0);
    TEST_ASSERT_TRUE(arrive(0x00, 2, 358 * DEGREE, 359 * DEGREE));
    add();
    TEST_ASSERT_TRUE(point(DEGREE, 90 * DEGREE));
    TEST_ASSERT_EQUAL_UINT16(5, scan->count);
    quarter(90 * DEGREE);
    TEST_ASSERT_EQUAL_UINT16(10, scan->count);
}

/* From 14 degrees before the beginning of a revolution to 14 after it: the packet fits in no
 * revolution, and no packet continues it. */
void test_a_packet_across_the_end_of_a_turn_is_a_scan_of_its_own(void)
{
    (void)start(0);
    for (unsigned i = 0; i < 2; i++) {
        garbage(501);
        (void)point(346 * DEGREE, 14 * DEGREE);
        TEST_ASSERT_TRUE(point(11 * DEGREE, 90 * DEGREE));
        TEST_ASSERT_EQUAL_UINT16(5, scan->count);
    }
}

/* Its angles span nearly a turn. */
void test_the_widest_packet_at_the_end_of_a_turn_is_a_scan_of_its_own(void)
{
    (void)start(0);
    garbage(501);
    (void)point(359 * DEGREE, 354 * DEGREE);
    TEST_ASSERT_TRUE(point(355 * DEGREE, 356 * DEGREE));
    TEST_ASSERT_EQUAL_UINT16(5, builder.scan.count);
}

void test_each_packet_after_a_gap_of_unknown_size_is_a_scan_of_its_own(void)
{
    (void)start(0);
    for (uint32_t turned = 0; turned < 3; turned++) {
        garbage(501);
        TEST_ASSERT_TRUE(point(turned * 90 * DEGREE + DEGREE, (turned + 1) * 90 * DEGREE));
        TEST_ASSERT_EQUAL_UINT16(5, scan->count);
    }
}

/* The last start packet reported 6.1 Hz. */
void test_a_scan_whose_end_is_missing_has_the_frequency_reported_last(void)
{
    (void)arrive(0x7B, 1, 0, 0);
    rest_of_turn(0);
    TEST_ASSERT_TRUE(arrive(0x00, 5, DEGREE, 90 * DEGREE));
    TEST_ASSERT_EQUAL_UINT16(610, scan->frequency_chz);
    add();
    TEST_ASSERT_EQUAL_UINT16(610, scan->frequency_chz);
    expect_scan(0, 2, false);
    TEST_ASSERT_EQUAL_UINT16(610, scan->frequency_chz);
}

/* The packet comes at 5000 ms. Measuring its 40 samples took 39 * 250 us. It has 39 * 3 bytes more
 * than a start packet; sending these took 39 * 130 us. */
void test_a_scan_without_its_start_packet_begins_when_its_first_point_was_measured(void)
{
    (void)start(0);
    garbage(501);
    TEST_ASSERT_TRUE(arrive(0x00, 40, 90 * DEGREE, 112 * DEGREE));
    add();
    TEST_ASSERT_EQUAL_UINT32(5000 - 14, scan->start_ms);
}

/* The scan ends at the angle at which the lost start packet would have been. */
void test_a_scan_without_its_start_packet_counts_its_first_packet_as_swept(void)
{
    (void)start(0);
    garbage(501);
    TEST_ASSERT_TRUE(point(91 * DEGREE, 180 * DEGREE));
    quarter(180 * DEGREE);
    quarter(270 * DEGREE);
    TEST_ASSERT_TRUE(point(1 * DEGREE, 90 * DEGREE));
}

/* The last sample is slightly before the next start packet, whose angle jitters. A lone sample
 * after a lost start packet is half a degree after that packet's angle. */
void test_a_revolution_may_take_a_quarter_of_a_degree_more_than_a_circle_and_no_more(void)
{
    whole_turn();
    TEST_ASSERT_FALSE(point(1, 16));
    TEST_ASSERT_TRUE(arrive(0x00, 5, 17, 17));
    begin_with(ROOM, TMINI_FILTER_NONE);
    whole_turn();
    TEST_ASSERT_TRUE(arrive(0x00, 5, 1, 17));
}

void test_jitter_backwards_does_not_count_as_a_turn(void)
{
    (void)start(0);
    for (unsigned i = 0; i < 6; i++) {
        TEST_ASSERT_FALSE(point(10 * DEGREE, 12 * DEGREE)); /* Two degrees forwards, two back. */
    }
    TEST_ASSERT_FALSE(point(13 * DEGREE, 350 * DEGREE));
    TEST_ASSERT_FALSE(point(351 * DEGREE, 360 * DEGREE + 10));
    TEST_ASSERT_TRUE(arrive(0x00, 5, 11, 140));
}

void test_a_start_packet_a_little_before_a_full_turn_closes_the_scan(void)
{
    (void)start(117 * DEGREE);
    rest_of_turn(117 * DEGREE);
    expect_scan(115 * DEGREE, 0, true);
}

/* ----------------------------------------------------------------------------------------- time */

/* A turn that takes this time; its end reports a frequency in `ct`. */
static void pass_turn_in(uint32_t ms, uint8_t ct)
{
    begin_with(ROOM, TMINI_FILTER_NONE);
    whole_turn();
    now_ms += ms;
    TEST_ASSERT_TRUE(arrive(ct, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(scan->complete ? 0 : 1, scan->gaps);
}

static void a_turn_takes_at_most(uint32_t ms, uint8_t ct)
{
    pass_turn_in(ms, ct);
    TEST_ASSERT_TRUE(scan->complete);
    TEST_ASSERT_EQUAL_UINT32(0, builder.late_scans);
    pass_turn_in(ms + 1, ct);
    TEST_ASSERT_FALSE(scan->complete);
    TEST_ASSERT_EQUAL_UINT32(1, builder.late_scans);
}

/* If a turn is missing without a visible gap, the scan takes two turns instead of one. */
void test_a_scan_that_took_more_than_one_and_a_half_turns_is_not_complete(void)
{
    a_turn_takes_at_most(250, 0x79); /* 6.0 Hz. */
    a_turn_takes_at_most(125, 0xF1); /* 12.0 Hz: 1.5 * 83.3 ms. */
    a_turn_takes_at_most(121, 0xF7); /* 12.3 Hz: 1.5 * 81.3 = 121.95 ms. */
    a_turn_takes_at_most(15000, 0x03);
}

void test_a_turn_of_an_unknown_frequency_may_take_any_time(void)
{
    pass_turn_in(UINT32_MAX / 2, 0x01);
    TEST_ASSERT_TRUE(scan->complete);
}

/* Time times frequency overflows 32 bits. */
void test_a_turn_of_49_days_is_too_long(void)
{
    pass_turn_in(0x7FFFFFFFu, 0x79);
    TEST_ASSERT_FALSE(scan->complete);
    pass_turn_in(3381803, 0xFF); /* Times 1270 it is 142,514 modulo 2^32. */
    TEST_ASSERT_FALSE(scan->complete);
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

void test_scans_that_only_time_has_ended_are_counted_as_late(void)
{
    (void)start(0);
    quarter(0);
    arrive_after_a_pause(0x00, 5, 91 * DEGREE, 180 * DEGREE);
    TEST_ASSERT_EQUAL_UINT32(1, builder.late_scans);
    quarter(180 * DEGREE);
    quarter(270 * DEGREE);
    strays = 1; /* LastCRC. */
    arrive_after_a_pause(0x79, 1, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(2, builder.late_scans);
}

void test_scans_that_bytes_or_angles_also_end_are_not_counted_as_late(void)
{
    (void)start(0);
    garbage(501);
    (void)point(DEGREE, 90 * DEGREE);
    strays = 1;
    arrive_after_a_pause(0x00, 5, 91 * DEGREE, 180 * DEGREE);
    arrive_after_a_pause(0x00, 5, 185 * DEGREE, 190 * DEGREE);
    strays = 2;
    arrive_after_a_pause(0x79, 1, 191 * DEGREE, 191 * DEGREE);
    TEST_ASSERT_EQUAL_UINT32(0, builder.late_scans);
}

void test_a_jump_of_4_degrees_is_not_what_ends_a_scan(void)
{
    (void)start(0);
    quarter(0);
    arrive_after_a_pause(0x00, 5, 94 * DEGREE, 180 * DEGREE);
    TEST_ASSERT_EQUAL_UINT32(1, builder.late_scans);
    arrive_after_a_pause(0x00, 5, 184 * DEGREE + 1, 190 * DEGREE);
    TEST_ASSERT_EQUAL_UINT32(1, builder.late_scans);
}

/* ------------------------------------------------------------------------------------------ DMA */

static void overrun(void)
{
    memset(bytes, 0, sizeof bytes);
    receiver_feed(&receiver, bytes, 260);
    TEST_ASSERT_FALSE(tmini_frame_intact(tmini_parser_frame(&receiver.parser)));
}

void test_a_packet_that_dma_has_overwritten_is_a_gap_and_no_point(void)
{
    receiver_open_dma(&receiver, memory, 512, 0);
    (void)start(0);
    quarter(0);
    receive(0x00, 5, 91 * DEGREE, 180 * DEGREE);
    overrun();
    add();
    TEST_ASSERT_EQUAL_UINT16(6, scan->count);
    TEST_ASSERT_EQUAL_UINT16(2, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
    TEST_ASSERT_EQUAL_UINT16(0, scan->dropped);
    TEST_ASSERT_TRUE(arrive(0x00, 5, 181 * DEGREE, 270 * DEGREE)); /* Its turn is unknown. */
    TEST_ASSERT_EQUAL_UINT16(6, scan->count);
    TEST_ASSERT_EQUAL_UINT16(2, scan->gaps);
    TEST_ASSERT_FALSE(scan->complete);
}

/* A start packet has come and ended a scan, but DMA overwrites it before it is added. */
static void lose_the_next_start(void)
{
    receiver_open_dma(&receiver, memory, 512, 0);
    whole_turn();
    expect_scan(0, 0, true);
    overrun();
    add();
}

void test_a_packet_after_the_first_that_dma_has_overwritten_leaves_the_scan_open(void)
{
    receiver_open_dma(&receiver, memory, 512, 0);
    (void)start(0);
    receive(0x00, 5, DEGREE, 90 * DEGREE);
    overrun();
    add();
    TEST_ASSERT_TRUE(arrive(0x00, 5, 91 * DEGREE, 180 * DEGREE)); /* Its turn is unknown. */
    TEST_ASSERT_EQUAL_UINT16(1, scan->count);
    TEST_ASSERT_EQUAL_UINT16(2, scan->gaps);
}

void test_after_a_start_packet_that_dma_has_overwritten_a_scan_has_a_gap(void)
{
    lose_the_next_start();
    quarter(0);
    TEST_ASSERT_EQUAL_UINT16(5, scan->count);
    TEST_ASSERT_EQUAL_UINT16(1, scan->packets);
    TEST_ASSERT_EQUAL_UINT16(1, scan->gaps);
}

void test_a_scan_of_no_packet_is_not_delivered(void)
{
    lose_the_next_start();
    TEST_ASSERT_FALSE(start(0));
    TEST_ASSERT_EQUAL_UINT16(1, scan->count);
    TEST_ASSERT_EQUAL_UINT16(0, scan->gaps);
}

/* ------------------------------------------------------------------ scans that do not continue */

void test_a_part_of_a_circle_is_not_complete(void)
{
    (void)start(42 * DEGREE);
    quarter(42 * DEGREE); /* To 132 degrees. */
    expect_scan(133 * DEGREE, 0, false);
}

void test_a_circle_is_complete_to_within_four_degrees(void)
{
    whole_turn();
    expect_scan(4 * DEGREE, 0, true);
    add();
    rest_of_turn(4 * DEGREE);
    expect_scan(DEGREE, 0, true);
    (void)start(0);
    quarter(0);
    quarter(90 * DEGREE);
    quarter(180 * DEGREE);
    TEST_ASSERT_FALSE(point(271 * DEGREE, 353 * DEGREE));
    expect_scan(355 * DEGREE, 0, false); /* Five degrees less than a circle. */
    whole_turn();
    TEST_ASSERT_FALSE(point(360 * DEGREE, 360 * DEGREE + 16));
    expect_scan(364 * DEGREE + 1, 0, false); /* Four degrees and 1/64 more. */
}

void test_half_a_turn_missing_by_its_angle_ends_a_scan(void)
{
    (void)start(0);
    quarter(0); /* Its last sample is at 90 degrees. */
    TEST_ASSERT_FALSE(arrive(0x00, 5, 270 * DEGREE, 280 * DEGREE));
    TEST_ASSERT_TRUE(arrive(0x00, 5, 270 * DEGREE + 1, 280 * DEGREE));
}

void test_a_stream_that_steps_backwards_ends_a_scan(void)
{
    (void)start(10 * DEGREE);
    TEST_ASSERT_FALSE(arrive(0x00, 1, 8 * DEGREE, 8 * DEGREE));
    TEST_ASSERT_FALSE(arrive(0x00, 1, 6 * DEGREE, 6 * DEGREE));
    TEST_ASSERT_TRUE(arrive(0x00, 1, 5 * DEGREE, 5 * DEGREE));
    TEST_ASSERT_FALSE(scan->complete);
}

void test_a_scan_that_is_refuted_is_not_complete(void)
{
    whole_turn();
    tmini_builder_refute(&builder);
    expect_scan(0, 1, false);
}

/* A partial scan begins at 299 degrees. Its first packet ends at 340; the second would go past the
 * turn's end, to 2 degrees, so it ends the scan. */
void test_a_partial_scan_ends_where_its_turn_ends(void)
{
    TEST_ASSERT_FALSE(start(0));
    TEST_ASSERT_TRUE(point(299 * DEGREE, 340 * DEGREE));
    TEST_ASSERT_TRUE(point(341 * DEGREE, 362 * DEGREE));
}
