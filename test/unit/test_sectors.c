/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Sectors: which one an angle is in, and what counts as the nearest obstacle there. */

#include "encoder.h"
#include "receiver.h"

#include "tmini/tmini_sectors.h"
#include "unity.h"

#define DEGREE 64u

static uint16_t nearest_mm[9];
static tmini_sectors_t sectors;
static uint8_t memory[512];
static uint8_t bytes[300];
static receiver_t receiver;

static void begin(size_t count, uint16_t front_q6, unsigned filter)
{
    nearest_mm[8] = 0xEEEE;
    TEST_ASSERT_EQUAL_INT(TMINI_OK,
                          tmini_sectors_init(&sectors, nearest_mm, count, front_q6, filter));
}

void setUp(void)
{
    for (size_t i = 0; i < 8; i++) {
        nearest_mm[i] = 0x5555;
    }
    begin(8, 0, TMINI_FILTER_NONE);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, nearest_mm[8]);
}

static void see(uint16_t angle_q6, uint16_t distance_mm, uint8_t flag)
{
    const tmini_point_t point = {angle_q6, distance_mm, 100, flag};
    tmini_sectors_add(&sectors, &point);
}

void test_sectors_are_clear_to_begin_with(void)
{
    for (size_t i = 0; i < 8; i++) {
        TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[i]);
    }
}

void test_eight_sectors_go_clockwise_from_the_front(void)
{
    static const uint16_t angles[8] = {0, 45, 90, 135, 180, 225, 270, 315};
    for (uint16_t i = 0; i < 8; i++) {
        see((uint16_t)(angles[i] * DEGREE), (uint16_t)(1000 + i), 0);
    }
    for (uint16_t i = 0; i < 8; i++) {
        TEST_ASSERT_EQUAL_UINT16(1000 + i, nearest_mm[i]);
    }
}

void test_the_front_sector_reaches_as_far_left_as_right(void)
{
    /* 22.5 degrees are 1440. The boundaries belong to the sector clockwise of them. */
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 1439));
    TEST_ASSERT_EQUAL_size_t(1, tmini_sectors_at(&sectors, 1440));
    TEST_ASSERT_EQUAL_size_t(7, tmini_sectors_at(&sectors, 21599));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 21600));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 23039));
}

void test_one_sector_holds_everything(void)
{
    begin(1, 0, TMINI_FILTER_NONE);
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 0));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 11520));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 23039));
}

void test_three_sectors_are_120_degrees_wide(void)
{
    begin(3, 0, TMINI_FILTER_NONE);
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 60 * DEGREE - 1));
    TEST_ASSERT_EQUAL_size_t(1, tmini_sectors_at(&sectors, 60 * DEGREE));
    TEST_ASSERT_EQUAL_size_t(2, tmini_sectors_at(&sectors, 180 * DEGREE));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 300 * DEGREE));
}

void test_so_many_sectors_as_fit_in_16_bits_do_not_overflow(void)
{
    sectors.count = 65535;
    TEST_ASSERT_EQUAL_size_t(32768, tmini_sectors_at(&sectors, 11520)); /* 32767.5 */
    TEST_ASSERT_EQUAL_size_t(65532, tmini_sectors_at(&sectors, 23039)); /* 65532.16 */
    sectors.count = 8;
}

void test_the_front_can_be_any_angle_of_the_lidar(void)
{
    begin(8, 90 * DEGREE, TMINI_FILTER_NONE);
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 90 * DEGREE));
    TEST_ASSERT_EQUAL_size_t(2, tmini_sectors_at(&sectors, 180 * DEGREE));
    TEST_ASSERT_EQUAL_size_t(6, tmini_sectors_at(&sectors, 0));
}

void test_the_nearest_point_counts(void)
{
    see(0, 700, 0);
    see(0, 500, 0);
    see(0, 600, 0);
    TEST_ASSERT_EQUAL_UINT16(500, nearest_mm[0]);
}

void test_a_point_without_distance_is_no_obstacle(void)
{
    see(0, 0, 0);
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[0]);
    see(0, 16383, 0);
    see(0, 0, 0);
    TEST_ASSERT_EQUAL_UINT16(16383, nearest_mm[0]);
}

void test_flagged_points_count_unless_filtered(void)
{
    see(0, 400, TMINI_FLAG_SPECULAR);
    see(90 * DEGREE, 500, TMINI_FLAG_AMBIENT);
    TEST_ASSERT_EQUAL_UINT16(400, nearest_mm[0]);
    TEST_ASSERT_EQUAL_UINT16(500, nearest_mm[2]);
}

void test_a_filter_leaves_out_the_points_with_its_flag(void)
{
    begin(8, 0, TMINI_FILTER_SPECULAR);
    see(0, 400, TMINI_FLAG_SPECULAR);
    see(90 * DEGREE, 500, TMINI_FLAG_AMBIENT);
    see(180 * DEGREE, 600, 0);
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[0]);
    TEST_ASSERT_EQUAL_UINT16(500, nearest_mm[2]);
    TEST_ASSERT_EQUAL_UINT16(600, nearest_mm[4]);
}

void test_clearing_forgets_all_obstacles(void)
{
    see(0, 400, 0);
    see(315 * DEGREE, 500, 0);
    tmini_sectors_clear(&sectors);
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[0]);
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[7]);
}

void test_a_scan_adds_all_its_points_and_none_behind_them(void)
{
    static tmini_point_t points[4] = {{0, 900, 50, 0},
                                      {90 * DEGREE, 800, 50, 0},
                                      {270 * DEGREE, 700, 50, 0},
                                      {180 * DEGREE, 600, 50, 0}};
    static const uint16_t expected_mm[8] = {900, 0, 800, 0, 0, 0, 700, 0};
    const tmini_scan_t scan = {.points = points, .count = 3};
    tmini_sectors_add_scan(&sectors, &scan);
    TEST_ASSERT_EQUAL_UINT16_ARRAY(expected_mm, nearest_mm, 8);
}

/* 0, 45 and 90 degrees. */
static size_t make_packet(void)
{
    static const encode_sample_t samples[3] = {{300, 10, 0}, {0, 10, 0}, {200, 10, 0}};
    const encode_packet_t packet = {0, 3, 0, 90 * DEGREE, samples};
    return encode_packet(bytes, &packet);
}

void test_a_packet_adds_all_its_points(void)
{
    receiver_open(&receiver, memory, sizeof memory, 0);
    receiver_feed(&receiver, bytes, make_packet());
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));

    TEST_ASSERT_TRUE(tmini_sectors_add_packet(&sectors, &receiver.packet));
    TEST_ASSERT_EQUAL_UINT16(300, nearest_mm[0]);
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[1]);
    TEST_ASSERT_EQUAL_UINT16(200, nearest_mm[2]);
}

void test_a_packet_that_dma_has_overwritten_adds_nothing(void)
{
    receiver_open_dma(&receiver, memory, sizeof memory, 0);
    receiver_feed(&receiver, bytes, make_packet());
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
    receiver_feed(&receiver, bytes, sizeof bytes);

    TEST_ASSERT_FALSE(tmini_sectors_add_packet(&sectors, &receiver.packet));
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[0]);
    TEST_ASSERT_EQUAL_UINT16(0, nearest_mm[2]);
}

void test_arguments_out_of_range_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(NULL, nearest_mm, 8, 0, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, NULL, 8, 0, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, nearest_mm, 0, 0, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                          tmini_sectors_init(&sectors, nearest_mm, 8, 23040, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, nearest_mm, 8, 0, 2));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, nearest_mm, 8, 0, 16));
#if SIZE_MAX > 65535
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                          tmini_sectors_init(&sectors, nearest_mm, 65536, 0, 0));
#endif
}

/* 128 KB are too much for a small machine. */
void test_65535_sectors_are_taken(void)
{
#if defined(__linux__)
    static uint16_t many_mm[65536];
    many_mm[65534] = 0x5555;
    many_mm[65535] = 0x5555;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_sectors_init(&sectors, many_mm, 65535, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(0, many_mm[65534]);
    TEST_ASSERT_EQUAL_HEX16(0x5555, many_mm[65535]);
#endif
}

void test_the_last_permitted_front_and_both_filters_are_taken(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK,
                          tmini_sectors_init(&sectors, nearest_mm, 8, 23039, TMINI_FILTER_BOTH));
    TEST_ASSERT_EQUAL_size_t(0, tmini_sectors_at(&sectors, 23039));
}
