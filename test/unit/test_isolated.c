/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Isolated points, and several steps in their order. */

#include "tmini/tmini_isolated.h"
#include "tmini/tmini_mount.h"
#include "tmini/tmini_steps.h"
#include "unity.h"

static tmini_point_t points[300];
static tmini_scan_t scan;

void setUp(void)
{
    scan = (tmini_scan_t){.points = points};
}

void tearDown(void) {}

/* Points are a degree apart. */
static void add(uint16_t distance_mm)
{
    points[scan.count] = (tmini_point_t){(uint16_t)(scan.count * 64u), distance_mm, 7, 2};
    scan.count++;
}

static void has(size_t index, uint16_t distance_mm)
{
    TEST_ASSERT_EQUAL_UINT16(distance_mm, points[index].distance_mm);
}

/* At 1 m points a degree apart are 17.4 mm apart. */
typedef struct {
    uint16_t distances_mm[5]; /* The last ones far away from the first. */
    uint16_t left_mm;         /* Of the third one. */
} case_t;

static void check_cases(const tmini_isolated_t *isolated, const case_t *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        setUp();
        for (size_t j = 0; j < 5; j++) {
            add(cases[i].distances_mm[j]);
        }
        tmini_isolated_step(isolated, &scan);
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(cases[i].left_mm, points[2].distance_mm, "of the case");
        TEST_ASSERT_EQUAL_UINT16(128, points[2].angle_q6);
        TEST_ASSERT_EQUAL_UINT8(7, points[2].intensity);
        TEST_ASSERT_EQUAL_UINT8(2, points[2].flag);
    }
}

void test_a_point_without_a_near_neighbour_loses_its_range(void)
{
    static const case_t cases[] = {
        {{3000, 3000, 1000, 3000, 3000}, 0},
        {{0, 0, 1000, 0, 0}, 0},
        {{0, 0, 0, 0, 0}, 0},
        {{3000, 1000, 1000, 3000, 3000}, 1000}, /* One neighbour on either side is enough, */
        {{3000, 3000, 1000, 1000, 3000}, 1000},
        {{1000, 3000, 1000, 3000, 3000}, 1000}, /* also the next but one. */
        {{3000, 3000, 1000, 3000, 1000}, 1000},
        {{3000, 3000, 1, 3000, 3000}, 0},
        {{3000, 1, 1, 3000, 3000}, 1},
        {{3000, 0, 40, 3000, 3000}, 0},         /* No range is not near. */
        {{3000, 1093, 1000, 3000, 3000}, 1000}, /* 50 mm + 6 % of 1000 mm - 17 mm = 93 mm */
        {{3000, 1094, 1000, 3000, 3000}, 0},
        {{3000, 908, 1000, 3000, 3000}, 0}, /* 6 % of 908 mm are less. */
        {{3000, 915, 1000, 3000, 3000}, 1000},
    };
    check_cases(NULL, cases, sizeof cases / sizeof cases[0]);
}

void test_the_distance_grows_with_the_range(void)
{
    static const case_t cases[] = {
        {{300, 8355, 8000, 300, 300}, 8000}, /* 50 + 480 - 140 = 390 mm */
        {{300, 8395, 8000, 300, 300}, 0},
    };
    check_cases(NULL, cases, sizeof cases / sizeof cases[0]);
}

void test_both_values_may_be_given(void)
{
    static const tmini_isolated_t narrow = {.near_mm = 5, .percent = 2};
    static const tmini_isolated_t wide = {.near_mm = 2000, .percent = 255};
    static const case_t narrowly[] = {{{3000, 1007, 1000, 3000, 3000}, 1000}, /* 25 - 17 = 8 mm */
                                      {{3000, 1009, 1000, 3000, 3000}, 0}};
    static const case_t widely[] = {{{9999, 5515, 1000, 9999, 9999}, 1000}, /* 4550 - 17 mm */
                                    {{9999, 5535, 1000, 9999, 9999}, 0}};
    check_cases(&narrow, narrowly, 2);
    check_cases(&wide, widely, 2);
}

/* Of two points at 0 and 359 degrees each is the other's neighbour, whichever comes first. */
void test_the_last_point_is_next_to_the_first(void)
{
    add(1000);
    add(3000);
    add(5000);
    add(7000);
    add(1000);
    points[4].angle_q6 = 359 * 64;
    tmini_isolated_step(NULL, &scan);
    has(0, 1000);
    has(1, 0);
    has(2, 0);
    has(3, 0);
    has(4, 1000);
}

/* Packets between them were lost. */
void test_points_that_are_next_in_order_but_not_in_angle_are_no_neighbours(void)
{
    add(1000);
    add(1000);
    points[1].angle_q6 = 180 * 64;
    tmini_isolated_step(NULL, &scan);
    has(0, 0);
    has(1, 0);
}

void test_a_point_is_not_its_own_neighbour(void)
{
    scan.points = &points[1];
    points[1] = (tmini_point_t){0, 1000, 0, 0};
    points[0] = points[2] = points[1];
    scan.count = 1;
    tmini_isolated_step(NULL, &scan);
    has(1, 0);
    has(2, 1000); /* Not in the scan. */
    points[1].distance_mm = 1000;
    points[2] = (tmini_point_t){64, 5000, 0, 0};
    scan.count = 2;
    tmini_isolated_step(NULL, &scan);
    has(1, 0);
    has(2, 0);
}

void test_the_third_point_away_is_no_neighbour(void)
{
    static const uint16_t distances_mm[] = {1000, 3000, 5000, 1000, 7000, 9000, 11000};
    for (size_t i = 0; i < 7; i++) {
        add(distances_mm[i]);
    }
    tmini_isolated_step(NULL, &scan);
    for (size_t i = 0; i < 7; i++) {
        has(i, 0);
    }
}

void test_a_scan_may_have_more_than_256_points(void)
{
    for (uint16_t i = 0; i < 300; i++) {
        add(i == 294 || i == 295 ? 500 : i == 298 ? 5000 : 1000);
    }
    tmini_isolated_step(NULL, &scan);
    has(294, 500); /* Its only neighbour comes after it. */
    has(295, 500);
    has(297, 1000);
    has(298, 0);
    has(299, 1000);
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
    add(9);
    tmini_steps_step(&steps, &scan);
    has(0, 912);
    tmini_steps_step(NULL, &scan);
    has(0, 912);
}

/* What is masked is no neighbour. */
void test_the_mounting_comes_before_the_filter(void)
{
    static const tmini_arc_t mast[] = {{90, 90}};
    static const tmini_mount_t mount = {.front_q6 = -89 * 64, .masked = mast, .masked_count = 1};
    static const tmini_one_step_t list[] = {{tmini_mount_step, &mount},
                                            {tmini_isolated_step, NULL}};
    static const tmini_steps_t steps = {list, 2};
    add(1000); /* 89 degrees. */
    add(1000);
    tmini_steps_step(&steps, &scan);
    has(0, 0);
    has(1, 0);
}
