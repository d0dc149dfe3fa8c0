/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Sectors: the sector of an angle, and the nearest obstacle in a sector. */

#include "encoder.h"
#include "receiver.h"
#include "rows.h"

#include "tmini/tmini_sectors.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define DEGREE 64u

static tmini_sector_t array[9];
static tmini_sectors_t sectors;
static uint8_t memory[512];
static uint8_t bytes[300];
static receiver_t receiver;
static tmini_point_t points[4];
static tmini_scan_t scan;

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
    scan = (tmini_scan_t){.points = points};
    receiver_open(&receiver, memory, sizeof memory, 0);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_HEX16(0xEEEE, array[8].nearest_mm);
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows. Angles are sixty-fourths of a degree, with "d" degrees: 60d-1.
 *
 *     sectors:3:4     three sectors, and this filter
 *     no:0:0          they are refused
 *     count:65535     as if there were this many
 *     see:45d:1000    a point at this angle, with this distance; see:45d:1000:2 with this flag
 *     point:0d:900 scan:1     such a point of a scan; the scan, which has only its first point
 *     clear           forgets all points
 *     dma             packets come by DMA
 *     S:100           a start packet at 0 degrees, with this distance; S!:100: ends a revolution
 *     P               a packet of points at 0, 45 and 90 degrees: 300 mm, no range, 200 mm
 *     lost:100 lost   such packets come, and DMA overwrites them
 *     + +!            the last packet is added, which ends no revolution, or one
 *     at:60d:1        the angle belongs to this sector
 *     0=300,2,1       what a sector holds: nearest range, points, ranges
 *     angle:0:10d     the angle of a sector's nearest range
 *     free:0:300 not-free:0:301       whether a sector is free up to this distance */

static uint16_t angle_of(const char *text)
{
    char *rest;
    return (uint16_t)row_angle(text, &rest);
}

static tmini_point_t point_of(const char *text)
{
    const char *const distance = row_text(text);
    return (tmini_point_t){angle_of(text), (uint16_t)strtoul(distance, NULL, 10), 100,
                           (uint8_t)row_number(distance)};
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
    const tmini_point_t point = point_of(text);
    if (row_is(word, "see")) {
        tmini_sectors_add(&sectors, &point);
    } else if (row_is(word, "point")) {
        points[scan.count++] = point;
    } else if (word[0] >= '0' && word[0] <= '9') {
        holds(word);
    } else if (row_is(word, "sectors")) {
        begin(row_number(word), second);
    } else if (row_is(word, "no")) {
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT,
                              tmini_sectors_init(&sectors, array, row_number(word), second));
    } else if (row_is(word, "count")) {
        sectors.count = row_number(word);
    } else if (row_is(word, "scan")) {
        scan.count = (uint16_t)row_number(word);
        tmini_sectors_add_scan(&sectors, &scan);
    } else if (row_is(word, "clear")) {
        tmini_sectors_clear(&sectors);
    } else if (row_is(word, "dma")) {
        receiver_open_dma(&receiver, memory, sizeof memory, 0);
    } else if (row_is(word, "lost")) {
        receive((uint16_t)row_number(word));
        receiver_feed(&receiver, bytes, sizeof bytes);
    } else if (strchr("SP+", word[0]) != NULL) {
        if (word[0] != '+') {
            receive((uint16_t)row_number(word));
        }
        TEST_ASSERT_EQUAL_MESSAGE(word[1] == '!',
                                  tmini_sectors_add_packet(&sectors, &receiver.packet), word);
    } else if (row_is(word, "at")) {
        TEST_ASSERT_EQUAL_size_t_MESSAGE(second, tmini_sectors_at(&sectors, angle_of(text)), word);
    } else if (row_is(word, "angle")) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(angle_of(row_text(text)), array[index].angle_q6, word);
    } else if (row_is(word, "free") || row_is(word, "not-free")) {
        TEST_ASSERT_EQUAL_MESSAGE(word[0] == 'f', tmini_sector_is_free(&array[index], second),
                                  word);
    } else {
        TEST_FAIL_MESSAGE(word);
    }
}

static const row_t rows[] IN_FLASH = {
    /* ---- Directions ---- */
    ROW(eight_sectors_go_clockwise_from_the_front,
        "see:0d:1000 see:45d:1001 see:90d:1002 see:135d:1003 see:180d:1004 see:225d:1005 "
        "see:270d:1006 see:315d:1007 0=1000,1,1 1=1001,1,1 2=1002,1,1 3=1003,1,1 4=1004,1,1 "
        "5=1005,1,1 6=1006,1,1 7=1007,1,1 angle:0:0 angle:1:45d angle:7:315d"),
    ROW(one_sector_holds_everything, "sectors:1 at:0d:0 at:180d:0 at:360d-1:0"),
    ROW(three_sectors_are_120_degrees_wide, /* A boundary belongs to the sector clockwise. */
        "sectors:3 at:60d-1:0 at:60d:1 at:180d-1:1 at:180d:2 at:300d-1:2 at:300d:0 at:360d-1:0"),
    ROW(numbers_of_65535_sectors_do_not_overflow, /* 32767.5, 65532.16. */
        "count:65535 at:180d:32768 at:360d-1:65532 count:8"),
    ROW(a_count_or_a_filter_out_of_range_is_refused,
        "no:0:0 no:8:2 no:8:16 no:65536:0 sectors:8:12"),
    /* ---- Points ---- */
    ROW(sectors_are_blind_to_begin_with, "0=0,0,0 3=0,0,0 7=0,0,0 not-free:0:0"),
    ROW(a_sector_has_its_nearest_range_and_the_angle_of_that,
        "see:0d:700 see:10d:500 see:20d:600 0=500,3,3 angle:0:10d"),
    ROW(points_without_a_range_leave_a_sector_blind_and_not_free,
        "see:0d:0 see:1d:0 0=0,2,0 not-free:0:300 not-free:0:0"),
    ROW(a_sector_is_free_up_to_its_nearest_range,
        "see:0d:0 see:0d:16383 see:0d:300 0=300,3,2 free:0:300 not-free:0:301"),
    ROW(one_range_is_enough_for_a_sector_to_be_free, "see:0d:300 free:0:300"),
    ROW(a_sector_counts_more_than_255_ranges, "300( see:0d:500 ) 0=500,300,300"),
    ROW(a_sector_with_65536_ranges_is_not_blind, /* As it would be if it counted 0. */
        "see:0d:200 257( 255( see:0d:500 ) ) 0=200,65535,65535 free:0:200"),
    ROW(flagged_points_count_unless_filtered, "see:0d:400:2 see:90d:500:3 0=400,1,1 2=500,1,1"),
    ROW(a_filter_takes_no_range_from_the_points_with_its_flag,
        "sectors:8:4 see:0d:400:2 see:90d:500:3 see:180d:600 0=0,1,0 2=500,1,1 4=600,1,1"),
    ROW(clearing_forgets_all_points, "see:0d:400 see:315d:500 clear 0=0,0,0 7=0,0,0"),
    ROW(a_scan_takes_the_place_of_what_was_there,
        "see:0d:100 see:45d:100 point:0d:900 point:90d:800 point:270d:700 point:180d:600 scan:3 "
        "0=900,1,1 1=0,0,0 2=800,1,1 4=0,0,0 6=700,1,1"),
    /* ---- Packets ---- */
    ROW(packets_add_their_points, "P 0=300,1,1 1=0,1,0 2=200,1,1"),
    ROW(what_precedes_the_first_start_packet_is_no_revolution, "P S:250 P 0=250,2,2"),
    ROW(a_start_packet_ends_a_revolution_and_begins_another,
        "S:100 P S!:250 0=100,2,2 2=200,1,1 P 0=250,2,2 S!:150 0=250,2,2"),
    ROW(a_packet_that_dma_has_overwritten_adds_nothing, "dma lost + 0=0,0,0 2=0,0,0"),
    ROW(a_start_packet_that_dma_has_overwritten_leaves_nothing_of_the_one_before,
        "dma S:100 lost:200 +! 0=100,1,1 +! 0=0,1,0"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* -------------------------------------------------------------------------------------- limits */

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

void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(NULL, array, 8, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_sectors_init(&sectors, NULL, 8, 0));
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
