/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Points in the robot's directions, for a lidar that is mounted turned or upside down, or that sees
 * the robot itself. */

#include "rows.h"

#include "tmini/tmini_mount.h"
#include "unity.h"

#include <stdlib.h>

#define DEGREE 64

static tmini_mount_t mount;
static tmini_arc_t arcs[258];

void setUp(void)
{
    mount = (tmini_mount_t){.masked = arcs};
}

/* Words of the rows. Angles are sixty-fourths of a degree, with "d" degrees: 10d-1.
 *
 *     front:90d offset:69 min:100 max:5000 upside-down    the mount
 *     mask:-10:10     one more arc, in degrees
 *     100d,1001=10d,1001      what a point of this angle and distance becomes
 *     100d=10d        the robot's angle for an angle of the lidar */

static void add_arc(const char *text)
{
    arcs[mount.masked_count].from_deg = (int16_t)strtol(text, NULL, 10);
    arcs[mount.masked_count++].to_deg = (int16_t)strtol(row_text(text), NULL, 10);
}

static void expect_point(const char *word)
{
    char *rest;
    tmini_point_t point = {(uint16_t)row_angle(word, &rest), 0, 10, 3};
    tmini_scan_t scan = {.points = &point, .count = 1};
    if (*rest == '=') {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(row_angle(rest + 1, &rest),
                                         tmini_mount_angle(&mount, point.angle_q6), word);
        return;
    }
    point.distance_mm = (uint16_t)strtoul(rest + 1, &rest, 10);
    tmini_mount_step(&mount, &scan);
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(row_angle(rest + 1, &rest), point.angle_q6, word);
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(strtoul(rest + 1, NULL, 10), point.distance_mm, word);
    TEST_ASSERT_EQUAL_UINT8(10, point.intensity);
    TEST_ASSERT_EQUAL_UINT8(3, point.flag);
    TEST_ASSERT_EQUAL_UINT16(1, scan.count);
    TEST_ASSERT_EQUAL(mount.upside_down, scan.upside_down);
}

static void tell_word(char *word)
{
    char *rest;
    const int16_t number = (int16_t)row_angle(row_text(word), &rest);
    if (row_is(word, "front")) {
        mount.front_q6 = number;
    } else if (row_is(word, "offset")) {
        mount.offset_mm = number;
    } else if (row_is(word, "min")) {
        mount.min_mm = (uint16_t)number;
    } else if (row_is(word, "max")) {
        mount.max_mm = (uint16_t)number;
    } else if (row_is(word, "upside-down")) {
        mount.upside_down = true;
    } else if (row_is(word, "mask")) {
        add_arc(row_text(word));
    } else {
        expect_point(word);
    }
}

static const row_t rows[] IN_FLASH = {
    ROW(a_mount_of_zeros_changes_nothing, "0,0=0,0 23039,16383=23039,16383"),
    ROW(a_lidar_mounted_turned_is_turned_back, /* A point at 100 is 10 degrees to its right. */
        "front:90d 90d,1000=0,1000 100d,1001=10d,1001 89d,1002=359d,1002 0,1003=270d,1003"),
    /* Seen from above, the angles of a hanging lidar run counter-clockwise. */
    ROW(a_lidar_upside_down_is_mirrored,
        "upside-down 0,1000=0,1000 10d,1001=350d,1001 350d,1002=10d,1002"),
    ROW(a_lidar_upside_down_and_turned_is_mirrored_about_the_front,
        "front:30d upside-down 30d,1000=0,1000 40d,1001=350d,1001 20d,1002=10d,1002 "
        "60d,1003=330d,1003"),
    ROW(distances_out_of_range_become_unknown,
        "min:100 max:5000 0,99=0,0 1,100=1,100 2,5000=2,5000 3,5001=3,0 4,0=4,0"),
    ROW(without_a_largest_distance_none_is_too_far, "min:1 0,16383=0,16383"),
    ROW(an_arc_masks_the_directions_from_its_beginning_to_its_end,
        "mask:10:20 10d-1,1000=10d-1,1000 10d,1001=10d,0 20d,1002=20d,0 20d+1,1003=20d+1,1003"),
    ROW(an_arc_may_go_through_the_front, "mask:100:110 mask:350:10 350d-1,1000=350d-1,1000 "
                                         "350d,1001=350d,0 0,1002=0,0 10d,1003=10d,0 "
                                         "10d+1,1004=10d+1,1004"),
    /* The lidar hangs and sees a mast at 120 degrees, which is 60 degrees for the robot. */
    ROW(arcs_are_the_robots_directions,
        "front:180d upside-down mask:59:61 120d,300=60d,0 60d,1001=120d,1001"),
    /* For users who count angles to the left as negative. */
    ROW(arcs_and_front_may_be_negative,
        "front:-90d mask:-10:10 mask:-190:-170 270d,1000=0,0 281d,1001=11d,1001 "
        "259d,1002=349d,1002 100d,1003=190d,0 79d,1004=169d,1004"),
    ROW(an_arc_may_be_a_single_direction, "mask:90:90 90d,1000=90d,0 90d+1,1001=90d+1,1001"),
    ROW(an_arc_may_be_the_whole_circle_from_behind, "mask:-180:180 90d+1,1001=90d+1,0"),
    ROW(an_arc_may_be_the_whole_circle_from_the_front, "mask:0:360 90d,1000=90d,0"),
    ROW(any_number_of_degrees_is_an_arc, /* -8, 7 and -1. */
        "mask:-32768:-32768 mask:32767:32767 mask:-1:-1 352d,1000=352d,0 7d,1001=7d,0 "
        "8d,1002=8d,1002 359d,1003=359d,0"),
    ROW(an_offset_is_added_to_ranges_and_not_to_what_is_unknown,
        "offset:69 min:169 max:5069 0,0=0,0 1,99=1,0 2,100=2,169 3,5000=3,5069 4,5001=4,0"),
    ROW(an_offset_leaves_a_range_a_range, "offset:-32768 0,16383=0,1"),
    ROW(an_offset_leaves_a_range_in_its_bits, "offset:32767 0,1=0,16383"),
    ROW(an_offset_of_the_largest_range_leaves_1_mm, "offset:-16383 0,16383=0,1"),
    ROW(a_front_may_be_any_number_of_sixty_fourths_of_a_degree, /* 512 to the left are 152. */
        "front:-32768 0=152d 23039=152d-1 upside-down 0=208d"),
    ROW(a_front_may_be_to_the_right, /* 87.4 degrees. */
        "front:32767 0=208d+1 23039=208d front:5594 5600=6 5594=0 5593=23039"),
    ROW(full_circles_are_no_angle, "front:-1d 0=1d 359d=0"),
    ROW(more_than_256_arcs_are_masked,
        "max:5000 256( mask:0:0 ) mask:90:90 1d,5001=1d,0 90d,1000=90d,0 91d,1000=91d,1000"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

void test_more_than_256_points_are_mounted_and_none_after_them(void)
{
    static tmini_point_t points[258];
    tmini_scan_t scan = {.points = points, .count = 257};
    for (unsigned i = 0; i < 258; i++) {
        points[i] = (tmini_point_t){DEGREE, 5001, 0, 0};
    }
    mount.max_mm = 5000;
    tmini_mount_step(NULL, &scan);
    TEST_ASSERT_EQUAL_UINT16(5001, points[0].distance_mm);
    tmini_mount_step(&mount, &scan);
    for (unsigned i = 0; i < 258; i++) {
        TEST_ASSERT_EQUAL_UINT16(i < 257 ? 0 : 5001, points[i].distance_mm);
    }
}

/* Too large for a small machine. */
void test_65537_arcs_are_masked(void)
{
#if defined(__linux__)
    static tmini_arc_t many[65537];
    many[65536] = (tmini_arc_t){90, 90};
    mount = (tmini_mount_t){.min_mm = 300, .masked = many, .masked_count = 65537};
    row_tell("90d,1000=90d,0 91d,300=91d,300 92d,299=92d,0", tell_word);
#endif
}
