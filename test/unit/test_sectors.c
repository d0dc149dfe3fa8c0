/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Sectors: the sector of an angle, and the nearest obstacle in a sector. */

#include "encoder.h"
#include "receiver.h"
#include "rows.h"

#include "tmini/tmini_sectors.h"
#include "unity.h"

#include <stdlib.h>

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
    receiver_open(&receiver, memory, sizeof memory, 0);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, array[8].nearest_mm);
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows. Angles are degrees.
 *
 *     sectors:3:4     three sectors, and this filter
 *     see:45:1000     a point at this angle, with this distance; see:45:1000:2 with this flag
 *     scan            a scan of points at 0, 90 and 270 degrees, with 900, 800 and 700 mm
 *     clear           forgets all points
 *     dma             packets come by DMA
 *     S:100           a start packet at 0 degrees, with this distance; S!:100: ends a revolution
 *     P               a packet of points at 0, 45 and 90 degrees: 300 mm, no range, 200 mm
 *     lost:100 lost   such packets come, and DMA overwrites them
 *     add add!        adds the last packet, which ends no revolution, or one
 *     at:60:1         the angle belongs to this sector; at:60-:1: an angle just below it does
 *     0=300,2,1       what a sector holds: nearest range, points, ranges
 *     angle:0:10      the angle of a sector's nearest range, in sixty-fourths of a degree
 *     free:0:300 not-free:0:301       whether a sector is free up to this distance */

static uint16_t angle_of(const char *text)
{
    char *rest;
    const unsigned long degrees = strtoul(text, &rest, 10);
    return (uint16_t)(degrees * DEGREE - (rest[0] == '-' ? 1 : 0));
}

static void see(const char *text)
{
    const char *const distance = row_text(text);
    const tmini_point_t point = {angle_of(text), (uint16_t)strtoul(distance, NULL, 10), 100,
                                 (uint8_t)row_number(distance)};
    tmini_sectors_add(&sectors, &point);
}

static void add_scan(void)
{
    static tmini_point_t points[4] = {{0, 900, 50, 0},
                                      {90 * DEGREE, 800, 50, 0},
                                      {270 * DEGREE, 700, 50, 0},
                                      {180 * DEGREE, 600, 50, 0}}; /* Beyond the scan's count. */
    const tmini_scan_t scan = {.points = points, .count = 3};
    tmini_sectors_add_scan(&sectors, &scan);
}

static void receive(uint16_t start_mm)
{
    static const encode_sample_t three[3] = {{300, 10, 0}, {0, 10, 0}, {200, 10, 0}};
    const encode_sample_t one = {start_mm, 10, 0};
    const encode_packet_t start = {0x79, 1, 0, 0, &one};
    const encode_packet_t points = {0, 3, 0, 90 * DEGREE, three};
    receiver_feed(&receiver, bytes, encode_packet(bytes, start_mm > 0 ? &start : &points));
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
}

static bool add_packet(void)
{
    return tmini_sectors_add_packet(&sectors, &receiver.packet);
}

static void holds(const char *word)
{
    char *rest;
    const tmini_sector_t *const sector = &array[strtoul(word, &rest, 10)];
    const uint16_t holding[] = {sector->nearest_mm, sector->points, sector->ranges};
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(strtoul(rest + 1, &rest, 10), holding[i], word);
    }
    TEST_ASSERT_EQUAL_MESSAGE(sector->nearest_mm == 0, tmini_sector_is_blind(sector), word);
}

static void tell_word(char *word)
{
    const char *const text = row_text(word);
    const size_t index = row_number(word) < 8 ? row_number(word) : 0;
    const uint16_t second = (uint16_t)row_number(text);
    if (row_is(word, "see")) {
        see(text);
    } else if (word[0] >= '0' && word[0] <= '9') {
        holds(word);
    } else if (row_is(word, "sectors")) {
        begin(row_number(word), second);
    } else if (row_is(word, "scan")) {
        add_scan();
    } else if (row_is(word, "clear")) {
        tmini_sectors_clear(&sectors);
    } else if (row_is(word, "dma")) {
        receiver_open_dma(&receiver, memory, sizeof memory, 0);
    } else if (row_is(word, "lost")) {
        receive((uint16_t)row_number(word));
        receiver_feed(&receiver, bytes, sizeof bytes);
    } else if (word[0] == 'S' || word[0] == 'P') {
        receive((uint16_t)row_number(word));
        TEST_ASSERT_EQUAL_MESSAGE(word[1] == '!', add_packet(), word);
    } else if (row_is(word, "add!")) {
        TEST_ASSERT_TRUE(add_packet());
    } else if (row_is(word, "add")) {
        TEST_ASSERT_FALSE(add_packet());
    } else if (row_is(word, "at")) {
        TEST_ASSERT_EQUAL_size_t_MESSAGE(second, tmini_sectors_at(&sectors, angle_of(text)), word);
    } else if (row_is(word, "angle")) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(second, array[index].angle_q6, word);
    } else if (row_is(word, "free")) {
        TEST_ASSERT_TRUE_MESSAGE(tmini_sector_is_free(&array[index], second), word);
    } else if (row_is(word, "not-free")) {
        TEST_ASSERT_FALSE_MESSAGE(tmini_sector_is_free(&array[index], second), word);
    } else {
        TEST_FAIL_MESSAGE(word);
    }
}

static const row_t rows[] IN_FLASH = {
    /* ---- Directions ---- */
    ROW(eight_sectors_go_clockwise_from_the_front,
        "see:0:1000 see:45:1001 see:90:1002 see:135:1003 see:180:1004 see:225:1005 see:270:1006 "
        "see:315:1007 0=1000,1,1 1=1001,1,1 2=1002,1,1 3=1003,1,1 4=1004,1,1 5=1005,1,1 "
        "6=1006,1,1 7=1007,1,1 angle:0:0 angle:1:2880 angle:7:20160"),
    ROW(one_sector_holds_everything, "sectors:1 at:0:0 at:180:0 at:360-:0"),
    ROW(three_sectors_are_120_degrees_wide, /* A boundary belongs to the sector clockwise. */
        "sectors:3 at:60-:0 at:60:1 at:180-:1 at:180:2 at:300-:2 at:300:0 at:360-:0"),
    /* ---- Points ---- */
    ROW(sectors_are_blind_to_begin_with, "0=0,0,0 3=0,0,0 7=0,0,0 not-free:0:0"),
    ROW(a_sector_has_its_nearest_range_and_the_angle_of_that,
        "see:0:700 see:10:500 see:20:600 0=500,3,3 angle:0:640"),
    ROW(points_without_a_range_leave_a_sector_blind_and_not_free,
        "see:0:0 see:1:0 0=0,2,0 not-free:0:300 not-free:0:0"),
    ROW(a_sector_is_free_up_to_its_nearest_range,
        "see:0:0 see:0:16383 see:0:300 0=300,3,2 free:0:300 not-free:0:301"),
    ROW(one_range_is_enough_for_a_sector_to_be_free, "see:0:300 free:0:300"),
    ROW(a_sector_counts_more_than_255_ranges, "300( see:0:500 ) 0=500,300,300"),
    ROW(a_sector_with_65536_ranges_is_not_blind, /* As it would be if it counted 0. */
        "see:0:200 257( 255( see:0:500 ) ) 0=200,65535,65535 free:0:200"),
    ROW(flagged_points_count_unless_filtered, "see:0:400:2 see:90:500:3 0=400,1,1 2=500,1,1"),
    ROW(a_filter_takes_no_range_from_the_points_with_its_flag,
        "sectors:8:4 see:0:400:2 see:90:500:3 see:180:600 0=0,1,0 2=500,1,1 4=600,1,1"),
    ROW(clearing_forgets_all_points, "see:0:400 see:315:500 clear 0=0,0,0 7=0,0,0"),
    ROW(a_scan_takes_the_place_of_what_was_there,
        "see:0:100 see:45:100 scan 0=900,1,1 1=0,0,0 2=800,1,1 4=0,0,0 6=700,1,1"),
    /* ---- Packets ---- */
    ROW(packets_add_their_points, "P 0=300,1,1 1=0,1,0 2=200,1,1"),
    ROW(what_precedes_the_first_start_packet_is_no_revolution, "P S:250 P 0=250,2,2"),
    ROW(a_start_packet_ends_a_revolution_and_begins_another,
        "S:100 P S!:250 0=100,2,2 2=200,1,1 P 0=250,2,2 S!:150 0=250,2,2"),
    ROW(a_packet_that_dma_has_overwritten_adds_nothing, "dma lost add 0=0,0,0 2=0,0,0"),
    ROW(a_start_packet_that_dma_has_overwritten_leaves_nothing_of_the_one_before,
        "dma S:100 lost:200 add! 0=100,1,1 add! 0=0,1,0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* -------------------------------------------------------------------------------------- limits */

void test_65535_sectors_do_not_overflow(void)
{
    sectors.count = 65535;
    TEST_ASSERT_EQUAL_size_t(32768, tmini_sectors_at(&sectors, 11520)); /* 32767.5 */
    TEST_ASSERT_EQUAL_size_t(65532, tmini_sectors_at(&sectors, 23039)); /* 65532.16 */
    sectors.count = 8;
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
