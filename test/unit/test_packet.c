/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Packets: header fields, samples in the ring, and samples as points (sections 5 and 9). */

#include "known_packets.h"
#include "receiver.h"
#include "rows.h"
#include "stream.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static uint8_t memory[1024];
static uint8_t bytes[800];
static stream_t stream;
static receiver_t receiver;
static tmini_point_t points[80];
static unsigned filter;

void setUp(void)
{
    stream = (stream_t){bytes, 0, sizeof bytes};
    filter = TMINI_FILTER_NONE;
    receiver_open(&receiver, memory, 1024, 255);
}

/* Reads up to `room` points of the packet; there are `count` of them. */
static void read_points(size_t room, size_t count)
{
    memset(points, 2, sizeof points); /* Flag 2: a filter would change the point. */
    TEST_ASSERT_EQUAL_UINT(count, tmini_packet_points(&receiver.packet, filter, points, room));
    if (count < 80) {
        TEST_ASSERT_EACH_EQUAL_HEX8(2, &points[count], sizeof points[count]);
    }
}

/* Releases the previous packet, feeds this one, opens it and reads its points. */
static void open_packet(const uint8_t *packet, size_t size)
{
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next(&receiver));
    receiver_feed(&receiver, packet, size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
    read_points(80, packet[3] < 80 ? packet[3] : 80);
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows:
 *
 *     start manual    these packets come (known_packets.h); pro-start …: see below
 *     P4:0,2          a packet of 4 samples from this angle to that, each as stream_sample() says
 *     x:64E56F        a packet with these bytes as samples, 100 sixty-fourths of a degree apart
 *     blind:255       a packet of 255 samples without a distance
 *     <112233         these bytes come
 *     specular ambient both   points are read with this filter
 *     @3:640,1021,197,3       angle, distance, intensity and flag of the sample with this index
 *     none:19         there is no sample with this index
 *     count:19 …      see tell_word() */

/* The same of a T-mini Pro at 9.9 Hz (model 150, firmware 1.0), the packets of the tests of the
 * public project tier4/ydlidar_driver: only values were taken. Each sample is flagged (section
 * 9.9), and point packets have CT information. */
static const uint8_t pro_start[] = {0xAA, 0x55, 0xC7, 0x01, 0x01, 0x15, 0x01,
                                    0x15, 0x1B, 0x56, 0x14, 0x62, 0x02};
static const uint8_t pro_points[] = {
    0xAA, 0x55, 0xB0, 0x27, 0xE3, 0x28, 0xF3, 0x39, 0x0E, 0x61, 0x79, 0xB6, 0x05, 0x6F, 0x4E, 0x06,
    0x61, 0x06, 0x06, 0x7A, 0x9A, 0x02, 0x9E, 0x5E, 0x02, 0xA6, 0x0A, 0x02, 0xA7, 0xE6, 0x01, 0xAE,
    0xD6, 0x01, 0xBA, 0xD6, 0x01, 0xB8, 0xD2, 0x01, 0xB2, 0xD6, 0x01, 0xBD, 0xD2, 0x01, 0xDF, 0xDA,
    0x01, 0xE1, 0xDA, 0x01, 0xDF, 0xDA, 0x01, 0xDC, 0xDE, 0x01, 0xDE, 0xDE, 0x01, 0xD8, 0xE2, 0x01,
    0xD4, 0xDE, 0x01, 0xBA, 0xDE, 0x01, 0x84, 0xDF, 0x01, 0x2F, 0xAB, 0x01, 0x17, 0xEE, 0x01, 0x0F,
    0x22, 0x02, 0x0C, 0x7E, 0x02, 0x0A, 0x02, 0x00, 0x0C, 0x9E, 0x02, 0x16, 0xA6, 0x02, 0x21, 0xA2,
    0x02, 0x3A, 0x32, 0x03, 0x55, 0x4E, 0x0A, 0x87, 0x46, 0x0A, 0x85, 0x5A, 0x0A, 0x8A, 0x6E, 0x0A,
    0x84, 0x9A, 0x0A, 0x7E, 0xCE, 0x0A, 0x4E, 0x7E, 0x04, 0x51, 0x6E, 0x03, 0x66, 0xA6, 0x02};
static const uint8_t pro_full[] = {
    0xAA, 0x55, 0x24, 0x28, 0xF5, 0x4C, 0x85, 0x5E, 0x9D, 0x70, 0xCE, 0xE2, 0x07, 0xBC, 0xFA,
    0x07, 0xCC, 0xB6, 0x07, 0xC8, 0xB6, 0x07, 0xC4, 0xBA, 0x07, 0xCB, 0xCA, 0x07, 0xC8, 0xAE,
    0x09, 0xC5, 0x9E, 0x09, 0xC7, 0x9E, 0x09, 0xC2, 0x9E, 0x09, 0xC1, 0x92, 0x09, 0xC0, 0x8A,
    0x09, 0xC1, 0x86, 0x09, 0xBE, 0x86, 0x09, 0xC5, 0x86, 0x09, 0xC3, 0x8A, 0x09, 0xBC, 0x8A,
    0x09, 0xC6, 0x8A, 0x09, 0xC6, 0x8A, 0x09, 0xC2, 0x8E, 0x09, 0xC5, 0x8E, 0x09, 0xC3, 0x92,
    0x09, 0xC4, 0xAA, 0x09, 0xC9, 0xB2, 0x09, 0xC9, 0xBA, 0x09, 0xC5, 0xC2, 0x09, 0xC9, 0xCE,
    0x09, 0xBF, 0xCE, 0x09, 0xBE, 0xCE, 0x09, 0xBA, 0xCE, 0x09, 0xBE, 0xD6, 0x09, 0xBB, 0xD6,
    0x09, 0xBF, 0xE2, 0x09, 0xBB, 0xF2, 0x09, 0xC1, 0x0A, 0x0A, 0xBF, 0x1A, 0x0A, 0xB9, 0x1E,
    0x0A, 0xAA, 0x22, 0x0A, 0x9E, 0x2A, 0x0A, 0xCB, 0x7A, 0x15};

static const struct {
    const char *name;
    const uint8_t *bytes;
    size_t size;
} known[] = {
    {"start", start_packet, sizeof start_packet}, {"manual", manual_packet, sizeof manual_packet},
    {"pro-start", pro_start, sizeof pro_start},   {"pro-points", pro_points, sizeof pro_points},
    {"pro-full", pro_full, sizeof pro_full},
};

static bool open_known(const char *word)
{
    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (row_is(word, known[i].name)) {
            open_packet(known[i].bytes, known[i].size);
            return true;
        }
    }
    return false;
}

/* The samples are in `bytes`. */
static void open_samples(size_t count)
{
    const encode_packet_t packet = {0, (uint8_t)count, 0, (uint16_t)(100 * (count - 1)), NULL};
    encode_packet_header(bytes, &packet);
    encode_seal(bytes);
    open_packet(bytes, 10 + 3 * count);
}

static void open_angles(const char *word)
{
    char *rest;
    const uint8_t count = (uint8_t)strtoul(word + 1, &rest, 10);
    const uint16_t first_q6 = (uint16_t)strtoul(rest + 1, &rest, 10);
    stream.size = 0;
    (void)stream_add_packet(&stream, 0, count, first_q6, (uint16_t)strtoul(rest + 1, NULL, 10));
    open_packet(bytes, stream.size);
}

/* What the word leaves out is not compared. A filter has no effect on points read alone. */
static void expect_point(const char *word)
{
    char *rest;
    const unsigned long index = strtoul(word + 1, &rest, 10);
    tmini_point_t alone[2] = {{0}, {23040, 0, 0, 0}}; /* 23040: the library would make it 0. */
    TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, index, alone));
    TEST_ASSERT_EQUAL_UINT16(23040, alone[1].angle_q6);
    const tmini_point_t point = index < 80 ? points[index] : alone[0];
    const uint16_t got[] = {point.angle_q6, point.distance_mm, point.intensity, point.flag};
    for (unsigned i = 0; rest[0] != '\0'; i++) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(strtoul(rest + 1, &rest, 10), got[i], word);
    }
    alone[0].distance_mm = filter == 0 ? alone[0].distance_mm : point.distance_mm;
    TEST_ASSERT_EQUAL_MEMORY(&point, &alone[0], sizeof point);
}

static void tell_word(char *word)
{
    const tmini_packet_t *const packet = &receiver.packet;
    const row_number_t numbers[] = {
        {"first", packet->first_angle_q6},
        {"last", packet->last_angle_q6},
        {"ct", packet->ct},
        {"count", packet->count},
        {"gap", packet->gap},
        {"skipped", packet->frame != NULL ? packet->frame->last_skipped : 0},
        {"step", packet->step},
        {"is-start", tmini_packet_is_start(packet)},
        {"has-range", packet->frame != NULL && tmini_packet_has_range(packet)},
    };
    tmini_point_t none;
    if (word[0] == '@') {
        expect_point(word);
    } else if (word[0] == 'P') {
        open_angles(word);
    } else if (word[0] == '<') {
        receiver_feed(&receiver, bytes, row_bytes(word + 1, bytes));
    } else if (row_is(word, "x")) {
        open_samples(row_bytes(word + 2, &bytes[10]) / 3);
    } else if (row_is(word, "blind")) {
        memset(&bytes[10], 0, 3 * row_number(word));
        open_samples(row_number(word));
    } else if (row_is(word, "specular")) {
        filter = TMINI_FILTER_SPECULAR;
    } else if (row_is(word, "ambient")) {
        filter = TMINI_FILTER_AMBIENT;
    } else if (row_is(word, "both")) {
        filter = TMINI_FILTER_BOTH;
    } else if (row_is(word, "none")) {
        TEST_ASSERT_FALSE_MESSAGE(tmini_packet_point(packet, row_number(word), &none), word);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(open_known(word) || row_expects(word, numbers), word);
    }
}

static const row_t rows[] IN_FLASH = {
    /* ---- Header ---- */
    ROW(the_manuals_packet_has_its_header_fields, /* 339.15625 and 0.765625 degrees. */
        "manual ct:0x20 count:19 first:21706 last:49 is-start:0"),
    ROW(a_real_units_start_packet_has_its_header_fields_and_point, /* 0.484 degrees. */
        "start ct:0x75 is-start:1 has-range:1 @0:31,149,21,0"),
    ROW(a_packet_reports_the_gap_before_it_and_its_last_byte,
        "<112233 start gap:3 skipped:0x33 manual gap:0"),
    ROW(header_angles_of_360_degrees_and_more_are_reduced, /* The field's largest: 32767. */
        "P2:23040,32767 first:0 last:9727 P2:23039,23041 first:23039 last:1"),
    ROW(a_t_mini_pros_start_packet_is_at_42_degrees,
        "pro-start is-start:1 ct:0xC7 @0:2688,152,20,2"),
    ROW(a_t_mini_pros_point_packet_has_39_flagged_samples, /* Index 25: 5233 + 25 * 2184 / 38. */
        "pro-points count:39 is-start:0 ct:0xB0 @0:5233,365,121,2 @25:6670,0,10,2 "
        "@38:7417,169,102,2"),
    ROW(a_t_mini_pros_full_packet_has_40_samples, /* From 153.91 to 189.03 degrees. */
        "pro-full count:40 is-start:0 ct:0x24 @0:9850,504,206,2 @39:12098,1374,203,2"),
    /* ---- Samples ---- */
    ROW(a_sample_is_intensity_distance_and_flag, /* Section 5's example; the extremes. */
        "x:64E56FFFFFFF000400800301 @0:0,7161,100,1 @1:100,16383,255,3 @2:200,1,0,0 "
        "@3:300,64,128,3"),
    ROW(there_is_no_point_at_an_index_of_count_or_more,
        "manual @18:49 none:19 none:256 none:65535"),
    /* ---- Filters ---- */
    ROW(without_a_filter_every_distance_is_kept,
        "P5:0,400 @0:0,1000,200,0 @1:100,1007,199,1 @2:200,1014,198,2 @3:300,1021,197,3 "
        "@4:400,1028,196,0"),
    ROW(the_specular_filter_takes_the_range_where_the_flag_is_2,
        "specular P5:0,400 @0:0,1000 @1:100,1007 @2:200,0,198,2 @3:300,1021 @4:400,1028"),
    ROW(the_ambient_filter_takes_the_range_where_the_flag_is_3,
        "ambient P5:0,400 @0:0,1000 @1:100,1007 @2:200,1014 @3:300,0,197,3 @4:400,1028"),
    ROW(both_filters_take_both,
        "both P5:0,400 @0:0,1000 @1:100,1007 @2:200,0 @3:300,0 @4:400,1028"),
    ROW(the_first_point_is_filtered_too, "specular x:09D207 @0:0,0,9,2"),
    /* ---- Angles ---- */
    ROW(a_lone_sample_is_at_fsa_whatever_lsa_says, /* Section 9.6. */
        "P1:17,10 @0:17 P1:23039,0 @0:23039"),
    ROW(the_step_between_samples_is_rounded_up_and_that_of_a_lone_one_is_0, /* 2^17 * 2 / 3. */
        "P4:0,2 step:87382 P4:0,1 step:43691 P2:0,1 step:131072 P1:17,10 step:0 P2:100,100 "
        "step:0"),
    ROW(the_last_sample_is_at_lsa, "P255:5,22000 @0:5 @254:22000"),
    ROW(equal_first_and_last_angles_are_no_turn, "P3:777,777 @0:777 @1:777 @2:777"),
    ROW(an_end_before_the_beginning_is_almost_a_whole_turn, /* 11619.5. */
        "P3:100,99 @0:100 @1:11620 @2:99"),
    ROW(angles_beyond_360_degrees_begin_at_0_again, /* 6680 apart. */
        "P4:23000,20000 @0:23000 @1:6640 @2:13320 @3:20000"),
    ROW(angles_are_rounded_to_nearest_and_halves_up,
        "P5:0,2 @0:0 @1:1 @2:1 @3:2 @4:2 P4:0,1 @1:0 @2:1"),
    ROW(an_angle_that_rounds_up_to_360_degrees_is_0, /* 23039.5, and 23040. */
        "P3:23039,0 @0:23039 @1:0 @2:0 P3:23030,10 @1:0"),
    ROW(an_angle_just_below_360_degrees_stays_there, "P4:23039,0 @1:23039"), /* 23039 + 1/3. */
    /* Values from a separate computation, also 63.498, 5355.498, 0.496 and 0.5. A step with 16
     * fraction bits, or one rounded down, fails here. test/system/test_angles.c has all angles. */
    ROW(a_less_exact_step_would_be_wrong,
        "P254:0,85 @189:63 P254:0,7169 @189:5355 P255:0,1 @126:0 @127:1"),
    /* ---- Range ---- */
    ROW(a_distance_other_than_0_in_any_sample_is_a_range, /* 1 mm, 64 mm. */
        "x:000000000400 has-range:1 x:000000000000000001 has-range:1 x:00000000FFFF has-range:1"),
    ROW(intensity_and_flag_alone_are_no_range, "x:000000FF0300 has-range:0 blind:3 has-range:0"),
    ROW(no_sample_of_the_longest_packet_is_taken_for_another, "blind:255 has-range:0"),
    ROW(what_follows_the_packet_is_no_range_of_it, "blind:1 <FFFFFFFFFF has-range:0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* -------------------------------------------------------------------------- the manual's packet */

/* Worked out by hand from S2 and S3. */
static const uint16_t manual_distances[19] = {11842, 11819, 11710, 11618, 11158, 10992, 10881,
                                              10846, 10829, 11121, 11213, 11166, 11083, 0,
                                              11096, 11096, 11004, 11106, 11135};

/* 1383/64 degrees clockwise in 18 steps, past 360 degrees; sample 9 is at 22397.5. */
static const uint16_t manual_angles[19] = {21706, 21783, 21860, 21937, 22013, 22090, 22167,
                                           22244, 22321, 22398, 22474, 22551, 22628, 22705,
                                           22782, 22859, 22935, 23012, 49};

/* Up to the memory's end samples are read where they are; one that straddles it is a copy. */
static void expect_samples_of_one_piece(size_t up_to_the_end)
{
    uint8_t joined[4] = {0, 0, 0, 0x5A};
    size_t count = 19;
    const uint8_t *const samples = tmini_frame_samples(receiver.packet.frame, 0, &count, joined);
    TEST_ASSERT_EQUAL_PTR(up_to_the_end < 3 ? joined : &memory[256 - up_to_the_end], samples);
    TEST_ASSERT_EQUAL_UINT(up_to_the_end < 3    ? 1
                           : up_to_the_end < 57 ? up_to_the_end / 3
                                                : 19,
                           count);
    TEST_ASSERT_EQUAL_HEX8(0x5A, joined[3]);
}

/* Each position of the packet puts another byte of it at the memory's end. */
void test_the_manuals_packet_has_its_points_wherever_it_lies_in_the_ring(void)
{
    for (size_t before = 0; before <= 70; before++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_age(&receiver, (size_t)0 - before);
        open_packet(manual_packet, 67);
        expect_samples_of_one_piece(before > 10 ? before - 10 : 256 - 10 + before);
        for (unsigned i = 0; i < 19; i++) {
            const tmini_point_t expected = {manual_angles[i], manual_distances[i], i != 14,
                                            i == 13 || i == 14 || i == 18 ? 2 : 0};
            tmini_point_t alone;
            TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, i, &alone));
            TEST_ASSERT_EQUAL_MEMORY(&expected, &alone, sizeof alone);
            TEST_ASSERT_EQUAL_MEMORY(&expected, &points[i], sizeof alone);
        }
    }
}

void test_no_more_points_are_written_than_there_is_room_for(void)
{
    open_packet(manual_packet, 67);
    for (size_t room = 0; room <= 20; room++) {
        read_points(room, room < 19 ? room : 19);
        TEST_ASSERT_EQUAL_UINT16(room > 0 ? manual_angles[0] : 0x0202, points[0].angle_q6);
    }
}

void test_a_point_is_six_bytes(void)
{
    TEST_ASSERT_EQUAL_UINT(6, sizeof(tmini_point_t));
}

void test_a_point_of_a_packet_that_dma_has_overwritten_may_not_be_used(void)
{
    tmini_point_t point;
    receiver_open_dma(&receiver, memory, 512, 0);
    open_packet(manual_packet, 67);
    memset(bytes, 0, 190);
    receiver_feed(&receiver, bytes, 189); /* 256 bytes unread: all are still certain. */
    TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, 0, &point));
    receiver_feed(&receiver, bytes, 1);
    TEST_ASSERT_FALSE(tmini_packet_point(&receiver.packet, 0, &point));
    TEST_ASSERT_FALSE(tmini_packet_point(&receiver.packet, 18, &point));
}

/* ---------------------------------------------------------------------------------- directions */

void test_an_angle_from_one_direction_clockwise_to_another_is_below_a_full_circle(void)
{
    TEST_ASSERT_EQUAL_UINT16(0, tmini_clockwise(0, 0));
    TEST_ASSERT_EQUAL_UINT16(640, tmini_clockwise(0, 640));
    TEST_ASSERT_EQUAL_UINT16(1, tmini_clockwise(23039, 0));
    TEST_ASSERT_EQUAL_UINT16(23039, tmini_clockwise(0, 23039));
    TEST_ASSERT_EQUAL_UINT16(22400, tmini_clockwise(640, 0));
}
