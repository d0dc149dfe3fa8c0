/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Isolated points, and several steps in their order. */

#include "rows.h"

#include "tmini/tmini_isolated.h"
#include "tmini/tmini_mount.h"
#include "tmini/tmini_steps.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define POINTS 300

static tmini_point_t points[POINTS];
static bool is_isolated[POINTS]; /* As the row says. */
static tmini_scan_t scan;
static tmini_isolated_t isolated;

void setUp(void)
{
    memset(points, 0, sizeof points);
    scan = (tmini_scan_t){.points = points};
    isolated = (tmini_isolated_t){0};
}

/* Words of the rows. At 1 m points a degree apart are 17.4 mm apart.
 *
 *     1000 1000!      points with this distance, a degree apart; with "!", it loses its range
 *     1000@180        at this angle
 *     near:5 percent:2    values that are given
 *     step            what has been told happens to the scan; another one may follow */

static void step(void)
{
    tmini_point_t expected[POINTS];
    memcpy(expected, points, sizeof points);
    for (unsigned i = 0; i < scan.count; i++) {
        expected[i].distance_mm = is_isolated[i] ? 0 : points[i].distance_mm;
    }
    tmini_isolated_step(isolated.near_mm > 0 ? &isolated : NULL, &scan);
    for (unsigned i = 0; i < POINTS; i++) {
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(expected[i].distance_mm, points[i].distance_mm, "range");
        TEST_ASSERT_EQUAL_MEMORY(&expected[i], &points[i], sizeof points[i]);
    }
    scan.count = 0;
}

static void tell_word(char *word)
{
    char *rest;
    const uint16_t distance_mm = (uint16_t)strtoul(word, &rest, 10);
    if (row_is(word, "near")) {
        isolated.near_mm = (uint16_t)row_number(word);
    } else if (row_is(word, "percent")) {
        isolated.percent = (uint8_t)row_number(word);
    } else if (row_is(word, "step")) {
        step();
    } else {
        const unsigned degrees =
            rest[0] == '@' ? (unsigned)strtoul(rest + 1, &rest, 10) : scan.count;
        is_isolated[scan.count] = rest[0] == '!';
        points[scan.count++] = (tmini_point_t){(uint16_t)(degrees * 64u), distance_mm, 7, 2};
    }
}

static const row_t rows[] IN_FLASH = {
    ROW(a_point_without_a_near_neighbour_loses_its_range,
        "3000 3000 1000! 3000 3000 step 0 0 1000! 0 0 step 0 0 0 0 0 step 3000 3000 1! 3000 3000 "
        "step"),
    ROW(one_neighbour_on_either_side_is_enough, /* Also the next but one. */
        "3000 1000 1000 3000 3000 step 3000 3000 1000 1000 3000 step 1000 3000 1000 3000 3000 step "
        "3000 3000 1000 3000 1000 step 3000 1 1 3000 3000 step"),
    ROW(no_range_is_not_near, "3000 0 40! 3000 3000 step"),
    ROW(near_is_50_mm_and_6_percent_less_what_the_angle_takes, /* 50 + 60 - 17 = 93 mm. */
        "3000 1093 1000 3000 3000 step 3000 1094! 1000! 3000 3000 step 3000 915 1000 3000 3000 "
        "step 3000 908! 1000! 3000 3000 step"), /* 6 % of 908 mm are less. */
    ROW(the_distance_grows_with_the_range,      /* 50 + 480 - 140 = 390 mm. */
        "300 8355 8000 300 300 step 300 8395! 8000! 300 300 step"),
    ROW(both_values_may_be_given, /* 25 - 17 = 8 mm; 4550 - 17 mm. */
        "near:5 percent:2 3000! 1007 1000 3000 3000 step 3000! 1009! 1000! 3000 3000 step "
        "near:2000 percent:255 9999 5515 1000 9999 9999 step 9999 5535 1000! 9999 9999 step"),
    ROW(the_last_point_is_next_to_the_first, /* Whichever comes first. */
        "1000 3000! 5000! 7000! 1000@359 step"),
    ROW(points_that_are_next_in_order_but_not_in_angle_are_no_neighbours, /* Packets were lost. */
        "1000! 1000@180! step"),
    ROW(a_point_is_not_its_own_neighbour, "1000 1000 step 1000! step 1000! 5000! step"),
    ROW(the_third_point_away_is_no_neighbour, "1000! 3000! 5000! 1000! 7000! 9000! 11000! step"),
    ROW(a_scan_may_have_more_than_256_points, /* The only neighbour of point 294 comes after it. */
        "294( 1000 ) 500 500 1000 1000 5000! 1000 step"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* --------------------------------------------------------------------------------------- steps */

static const uint16_t one = 1;
static const uint16_t two = 2;

static void append(const void *digit, tmini_scan_t *changed)
{
    tmini_point_t *const point = &changed->points[0];
    point->distance_mm = (uint16_t)(point->distance_mm * 10 + *(const uint16_t *)digit);
}

void test_steps_are_called_in_the_order_given(void)
{
    static const tmini_one_step_t list[] = {{append, &one}, {NULL, &one}, {append, &two}};
    static const tmini_steps_t steps = {list, 3};
    row_tell("9", tell_word);
    tmini_steps_step(&steps, &scan);
    TEST_ASSERT_EQUAL_UINT16(912, points[0].distance_mm);
    tmini_steps_step(NULL, &scan);
    TEST_ASSERT_EQUAL_UINT16(912, points[0].distance_mm);
}

/* What is masked is no neighbour. */
void test_the_mounting_comes_before_the_filter(void)
{
    static const tmini_arc_t mast[] = {{90, 90}};
    static const tmini_mount_t mount = {.front_q6 = -89 * 64, .masked = mast, .masked_count = 1};
    static const tmini_one_step_t list[] = {{tmini_mount_step, &mount},
                                            {tmini_isolated_step, NULL}};
    static const tmini_steps_t steps = {list, 2};
    row_tell("1000 1000", tell_word); /* 89 degrees; 90. */
    tmini_steps_step(&steps, &scan);
    TEST_ASSERT_EQUAL_UINT16(0, points[0].distance_mm);
    TEST_ASSERT_EQUAL_UINT16(0, points[1].distance_mm);
}
