/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Sectors: the sector of an angle, and the nearest obstacle in a sector. */

#include "encoder.h"
#include "receiver.h"

#include "tmini/tmini_sectors.h"
#include "unity.h"

#define DEGREE 64u

static tmini_sector_t array[9];
static tmini_sectors_t sectors;
static uint8_t memory[512];
static uint8_t bytes[300];
static receiver_t receiver;

static void begin(size_t count, unsigned filter)
{
    array[8].nearest_mm = 0xEEEE;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_sectors_init(&sectors, array, count, filter));
}

void setUp(void)
{
    for (size_t i = 0; i < 8; i++) {
        array[i] = (tmini_sector_t){0x5555, 0x5555, 0x5555, 0x5555};
    }
    begin(8, TMINI_FILTER_NONE);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, array[8].nearest_mm);
}

static void see(uint16_t angle_q6, uint16_t distance_mm, uint8_t flag)
{
    const tmini_point_t point = {angle_q6, distance_mm, 100, flag};
    tmini_sectors_add(&sectors, &point);
}

static void holds(size_t index, uint16_t nearest_mm, uint16_t points, uint16_t ranges)
{
    TEST_ASSERT_EQUAL_UINT16(nearest_mm, array[index].nearest_mm);
    TEST_ASSERT_EQUAL_UINT16(points, array[index].points);
    TEST_ASSERT_EQUAL_UINT16(ranges, array[index].ranges);
}

void test_sectors_are_blind_to_begin_with(void)
{
    for (size_t i = 0; i < 8; i++) {
        holds(i, 0, 0, 0);
        TEST_ASSERT_TRUE(tmini_sector_is_blind(&array[i]));
    }
}

void test_eight_sectors_go_clockwise_from_the_front(void)
{
    static const uint16_t angles[8] = {0, 45, 90, 135, 180, 225, 270, 315};
    for (uint16_t i = 0; i < 8; i++) {
        see((uint16_t)(angles[i] * DEGREE), (uint16_t)(1000 + i), 0);
    }
    for (uint16_t i = 0; i < 8; i++) {
        TEST_ASSERT_EQUAL_UINT16(1000 + i, array[i].nearest_mm);
        TEST_ASSERT_EQUAL_UINT16(angles[i] * DEGREE, array[i].angle_q6);
    }
}

void test_the_front_sector_reaches_as_far_left_as_right(void)
{
    /* 22.5 degrees are 1440. A boundary belongs to the sector clockwise of it. */
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 1439));
    TEST_ASSERT_EQUAL_size_t(1, tmini_sectors_at(&sectors, 1440));
    TEST_ASSERT_EQUAL_size_t(7, tmini_sectors_at(&sectors, 21599));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 21600));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 23039));
}

void test_one_sector_holds_everything(void)
{
    begin(1, TMINI_FILTER_NONE);
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 0));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 11520));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 23039));
}

void test_three_sectors_are_120_degrees_wide(void)
{
    begin(3, TMINI_FILTER_NONE);
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 60 * DEGREE - 1));
    TEST_ASSERT_EQUAL_size_t(1, tmini_sectors_at(&sectors, 60 * DEGREE));
    TEST_ASSERT_EQUAL_size_t(2, tmini_sectors_at(&sectors, 180 * DEGREE));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 300 * DEGREE));
}

void test_65535_sectors_do_not_overflow(void)
{
    sectors.count = 65535;
    TEST_ASSERT_EQUAL_size_t(32768, tmini_sectors_at(&sectors, 11520)); /* 32767.5 */
    TEST_ASSERT_EQUAL_size_t(65532, tmini_sectors_at(&sectors, 23039)); /* 65532.16 */
    sectors.count = 8;
}

void test_a_sector_has_its_nearest_range_and_the_angle_of_that(void)
{
    see(0, 700, 0);
    see(10, 500, 0);
    see(20, 600, 0);
    holds(0, 500, 3, 3);
    TEST_ASSERT_EQUAL_UINT16(10, array[0].angle_q6);
}

void test_points_without_a_range_leave_a_sector_blind_and_not_free(void)
{
    see(0, 0, 0);
    see(1, 0, 0);
    holds(0, 0, 2, 0);
    TEST_ASSERT_TRUE(tmini_sector_is_blind(&array[0]));
    TEST_ASSERT_FALSE(tmini_sector_is_free(&array[0], 300));
    TEST_ASSERT_FALSE(tmini_sector_is_free(&array[0], 0));
    TEST_ASSERT_TRUE(array[0].nearest_mm < 300); /* The condition in which a user would stop. */
}

void test_a_sector_is_free_up_to_its_nearest_range(void)
{
    see(0, 0, 0);
    see(0, 16383, 0);
    see(0, 300, 0);
    holds(0, 300, 3, 2);
    TEST_ASSERT_FALSE(tmini_sector_is_blind(&array[0]));
    TEST_ASSERT_TRUE(tmini_sector_is_free(&array[0], 300));
    TEST_ASSERT_FALSE(tmini_sector_is_free(&array[0], 301));
}

void test_one_range_is_enough_for_a_sector_to_be_free(void)
{
    see(0, 300, 0);
    TEST_ASSERT_TRUE(tmini_sector_is_free(&array[0], 300));
}

void test_a_sector_counts_more_than_255_ranges(void)
{
    for (unsigned i = 0; i < 300; i++) {
        see(0, 500, 0);
    }
    holds(0, 500, 300, 300);
}

/* A sector that counts from 65535 to 0 would be blind although it has a range. */
void test_a_sector_with_65536_ranges_is_not_blind(void)
{
    see(0, 200, 0);
    for (unsigned long i = 1; i < 65536; i++) {
        see(0, 500, 0);
    }
    holds(0, 200, 65535, 65535);
    TEST_ASSERT_FALSE(tmini_sector_is_blind(&array[0]));
    TEST_ASSERT_TRUE(tmini_sector_is_free(&array[0], 200));
}

void test_flagged_points_count_unless_filtered(void)
{
    see(0, 400, TMINI_FLAG_SPECULAR);
    see(90 * DEGREE, 500, TMINI_FLAG_AMBIENT);
    holds(0, 400, 1, 1);
    holds(2, 500, 1, 1);
}

void test_a_filter_takes_no_range_from_the_points_with_its_flag(void)
{
    begin(8, TMINI_FILTER_SPECULAR);
    see(0, 400, TMINI_FLAG_SPECULAR);
    see(90 * DEGREE, 500, TMINI_FLAG_AMBIENT);
    see(180 * DEGREE, 600, 0);
    holds(0, 0, 1, 0);
    holds(2, 500, 1, 1);
    holds(4, 600, 1, 1);
}

void test_clearing_forgets_all_points(void)
{
    see(0, 400, 0);
    see(315 * DEGREE, 500, 0);
    tmini_sectors_clear(&sectors);
    holds(0, 0, 0, 0);
    holds(7, 0, 0, 0);
}

void test_a_scan_takes_the_place_of_what_was_there(void)
{
    static tmini_point_t points[4] = {{0, 900, 50, 0},
                                      {90 * DEGREE, 800, 50, 0},
                                      {270 * DEGREE, 700, 50, 0},
                                      {180 * DEGREE, 600, 50, 0}};
    const tmini_scan_t scan = {.points = points, .count = 3};
    see(0, 100, 0);
    see(45 * DEGREE, 100, 0);
    tmini_sectors_add_scan(&sectors, &scan);
    holds(0, 900, 1, 1);
    holds(1, 0, 0, 0);
    holds(2, 800, 1, 1);
    holds(4, 0, 0, 0); /* This point is beyond the scan's count. */
    holds(6, 700, 1, 1);
}

/* Samples at 0, 45 and 90 degrees. */
static size_t make_packet(void)
{
    static const encode_sample_t samples[3] = {{300, 10, 0}, {0, 10, 0}, {200, 10, 0}};
    const encode_packet_t packet = {0, 3, 0, 90 * DEGREE, samples};
    return encode_packet(bytes, &packet);
}

static void receive(size_t count)
{
    receiver_feed(&receiver, bytes, count);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
}

static bool receive_start(uint16_t distance_mm)
{
    const encode_sample_t sample = {distance_mm, 10, 0};
    const encode_packet_t packet = {0x79, 1, 0, 0, &sample};
    receive(encode_packet(bytes, &packet));
    return tmini_sectors_add_packet(&sectors, &receiver.packet);
}

static bool receive_points(void)
{
    receive(make_packet());
    return tmini_sectors_add_packet(&sectors, &receiver.packet);
}

void test_packets_add_their_points(void)
{
    receiver_open(&receiver, memory, sizeof memory, 0);
    TEST_ASSERT_FALSE(receive_points());
    holds(0, 300, 1, 1);
    holds(1, 0, 1, 0);
    holds(2, 200, 1, 1);
}

void test_what_precedes_the_first_start_packet_is_no_revolution(void)
{
    receiver_open(&receiver, memory, sizeof memory, 0);
    TEST_ASSERT_FALSE(receive_points());
    TEST_ASSERT_FALSE(receive_start(250));
    TEST_ASSERT_FALSE(receive_points());
    holds(0, 250, 2, 2);
}

void test_a_start_packet_reports_the_revolution_that_it_ends_and_begins_another(void)
{
    receiver_open(&receiver, memory, sizeof memory, 0);
    (void)receive_start(100);
    (void)receive_points();
    TEST_ASSERT_TRUE(receive_start(250));
    holds(0, 100, 2, 2);
    holds(2, 200, 1, 1);
    TEST_ASSERT_FALSE(receive_points());
    holds(0, 250, 2, 2);
    TEST_ASSERT_TRUE(receive_start(150));
    holds(0, 250, 2, 2);
}

void test_a_packet_that_dma_has_overwritten_adds_nothing(void)
{
    receiver_open_dma(&receiver, memory, sizeof memory, 0);
    receive(make_packet());
    receiver_feed(&receiver, bytes, sizeof bytes);

    TEST_ASSERT_FALSE(tmini_sectors_add_packet(&sectors, &receiver.packet));
    holds(0, 0, 0, 0);
    holds(2, 0, 0, 0);
}

void test_a_start_packet_that_dma_has_overwritten_leaves_nothing_of_the_one_before(void)
{
    receiver_open_dma(&receiver, memory, sizeof memory, 0);
    (void)receive_start(100);
    const encode_sample_t sample = {200, 10, 0};
    const encode_packet_t packet = {0x79, 1, 0, 0, &sample};
    receive(encode_packet(bytes, &packet));
    receiver_feed(&receiver, bytes, sizeof bytes);
    TEST_ASSERT_TRUE(tmini_sectors_add_packet(&sectors, &receiver.packet));
    holds(0, 100, 1, 1);
    (void)tmini_sectors_add_packet(&sectors, &receiver.packet); /* The next revolution begins. */
    holds(0, 0, 1, 0);
}

/* 720 points half a degree apart, in 360 sectors of a degree: too large for a small machine. */
void test_more_points_and_sectors_than_256_are_all_there(void)
{
#if SIZE_MAX > 65535
    static tmini_sector_t many[360];
    static tmini_point_t points[720];
    const tmini_scan_t scan = {.points = points, .count = 720};
    for (uint16_t i = 0; i < 720; i++) {
        points[i] = (tmini_point_t){(uint16_t)(i * 32u), (uint16_t)(i + 1u), 0, 0};
    }
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_sectors_init(&sectors, many, 360, 0));
    tmini_sectors_add_scan(&sectors, &scan);
    TEST_ASSERT_EQUAL_UINT16(1, many[0].nearest_mm);
    for (uint16_t degree = 1; degree < 360; degree++) {
        /* The nearest point is half a degree before the middle. */
        TEST_ASSERT_EQUAL_UINT16(2 * degree, many[degree].nearest_mm);
        TEST_ASSERT_EQUAL_UINT16(64 * degree - 32, many[degree].angle_q6);
        TEST_ASSERT_EQUAL_UINT16(2, many[degree].ranges);
    }
#endif
}

void test_arguments_out_of_range_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(NULL, array, 8, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, NULL, 8, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, array, 0, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, array, 8, 2));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, array, 8, 16));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_sectors_init(&sectors, array, 8, TMINI_FILTER_BOTH));
#if SIZE_MAX > 65535
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, array, 65536, 0));
#endif
}

/* Needs half a megabyte: too large for a small machine. */
void test_65535_sectors_are_taken(void)
{
#if defined(__linux__)
    static tmini_sector_t many[65536];
    many[65534].points = 0x5555;
    many[65535].points = 0x5555;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_sectors_init(&sectors, many, 65535, 0));
    TEST_ASSERT_EQUAL_UINT16(0, many[65534].points);
    TEST_ASSERT_EQUAL_HEX16(0x5555, many[65535].points);
#endif
}
