/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Packets: header fields, and samples as points (sections 5 and 9). */

#include "known_packets.h"
#include "receiver.h"
#include "stream.h"

#include "unity.h"

#include <string.h>

static uint8_t memory[1024];
static uint8_t bytes[800];
static stream_t stream;
static receiver_t receiver;
static tmini_point_t points[80];

void setUp(void)
{
    stream = (stream_t){bytes, 0, sizeof bytes};
    memset(points, 0xEE, sizeof points);
    receiver_open(&receiver, memory, 1024, 255);
}

void tearDown(void) {}

/* Releases the previous packet, feeds this one and opens it. */
static void open_packet(const uint8_t *packet, size_t size)
{
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next(&receiver));
    receiver_feed(&receiver, packet, size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
}

static void open_angles(uint8_t count, uint16_t first_q6, uint16_t last_q6)
{
    stream.size = 0;
    (void)stream_add_packet(&stream, 0, count, first_q6, last_q6);
    open_packet(bytes, stream.size);
}

static size_t read_points(unsigned filter, size_t max_points)
{
    return tmini_packet_points(&receiver.packet, filter, points, max_points);
}

static uint16_t angle(size_t index)
{
    tmini_point_t point;
    TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, index, &point));
    return point.angle_q6;
}

/* ------------------------------------------------------------------------------------- header */

void test_the_manuals_packet_has_its_header_fields(void)
{
    open_packet(manual_packet, 67);
    TEST_ASSERT_EQUAL_HEX8(0x20, receiver.packet.ct);
    TEST_ASSERT_EQUAL_UINT8(19, receiver.packet.count);
    TEST_ASSERT_EQUAL_UINT16(21706, receiver.packet.first_angle_q6); /* 339.15625 degrees. */
    TEST_ASSERT_EQUAL_UINT16(49, receiver.packet.last_angle_q6);     /* 0.765625 degrees. */
    TEST_ASSERT_FALSE(tmini_packet_is_start(&receiver.packet));
}

void test_a_real_units_start_packet_has_its_header_fields_and_point(void)
{
    tmini_point_t point;
    open_packet(start_packet, 13);
    TEST_ASSERT_EQUAL_HEX8(0x75, receiver.packet.ct);
    TEST_ASSERT_TRUE(tmini_packet_is_start(&receiver.packet));
    TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, 0, &point));
    TEST_ASSERT_EQUAL_UINT16(31, point.angle_q6); /* 0.484 degrees. */
    TEST_ASSERT_EQUAL_UINT16(149, point.distance_mm);
    TEST_ASSERT_EQUAL_UINT8(21, point.intensity);
    TEST_ASSERT_EQUAL_UINT8(0, point.flag);
}

void test_only_bit_0_of_ct_makes_a_start_packet(void)
{
    stream_add_packet(&stream, 0xFE, 1, 10, 10);
    open_packet(bytes, stream.size);
    TEST_ASSERT_FALSE(tmini_packet_is_start(&receiver.packet));
    TEST_ASSERT_EQUAL_HEX8(0xFE, receiver.packet.ct);
}

void test_a_packet_reports_the_gap_before_it_and_its_last_byte(void)
{
    static const uint8_t garbage[3] = {0x11, 0x22, 0x33};
    receiver_feed(&receiver, garbage, 3);
    open_packet(start_packet, 13);
    TEST_ASSERT_EQUAL_UINT16(3, receiver.packet.gap);
    TEST_ASSERT_EQUAL_HEX8(0x33, receiver.packet.frame->last_skipped);
    open_packet(manual_packet, 67);
    TEST_ASSERT_EQUAL_UINT16(0, receiver.packet.gap);
}

void test_header_angles_of_360_degrees_and_more_are_reduced(void)
{
    open_angles(2, 23040, 32767); /* 360 degrees, and the largest value of the field. */
    TEST_ASSERT_EQUAL_UINT16(0, receiver.packet.first_angle_q6);
    TEST_ASSERT_EQUAL_UINT16(9727, receiver.packet.last_angle_q6);
    open_angles(2, 23039, 23041);
    TEST_ASSERT_EQUAL_UINT16(23039, receiver.packet.first_angle_q6);
    TEST_ASSERT_EQUAL_UINT16(1, receiver.packet.last_angle_q6);
}

/* ------------------------------------------------------------------------------------- samples */

/* Worked out by hand from S2 and S3. */
static const uint16_t manual_distances[19] = {11842, 11819, 11710, 11618, 11158, 10992, 10881,
                                              10846, 10829, 11121, 11213, 11166, 11083, 0,
                                              11096, 11096, 11004, 11106, 11135};

void test_an_angle_from_one_direction_clockwise_to_another_is_below_a_full_circle(void)
{
    TEST_ASSERT_EQUAL_UINT16(0, tmini_clockwise(0, 0));
    TEST_ASSERT_EQUAL_UINT16(0, tmini_clockwise(23039, 23039));
    TEST_ASSERT_EQUAL_UINT16(640, tmini_clockwise(0, 640));
    TEST_ASSERT_EQUAL_UINT16(1, tmini_clockwise(23039, 0));
    TEST_ASSERT_EQUAL_UINT16(23039, tmini_clockwise(0, 23039));
    TEST_ASSERT_EQUAL_UINT16(22400, tmini_clockwise(640, 0));
}

void test_the_manuals_packet_has_its_distances_intensities_and_flags(void)
{
    open_packet(manual_packet, 67);
    TEST_ASSERT_EQUAL_UINT(19, read_points(TMINI_FILTER_NONE, 80));
    for (unsigned i = 0; i < 19; i++) {
        TEST_ASSERT_EQUAL_UINT16(manual_distances[i], points[i].distance_mm);
        TEST_ASSERT_EQUAL_UINT8(i == 14 ? 0 : 1, points[i].intensity);
        TEST_ASSERT_EQUAL_UINT8(i == 13 || i == 14 || i == 18 ? 2 : 0, points[i].flag);
    }
}

/* 1383/64 degrees clockwise in 18 steps, past 360 degrees; sample 9 is at 22397.5. */
static const uint16_t manual_angles[19] = {21706, 21783, 21860, 21937, 22013, 22090, 22167,
                                           22244, 22321, 22398, 22474, 22551, 22628, 22705,
                                           22782, 22859, 22935, 23012, 49};

void test_the_manuals_packet_has_its_angles(void)
{
    open_packet(manual_packet, 67);
    (void)read_points(TMINI_FILTER_NONE, 80);
    for (unsigned i = 0; i < 19; i++) {
        TEST_ASSERT_EQUAL_UINT16(manual_angles[i], points[i].angle_q6);
        TEST_ASSERT_EQUAL_UINT16(manual_angles[i], angle(i));
    }
}

/* Section 5's example: 64 E5 6F is intensity 100, 7161 mm, flag 1. And the extremes. */
void test_a_sample_is_intensity_distance_and_flag(void)
{
    static const uint8_t samples[12] = {0x64, 0xE5, 0x6F, 0xFF, 0xFF, 0xFF,
                                        0x00, 0x04, 0x00, 0x80, 0x03, 0x01};
    const encode_packet_t packet = {0, 4, 0, 300, NULL};
    encode_packet_header(bytes, &packet);
    memcpy(&bytes[10], samples, 12);
    encode_seal(bytes);
    open_packet(bytes, 22);
    (void)read_points(TMINI_FILTER_NONE, 4);
    const tmini_point_t expected[4] = {
        {0, 7161, 100, 1}, {100, 16383, 255, 3}, {200, 1, 0, 0}, {300, 64, 128, 3}};
    TEST_ASSERT_EQUAL_MEMORY(expected, points, sizeof expected);
}

void test_a_point_is_six_bytes(void)
{
    TEST_ASSERT_EQUAL_UINT(6, sizeof(tmini_point_t));
}

void test_points_can_be_read_one_at_a_time(void)
{
    open_packet(manual_packet, 67);
    (void)read_points(TMINI_FILTER_NONE, 80);
    for (unsigned i = 0; i < 19; i++) {
        tmini_point_t point;
        TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, i, &point));
        TEST_ASSERT_EQUAL_MEMORY(&points[i], &point, sizeof point);
    }
}

void test_a_point_that_is_read_alone_leaves_memory_after_it(void)
{
    open_packet(manual_packet, sizeof manual_packet);
    points[1].angle_q6 = 23040; /* The library would change it to 0. */
    TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, 0, points));
    TEST_ASSERT_EQUAL_UINT16(23040, points[1].angle_q6);
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, points[1].distance_mm);
}

void test_there_is_no_point_at_an_index_of_count_or_more(void)
{
    tmini_point_t point;
    open_packet(manual_packet, 67);
    TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, 18, &point));
    TEST_ASSERT_FALSE(tmini_packet_point(&receiver.packet, 19, &point));
    TEST_ASSERT_FALSE(tmini_packet_point(&receiver.packet, SIZE_MAX, &point));
}

void test_no_more_points_are_written_than_there_is_room_for(void)
{
    open_packet(manual_packet, 67);
    for (size_t room = 0; room < 19; room++) {
        memset(points, 0xEE, sizeof points);
        TEST_ASSERT_EQUAL_UINT(room, read_points(TMINI_FILTER_NONE, room));
        TEST_ASSERT_EQUAL_HEX16(0xEEEE, points[room].angle_q6);
        if (room > 0) {
            TEST_ASSERT_EQUAL_UINT16(manual_angles[room - 1], points[room - 1].angle_q6);
        }
    }
}

void test_no_more_points_are_written_than_the_packet_has(void)
{
    open_packet(manual_packet, 67);
    TEST_ASSERT_EQUAL_UINT(19, read_points(TMINI_FILTER_NONE, 19));
    TEST_ASSERT_EQUAL_UINT(19, read_points(TMINI_FILTER_NONE, 20));
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, points[19].angle_q6);
}

/* Each position of the packet puts another byte of it at the memory's end. */
void test_points_are_the_same_wherever_the_packet_lies_in_the_ring(void)
{
    tmini_point_t first[19];
    open_packet(manual_packet, 67);
    (void)read_points(TMINI_FILTER_NONE, 80);
    memcpy(first, points, sizeof first);
    for (size_t before = 1; before <= 70; before++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_age(&receiver, (size_t)0 - before);
        memset(points, 0xEE, sizeof points);
        open_packet(manual_packet, 67);
        TEST_ASSERT_EQUAL_UINT(19, read_points(TMINI_FILTER_NONE, 80));
        TEST_ASSERT_EQUAL_MEMORY(first, points, sizeof first);
        TEST_ASSERT_EQUAL_HEX16(0xEEEE, points[19].angle_q6);
        for (unsigned i = 0; i < 19; i++) {
            tmini_point_t point;
            TEST_ASSERT_TRUE(tmini_packet_point(&receiver.packet, i, &point));
            TEST_ASSERT_EQUAL_MEMORY(&first[i], &point, sizeof point);
        }
    }
}

/* -------------------------------------------------------------------------------------- filters */

/* Distances of a packet with flags 0, 1, 2, 3, 0; the flags stay. */
static void expect_filtered(unsigned filter, uint16_t third, uint16_t fourth)
{
    open_angles(5, 0, 400);
    TEST_ASSERT_EQUAL_UINT(5, read_points(filter, 80));
    TEST_ASSERT_EQUAL_UINT16(1000, points[0].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(1007, points[1].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(third, points[2].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(fourth, points[3].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(1028, points[4].distance_mm);
    for (unsigned i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_UINT8(i % 4, points[i].flag);
        TEST_ASSERT_EQUAL_UINT8(200 - i, points[i].intensity);
        TEST_ASSERT_EQUAL_UINT16(100 * i, points[i].angle_q6);
    }
}

void test_without_a_filter_every_distance_is_kept(void)
{
    expect_filtered(TMINI_FILTER_NONE, 1014, 1021);
}

void test_the_specular_filter_zeroes_the_distance_where_the_flag_is_2(void)
{
    expect_filtered(TMINI_FILTER_SPECULAR, 0, 1021);
}

void test_the_ambient_filter_zeroes_the_distance_where_the_flag_is_3(void)
{
    expect_filtered(TMINI_FILTER_AMBIENT, 1014, 0);
}

void test_the_first_point_is_filtered_and_memory_after_the_last_is_not(void)
{
    const encode_sample_t sample = {500, 9, 2};
    const encode_packet_t packet = {0x79, 1, 10, 10, &sample};
    const tmini_point_t mine = {1, 2, 3, 2};
    points[1] = mine;
    open_packet(bytes, encode_packet(bytes, &packet));
    TEST_ASSERT_EQUAL_UINT(1, read_points(TMINI_FILTER_SPECULAR, 80));
    TEST_ASSERT_EQUAL_UINT16(0, points[0].distance_mm);
    TEST_ASSERT_EQUAL_MEMORY(&mine, &points[1], sizeof mine);
}

void test_both_filters_zero_both(void)
{
    expect_filtered(TMINI_FILTER_BOTH, 0, 0);
    TEST_ASSERT_EQUAL_INT(TMINI_FILTER_BOTH, TMINI_FILTER_SPECULAR | TMINI_FILTER_AMBIENT);
}

/* --------------------------------------------------------------------------------------- angles */

void test_a_lone_sample_is_at_fsa_whatever_lsa_says(void)
{
    open_angles(1, 17, 10); /* Section 9.6. */
    TEST_ASSERT_EQUAL_UINT16(17, angle(0));
    open_angles(1, 23039, 0);
    TEST_ASSERT_EQUAL_UINT16(23039, angle(0));
    TEST_ASSERT_EQUAL_UINT(1, read_points(TMINI_FILTER_NONE, 80));
    TEST_ASSERT_EQUAL_UINT16(23039, points[0].angle_q6);
}

/* 2 / 3 of 2^17 are 87381.3, 1 / 3 are 43690.7. */
void test_the_step_between_samples_is_rounded_up_and_that_of_a_lone_one_is_0(void)
{
    open_angles(4, 0, 2);
    TEST_ASSERT_EQUAL_UINT32(87382, receiver.packet.step);
    open_angles(4, 0, 1);
    TEST_ASSERT_EQUAL_UINT32(43691, receiver.packet.step);
    open_angles(2, 0, 1);
    TEST_ASSERT_EQUAL_UINT32(131072, receiver.packet.step);
    open_angles(1, 17, 10);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.packet.step);
    open_angles(2, 100, 100);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.packet.step);
}

void test_the_last_sample_is_at_lsa(void)
{
    open_angles(255, 5, 22000);
    TEST_ASSERT_EQUAL_UINT16(5, angle(0));
    TEST_ASSERT_EQUAL_UINT16(22000, angle(254));
}

void test_equal_first_and_last_angles_are_no_turn(void)
{
    open_angles(3, 777, 777);
    TEST_ASSERT_EQUAL_UINT16(777, angle(0));
    TEST_ASSERT_EQUAL_UINT16(777, angle(1));
    TEST_ASSERT_EQUAL_UINT16(777, angle(2));
}

void test_an_end_before_the_beginning_is_almost_a_whole_turn(void)
{
    open_angles(3, 100, 99);
    TEST_ASSERT_EQUAL_UINT16(100, angle(0));
    TEST_ASSERT_EQUAL_UINT16(11620, angle(1)); /* 11619.5. */
    TEST_ASSERT_EQUAL_UINT16(99, angle(2));
}

void test_a_packet_that_turns_far_beyond_360_degrees_begins_at_0_again(void)
{
    open_angles(4, 23000, 20000); /* 6680 apart. */
    TEST_ASSERT_EQUAL_UINT16(23000, angle(0));
    TEST_ASSERT_EQUAL_UINT16(6640, angle(1));  /* 29680. */
    TEST_ASSERT_EQUAL_UINT16(13320, angle(2)); /* 36360. */
    TEST_ASSERT_EQUAL_UINT16(20000, angle(3)); /* 43040. */
}

void test_angles_are_rounded_to_nearest_and_halves_up(void)
{
    open_angles(5, 0, 2);
    TEST_ASSERT_EQUAL_UINT16(0, angle(0));
    TEST_ASSERT_EQUAL_UINT16(1, angle(1)); /* 0.5. */
    TEST_ASSERT_EQUAL_UINT16(1, angle(2));
    TEST_ASSERT_EQUAL_UINT16(2, angle(3)); /* 1.5. */
    TEST_ASSERT_EQUAL_UINT16(2, angle(4));
    open_angles(4, 0, 1);
    TEST_ASSERT_EQUAL_UINT16(0, angle(1)); /* 1/3. */
    TEST_ASSERT_EQUAL_UINT16(1, angle(2)); /* 2/3. */
}

void test_an_angle_that_rounds_up_to_360_degrees_is_0(void)
{
    open_angles(3, 23039, 0);
    TEST_ASSERT_EQUAL_UINT16(23039, angle(0));
    TEST_ASSERT_EQUAL_UINT16(0, angle(1)); /* 23039.5. */
    TEST_ASSERT_EQUAL_UINT16(0, angle(2));
    open_angles(3, 23030, 10);
    TEST_ASSERT_EQUAL_UINT16(0, angle(1)); /* 23040. */
}

void test_an_angle_just_below_360_degrees_stays_there(void)
{
    open_angles(4, 23039, 0);
    TEST_ASSERT_EQUAL_UINT16(23039, angle(1)); /* 23039 + 1/3. */
}

/* first + round(index * difference / (count - 1)), halves up. */
static uint16_t exact_angle(uint16_t first, uint32_t difference, uint32_t index, uint32_t intervals)
{
    const uint32_t turned = (2 * index * difference + intervals) / (2 * intervals);
    return (uint16_t)((first + turned) % 23040u);
}

static void expect_exact_angles(unsigned count, unsigned difference, unsigned stride)
{
    const uint16_t first = 100;
    const uint16_t last = (uint16_t)((first + difference) % 23040u);
    open_angles((uint8_t)count, first, last);
    for (unsigned i = 0; i < count; i += stride) {
        TEST_ASSERT_EQUAL_UINT16(exact_angle(first, difference, i, count - 1), angle(i));
    }
    TEST_ASSERT_EQUAL_UINT16(last, angle(count - 1));
}

/* Values from a separate computation. A step with 16 fraction bits, or one rounded down, fails
 * here. */
void test_a_less_exact_step_would_be_wrong(void)
{
    open_angles(254, 0, 85);
    TEST_ASSERT_EQUAL_UINT16(63, angle(189)); /* 63.498. */
    open_angles(254, 0, 7169);
    TEST_ASSERT_EQUAL_UINT16(5355, angle(189)); /* 5355.498. */
    open_angles(255, 0, 1);
    TEST_ASSERT_EQUAL_UINT16(0, angle(126)); /* 0.496. */
    TEST_ASSERT_EQUAL_UINT16(1, angle(127)); /* 0.5. */
}

/* Differences at which rounding errors are most likely: a multiple of the number of intervals plus
 * half of it, and one more. test/system/test_angles.c has all pairs of count and difference. */
void test_interpolated_angles_are_exact(void)
{
    for (unsigned count = 2; count <= 255; count += 23) {
        const unsigned intervals = count - 1;
        for (unsigned turns = 0; turns < 23040 / intervals; turns += 1 + 2000 / intervals) {
            const unsigned difference = turns * intervals + intervals / 2;
            expect_exact_angles(count, difference, 7);
            expect_exact_angles(count, difference + 1, 5);
        }
        expect_exact_angles(count, 23039, 1);
        expect_exact_angles(count, 0, 9);
    }
}

/* ---------------------------------------------------------------------------------------- range */

static bool has_range_with(uint8_t s1, uint8_t s2, uint8_t s3)
{
    const encode_packet_t packet = {0, 3, 0, 300, NULL};
    encode_packet_header(bytes, &packet);
    memset(&bytes[10], 0, 9);
    bytes[16] = s1;
    bytes[17] = s2;
    bytes[18] = s3;
    encode_seal(bytes);
    open_packet(bytes, 19);
    return tmini_packet_has_range(&receiver.packet);
}

void test_a_distance_other_than_0_in_any_sample_is_a_range(void)
{
    TEST_ASSERT_TRUE(has_range_with(0, 0x04, 0)); /* 1 mm. */
    TEST_ASSERT_TRUE(has_range_with(0, 0, 1));    /* 64 mm. */
    TEST_ASSERT_TRUE(has_range_with(0, 0xFF, 0xFF));
    open_packet(start_packet, 13);
    TEST_ASSERT_TRUE(tmini_packet_has_range(&receiver.packet));
}

void test_intensity_and_flag_alone_are_no_range(void)
{
    TEST_ASSERT_FALSE(has_range_with(0xFF, 0x03, 0));
    TEST_ASSERT_FALSE(has_range_with(0, 0, 0));
}

void test_no_sample_of_the_longest_packet_is_taken_for_another(void)
{
    const encode_packet_t packet = {0, 255, 0, 300, NULL};
    encode_packet_header(bytes, &packet);
    memset(&bytes[10], 0, 765);
    encode_seal(bytes);
    open_packet(bytes, 775);
    TEST_ASSERT_FALSE(tmini_packet_has_range(&receiver.packet));
}

void test_what_follows_the_packet_is_no_range_of_it(void)
{
    const encode_packet_t packet = {0, 1, 0, 0, NULL};
    encode_packet_header(bytes, &packet);
    memset(&bytes[10], 0, 3);
    encode_seal(bytes);
    memset(&bytes[13], 0xFF, 10);
    open_packet(bytes, 23);
    TEST_ASSERT_FALSE(tmini_packet_has_range(&receiver.packet));
}

/* ------------------------------------------------------------------------------------------ DMA */

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
