/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Points in the robot's directions, for a lidar that is mounted turned or upside down, or that sees
 * the robot itself. */

#include "tmini/tmini_mount.h"
#include "unity.h"

#define DEGREE 64u

static tmini_point_t points[257];
static size_t count;

void setUp(void)
{
    count = 0;
}

void tearDown(void) {}

static void add(uint16_t angle_q6, uint16_t distance_mm)
{
    points[count] =
        (tmini_point_t){angle_q6, distance_mm, (uint8_t)(10 + count), (uint8_t)(count % 4)};
    count++;
}

static void is_point(size_t index, uint16_t angle_q6, uint16_t distance_mm)
{
    TEST_ASSERT_EQUAL_UINT16(angle_q6, points[index].angle_q6);
    TEST_ASSERT_EQUAL_UINT16(distance_mm, points[index].distance_mm);
}

static void apply(const tmini_mount_t *mount)
{
    tmini_scan_t scan = {.points = points, .count = (uint16_t)count};
    tmini_mount_step(mount, &scan);
    TEST_ASSERT_EQUAL_UINT16(count, scan.count);
    TEST_ASSERT_EQUAL_INT(mount->upside_down, scan.upside_down);
}

void test_a_mount_of_zeros_changes_nothing(void)
{
    static const tmini_mount_t mount = {0};
    add(0, 0);
    add(23039, 16383);
    apply(&mount);
    is_point(0, 0, 0);
    is_point(1, 23039, 16383);
    TEST_ASSERT_EQUAL_UINT8(11, points[1].intensity);
    TEST_ASSERT_EQUAL_UINT8(1, points[1].flag);
}

/* The lidar's 90 degrees are the front, so a point at 100 is 10 degrees to the right of the
 * front. */
void test_a_lidar_mounted_turned_is_turned_back(void)
{
    static const tmini_mount_t mount = {.front_q6 = 90 * 64};
    add(90 * DEGREE, 1000);
    add(100 * DEGREE, 1001);
    add(89 * DEGREE, 1002);
    add(0, 1003);
    apply(&mount);
    is_point(0, 0, 1000);
    is_point(1, 10 * DEGREE, 1001);
    is_point(2, 359 * DEGREE, 1002);
    is_point(3, 270 * DEGREE, 1003);
}

/* Seen from above, the angles of a hanging lidar run counter-clockwise. */
void test_a_lidar_upside_down_is_mirrored(void)
{
    static const tmini_mount_t mount = {.upside_down = true};
    add(0, 1000);
    add(10 * DEGREE, 1001);
    add(350 * DEGREE, 1002);
    apply(&mount);
    is_point(0, 0, 1000);
    is_point(1, 350 * DEGREE, 1001);
    is_point(2, 10 * DEGREE, 1002);
}

void test_a_lidar_upside_down_and_turned_is_mirrored_about_the_front(void)
{
    static const tmini_mount_t mount = {.front_q6 = 30 * 64, .upside_down = true};
    add(30 * DEGREE, 1000);
    add(40 * DEGREE, 1001);
    add(20 * DEGREE, 1002);
    apply(&mount);
    is_point(0, 0, 1000);
    is_point(1, 350 * DEGREE, 1001);
    is_point(2, 10 * DEGREE, 1002);
    TEST_ASSERT_EQUAL_UINT16(330 * DEGREE, tmini_mount_angle(&mount, 60 * DEGREE));
}

void test_distances_out_of_range_become_unknown(void)
{
    static const tmini_mount_t mount = {.min_mm = 100, .max_mm = 5000};
    add(0, 99);
    add(1, 100);
    add(2, 5000);
    add(3, 5001);
    add(4, 0);
    apply(&mount);
    is_point(0, 0, 0);
    is_point(1, 1, 100);
    is_point(2, 2, 5000);
    is_point(3, 3, 0);
    is_point(4, 4, 0);
}

void test_without_a_largest_distance_none_is_too_far(void)
{
    static const tmini_mount_t mount = {.min_mm = 1};
    add(0, 16383);
    apply(&mount);
    is_point(0, 0, 16383);
}

void test_an_arc_masks_the_directions_from_its_beginning_to_its_end(void)
{
    static const tmini_arc_t arcs[] = {{10, 20}};
    static const tmini_mount_t mount = {.masked = arcs, .masked_count = 1};
    add(10 * DEGREE - 1, 1000);
    add(10 * DEGREE, 1001);
    add(20 * DEGREE, 1002);
    add(20 * DEGREE + 1, 1003);
    apply(&mount);
    is_point(0, 10 * DEGREE - 1, 1000);
    is_point(1, 10 * DEGREE, 0);
    is_point(2, 20 * DEGREE, 0);
    is_point(3, 20 * DEGREE + 1, 1003);
}

void test_an_arc_may_go_through_the_front(void)
{
    static const tmini_arc_t arcs[] = {{100, 110}, {350, 10}};
    static const tmini_mount_t mount = {.masked = arcs, .masked_count = 2};
    add(350 * DEGREE - 1, 1000);
    add(350 * DEGREE, 1001);
    add(0, 1002);
    add(10 * DEGREE, 1003);
    add(10 * DEGREE + 1, 1004);
    apply(&mount);
    is_point(0, 350 * DEGREE - 1, 1000);
    is_point(1, 350 * DEGREE, 0);
    is_point(2, 0, 0);
    is_point(3, 10 * DEGREE, 0);
    is_point(4, 10 * DEGREE + 1, 1004);
}

/* The lidar hangs and sees a mast at 120 degrees, which is 60 degrees for the robot. */
void test_arcs_are_the_robots_directions(void)
{
    static const tmini_arc_t arcs[] = {{59, 61}};
    static const tmini_mount_t mount = {
        .front_q6 = 180 * 64, .upside_down = true, .masked = arcs, .masked_count = 1};
    add(120 * DEGREE, 300);
    add(60 * DEGREE, 1001);
    apply(&mount);
    is_point(0, 60 * DEGREE, 0);
    is_point(1, 120 * DEGREE, 1001);
}

/* For users who count angles to the left as negative. */
void test_arcs_and_front_may_be_negative(void)
{
    static const tmini_arc_t arcs[] = {{-10, 10}, {-190, -170}};
    static const tmini_mount_t mount = {.front_q6 = -90 * 64, .masked = arcs, .masked_count = 2};
    add(270 * DEGREE, 1000);
    add(281 * DEGREE, 1001);
    add(259 * DEGREE, 1002);
    add(100 * DEGREE, 1003);
    add(79 * DEGREE, 1004);
    apply(&mount);
    is_point(0, 0, 0);
    is_point(1, 11 * DEGREE, 1001);
    is_point(2, 349 * DEGREE, 1002);
    is_point(3, 190 * DEGREE, 0);
    is_point(4, 169 * DEGREE, 1004);
}

void test_an_arc_may_be_the_whole_circle_or_a_single_direction(void)
{
    static const tmini_arc_t all[] = {{0, 360}};
    static const tmini_arc_t one[] = {{-180, 180}, {90, 90}};
    tmini_mount_t mount = {.masked = one + 1, .masked_count = 1};
    add(90 * DEGREE, 1000);
    add(90 * DEGREE + 1, 1001);
    apply(&mount);
    is_point(0, 90 * DEGREE, 0);
    is_point(1, 90 * DEGREE + 1, 1001);
    mount.masked = one;
    apply(&mount);
    is_point(1, 90 * DEGREE + 1, 0);
    points[0].distance_mm = 1000;
    mount.masked = all;
    apply(&mount);
    is_point(0, 90 * DEGREE, 0);
}

void test_a_front_may_be_any_number_of_sixty_fourths_of_a_degree(void)
{
    tmini_mount_t mount = {.front_q6 = -32768}; /* 512 degrees to the left are 152. */
    TEST_ASSERT_EQUAL_UINT16(152 * DEGREE, tmini_mount_angle(&mount, 0));
    TEST_ASSERT_EQUAL_UINT16(152 * DEGREE - 1, tmini_mount_angle(&mount, 23039));
    mount.upside_down = true;
    TEST_ASSERT_EQUAL_UINT16(208 * DEGREE, tmini_mount_angle(&mount, 0));
    mount = (tmini_mount_t){.front_q6 = 32767};
    TEST_ASSERT_EQUAL_UINT16(208 * DEGREE + 1, tmini_mount_angle(&mount, 0));
    TEST_ASSERT_EQUAL_UINT16(208 * DEGREE, tmini_mount_angle(&mount, 23039));
    mount = (tmini_mount_t){.front_q6 = 5594}; /* 87.4 degrees. */
    TEST_ASSERT_EQUAL_UINT16(6, tmini_mount_angle(&mount, 5600));
    TEST_ASSERT_EQUAL_UINT16(0, tmini_mount_angle(&mount, 5594));
    TEST_ASSERT_EQUAL_UINT16(23039, tmini_mount_angle(&mount, 5593));
}

void test_any_number_of_degrees_is_an_arc(void)
{
    static const tmini_arc_t arcs[] = {{-32768, -32768}, {32767, 32767}, {-1, -1}}; /* -8, 7. */
    static const tmini_mount_t mount = {.masked = arcs, .masked_count = 3};
    add(352 * DEGREE, 1000);
    add(7 * DEGREE, 1001);
    add(8 * DEGREE, 1002);
    apply(&mount);
    is_point(0, 352 * DEGREE, 0);
    is_point(1, 7 * DEGREE, 0);
    is_point(2, 8 * DEGREE, 1002);
    points[2].angle_q6 = 359 * DEGREE;
    apply(&mount);
    is_point(2, 359 * DEGREE, 0);
}

void test_an_offset_is_added_to_ranges_and_not_to_what_is_unknown(void)
{
    tmini_mount_t mount = {.offset_mm = 69, .min_mm = 169, .max_mm = 5069};
    add(0, 0);
    add(1, 99);
    add(2, 100);
    add(3, 5000);
    add(4, 5001);
    apply(&mount);
    is_point(0, 0, 0);
    is_point(1, 1, 0);
    is_point(2, 2, 169);
    is_point(3, 3, 5069);
    is_point(4, 4, 0);
}

void test_an_offset_leaves_a_range_a_range(void)
{
    tmini_mount_t mount = {.offset_mm = -32768};
    add(0, 16383);
    apply(&mount);
    is_point(0, 0, 1);
    mount.offset_mm = 32767;
    apply(&mount);
    is_point(0, 0, 16383);
    mount.offset_mm = -16383;
    apply(&mount);
    is_point(0, 0, 1);
}

void test_full_circles_are_no_angle(void)
{
    static const tmini_mount_t mount = {.front_q6 = -1 * 64};
    TEST_ASSERT_EQUAL_UINT16(1 * DEGREE, tmini_mount_angle(&mount, 0));
    TEST_ASSERT_EQUAL_UINT16(0, tmini_mount_angle(&mount, 359 * DEGREE));
}

void test_more_than_256_points_are_mounted_and_more_than_256_arcs_masked(void)
{
    static tmini_arc_t arcs[257];
    const tmini_mount_t mount = {.max_mm = 5000, .masked = arcs, .masked_count = 257};
    arcs[256] = (tmini_arc_t){90, 90};
    for (unsigned i = 0; i < 255; i++) {
        add(DEGREE, 5001);
    }
    add(90 * DEGREE, 1000);
    add(91 * DEGREE, 1000);
    apply(&mount);
    is_point(0, DEGREE, 0);
    is_point(254, DEGREE, 0);
    is_point(255, 90 * DEGREE, 0);
    is_point(256, 91 * DEGREE, 1000);
}

/* Too large for a small machine. */
void test_65537_arcs_are_masked(void)
{
#if defined(__linux__)
    static tmini_arc_t arcs[65537];
    const tmini_mount_t mount = {.min_mm = 300, .masked = arcs, .masked_count = 65537};
    arcs[65536] = (tmini_arc_t){90, 90};
    add(90 * DEGREE, 1000);
    add(91 * DEGREE, 300);
    add(92 * DEGREE, 299);
    apply(&mount);
    is_point(0, 90 * DEGREE, 0);
    is_point(1, 91 * DEGREE, 300);
    is_point(2, 92 * DEGREE, 0);
#endif
}

void test_no_points_and_no_mount_change_nothing(void)
{
    static const tmini_mount_t mount = {.front_q6 = 1 * 64};
    tmini_scan_t scan = {.points = points, .count = 1};
    points[0] = (tmini_point_t){7, 1000, 0, 0};
    apply(&mount);
    is_point(0, 7, 1000);
    add(7, 1000);
    tmini_mount_step(NULL, &scan);
    is_point(0, 7, 1000);
}
