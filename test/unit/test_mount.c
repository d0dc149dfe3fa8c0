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

/* What a mount makes of points: each is its angle and distance before and after. */
typedef struct {
    const char *claim;
    tmini_mount_t mount;
    tmini_arc_t arcs[3];
    uint16_t points[5][4];
} case_t;

#define D 64 /* Per degree. */
#define MASKED(arcs) .masked_count = arcs

static const case_t cases[] = {
    {"a mount of zeros changes nothing", {0}, {{0}}, {{0, 0, 0, 0}, {23039, 16383, 23039, 16383}}},
    /* The lidar's 90 degrees are the front; a point at 100 is 10 degrees to its right. */
    {"a lidar mounted turned is turned back",
     {.front_q6 = 90 * 64},
     {{0}},
     {{90 * D, 1000, 0, 1000},
      {100 * D, 1001, 10 * D, 1001},
      {89 * D, 1002, 359 * D, 1002},
      {0, 1003, 270 * D, 1003}}},
    /* Seen from above, the angles of a hanging lidar run counter-clockwise. */
    {"a lidar upside down is mirrored",
     {.upside_down = true},
     {{0}},
     {{0, 1000, 0, 1000}, {10 * D, 1001, 350 * D, 1001}, {350 * D, 1002, 10 * D, 1002}}},
    {"a lidar upside down and turned is mirrored about the front",
     {.front_q6 = 30 * 64, .upside_down = true},
     {{0}},
     {{30 * D, 1000, 0, 1000},
      {40 * D, 1001, 350 * D, 1001},
      {20 * D, 1002, 10 * D, 1002},
      {60 * D, 1003, 330 * D, 1003}}},
    {"distances out of range become unknown",
     {.min_mm = 100, .max_mm = 5000},
     {{0}},
     {{0, 99, 0, 0}, {1, 100, 1, 100}, {2, 5000, 2, 5000}, {3, 5001, 3, 0}, {4, 0, 4, 0}}},
    {"without a largest distance none is too far", {.min_mm = 1}, {{0}}, {{0, 16383, 0, 16383}}},
    {"an arc masks the directions from its beginning to its end",
     {MASKED(1)},
     {{10, 20}},
     {{10 * D - 1, 1000, 10 * D - 1, 1000},
      {10 * D, 1001, 10 * D, 0},
      {20 * D, 1002, 20 * D, 0},
      {20 * D + 1, 1003, 20 * D + 1, 1003}}},
    {"an arc may go through the front",
     {MASKED(2)},
     {{100, 110}, {350, 10}},
     {{350 * D - 1, 1000, 350 * D - 1, 1000},
      {350 * D, 1001, 350 * D, 0},
      {0, 1002, 0, 0},
      {10 * D, 1003, 10 * D, 0},
      {10 * D + 1, 1004, 10 * D + 1, 1004}}},
    /* The lidar hangs and sees a mast at 120 degrees, which is 60 degrees for the robot. */
    {"arcs are the robot's directions",
     {.front_q6 = 180 * 64, .upside_down = true, MASKED(1)},
     {{59, 61}},
     {{120 * D, 300, 60 * D, 0}, {60 * D, 1001, 120 * D, 1001}}},
    /* For users who count angles to the left as negative. */
    {"arcs and front may be negative",
     {.front_q6 = -90 * 64, MASKED(2)},
     {{-10, 10}, {-190, -170}},
     {{270 * D, 1000, 0, 0},
      {281 * D, 1001, 11 * D, 1001},
      {259 * D, 1002, 349 * D, 1002},
      {100 * D, 1003, 190 * D, 0},
      {79 * D, 1004, 169 * D, 1004}}},
    {"an arc may be a single direction",
     {MASKED(1)},
     {{90, 90}},
     {{90 * D, 1000, 90 * D, 0}, {90 * D + 1, 1001, 90 * D + 1, 1001}}},
    {"an arc may be the whole circle from behind",
     {MASKED(1)},
     {{-180, 180}},
     {{90 * D + 1, 1001, 90 * D + 1, 0}}},
    {"an arc may be the whole circle from the front",
     {MASKED(1)},
     {{0, 360}},
     {{90 * D, 1000, 90 * D, 0}}},
    {"any number of degrees is an arc", /* -8, 7 and -1. */
     {MASKED(3)},
     {{-32768, -32768}, {32767, 32767}, {-1, -1}},
     {{352 * D, 1000, 352 * D, 0},
      {7 * D, 1001, 7 * D, 0},
      {8 * D, 1002, 8 * D, 1002},
      {359 * D, 1003, 359 * D, 0}}},
    {"an offset is added to ranges and not to what is unknown",
     {.offset_mm = 69, .min_mm = 169, .max_mm = 5069},
     {{0}},
     {{0, 0, 0, 0}, {1, 99, 1, 0}, {2, 100, 2, 169}, {3, 5000, 3, 5069}, {4, 5001, 4, 0}}},
    {"an offset leaves a range a range", {.offset_mm = -32768}, {{0}}, {{0, 16383, 0, 1}}},
    {"an offset leaves a range in its bits", {.offset_mm = 32767}, {{0}}, {{0, 1, 0, 16383}}},
    {"an offset of the largest range leaves 1 mm",
     {.offset_mm = -16383},
     {{0}},
     {{0, 16383, 0, 1}}},
};

void test_a_mount_gives_points_the_robots_directions_and_distances(void)
{
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const case_t *const row = &cases[i];
        tmini_mount_t mount = row->mount;
        mount.masked = row->arcs;
        count = 0;
        for (unsigned j = 0; j < 5; j++) {
            add(row->points[j][0], row->points[j][1]);
        }
        apply(&mount);
        for (unsigned j = 0; j < 5 && (j == 0 || row->points[j][2] + row->points[j][3] > 0); j++) {
            TEST_ASSERT_EQUAL_UINT16_MESSAGE(row->points[j][2], points[j].angle_q6, row->claim);
            TEST_ASSERT_EQUAL_UINT16_MESSAGE(row->points[j][3], points[j].distance_mm, row->claim);
            TEST_ASSERT_EQUAL_UINT8(10 + j, points[j].intensity);
            TEST_ASSERT_EQUAL_UINT8(j % 4, points[j].flag);
        }
    }
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
