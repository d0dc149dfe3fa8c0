/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fields: where they are, and when they are free, occupied and blind. */

#include <float.h>
#include <string.h>

#include "tmini/tmini_fields.h"
#include "unity.h"

#define DEGREE 64u
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const tmini_xy_t box[] = {{0, -300}, {600, 300}}; /* From straight left to straight right. */
static tmini_field_t field[2];
static tmini_fields_t fields;
static tmini_point_t points[40];
static tmini_scan_t scan;
static uint32_t now_ms;

static void set_up(const tmini_xy_t *corners, size_t count)
{
    field[0].corners = corners;
    field[0].corner_count = (uint8_t)count;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_fields_init(&fields));
}

void setUp(void)
{
    memset(field, 0, sizeof field);
    fields = (tmini_fields_t){.list = field, .count = 1};
    now_ms = 1000;
    set_up(box, 2);
}

void tearDown(void) {}

static void begin(void)
{
    scan = (tmini_scan_t){.points = points, .complete = true};
}

static void add(int16_t degrees, uint16_t distance_mm)
{
    points[scan.count++] =
        (tmini_point_t){(uint16_t)((degrees + 360) % 360 * 64), distance_mm, 0, 0};
}

static void is(tmini_field_state_t wanted)
{
    TEST_ASSERT_EQUAL_INT(wanted, tmini_field_state(&field[0], now_ms));
}

/* A scan each 100 ms with points in the field, `others` behind it, and `unseen` without a range, 20
 * in all. */
static void see(size_t inside, size_t unseen, bool complete)
{
    begin();
    for (size_t i = 0; i < 20; i++) {
        add((int16_t)(i * 2), i < inside ? 400 : i < inside + unseen ? 0 : 3000);
    }
    now_ms += 100;
    scan.end_ms = now_ms;
    scan.complete = complete;
    tmini_fields_step(&fields, &scan);
}

static void see_free(size_t times)
{
    for (size_t i = 0; i < times; i++) {
        see(0, 0, true);
    }
}

/* ---------------------------------------------------------------------------------- the states */

void test_a_field_is_blind_until_three_complete_scans_have_seen_nothing_in_it(void)
{
    is(TMINI_FIELD_BLIND);
    see_free(2);
    is(TMINI_FIELD_BLIND);
    see_free(1);
    is(TMINI_FIELD_FREE);
}

void test_two_points_in_one_scan_occupy_a_field_at_once(void)
{
    see_free(3);
    see(1, 0, true);
    is(TMINI_FIELD_FREE);
    see(1, 0, true); /* One in each of two scans are not two. */
    is(TMINI_FIELD_FREE);
    see(2, 0, true);
    is(TMINI_FIELD_OCCUPIED);
    TEST_ASSERT_EQUAL_UINT16(2, field[0].inside);
}

void test_three_complete_scans_in_a_row_free_a_field_again(void)
{
    see_free(3);
    see(20, 0, true);
    see_free(2);
    is(TMINI_FIELD_OCCUPIED);
    see(2, 0, true);
    see_free(2);
    is(TMINI_FIELD_OCCUPIED);
    see(1, 0, true);
    is(TMINI_FIELD_FREE);
}

void test_an_incomplete_scan_occupies_a_field_and_never_frees_it(void)
{
    see_free(3);
    see(2, 0, false);
    is(TMINI_FIELD_OCCUPIED);
    see_free(2);
    see(0, 0, false);
    is(TMINI_FIELD_OCCUPIED);
    see_free(1);
    is(TMINI_FIELD_FREE);
}

void test_a_field_becomes_blind_without_complete_scans(void)
{
    see_free(3);
    now_ms += 300;
    is(TMINI_FIELD_FREE);
    now_ms += 1;
    is(TMINI_FIELD_BLIND);
    see_free(2);
    is(TMINI_FIELD_BLIND);
    see_free(1);
    is(TMINI_FIELD_FREE);
}

void test_incomplete_scans_do_not_keep_a_field_free(void)
{
    see_free(3);
    for (size_t i = 0; i < 3; i++) {
        see(0, 0, false);
        is(TMINI_FIELD_FREE);
    }
    see(0, 0, false);
    is(TMINI_FIELD_BLIND);
}

/* A program that asks only after the gap sees the scans after it alone. */
void test_a_gap_in_the_scans_is_noticed_even_if_nobody_asked_during_it(void)
{
    see_free(3);
    now_ms += 201;
    see_free(1);
    is(TMINI_FIELD_BLIND);
    see_free(2);
    is(TMINI_FIELD_FREE);
}

void test_a_field_that_was_blind_once_stays_blind_when_the_clock_wraps_around(void)
{
    see_free(3);
    now_ms += 301;
    is(TMINI_FIELD_BLIND);
    now_ms -= 301;
    is(TMINI_FIELD_BLIND);
}

void test_the_clock_may_wrap_around_between_scans(void)
{
    now_ms = UINT32_MAX - 250;
    see_free(3);
    is(TMINI_FIELD_FREE);
}

void test_directions_without_a_range_make_a_field_blind(void)
{
    see_free(3);
    see(0, 10, true);
    is(TMINI_FIELD_FREE);
    see(0, 11, true); /* Of 20. */
    is(TMINI_FIELD_BLIND);
    see_free(2);
    is(TMINI_FIELD_BLIND);
    see_free(1);
    is(TMINI_FIELD_FREE);
    see(0, 20, false); /* The rest may be missing. */
    is(TMINI_FIELD_FREE);
    see(2, 18, true);
    is(TMINI_FIELD_OCCUPIED);
}

void test_a_complete_scan_without_any_point_in_a_fields_directions_makes_it_blind(void)
{
    see_free(3);
    begin();
    add(180, 3000);
    now_ms += 100;
    scan.end_ms = now_ms;
    tmini_fields_step(&fields, &scan);
    is(TMINI_FIELD_BLIND);
}

void test_the_users_figures_count(void)
{
    field[0].points = 5;
    field[0].scans = 1;
    field[0].unseen_percent = 10;
    field[0].max_age_ms = 50;
    set_up(box, 2);
    see(4, 2, true);
    is(TMINI_FIELD_FREE);
    see(5, 0, true);
    is(TMINI_FIELD_OCCUPIED);
    see(0, 3, true);
    is(TMINI_FIELD_BLIND);
    see_free(1);
    now_ms += 51;
    is(TMINI_FIELD_BLIND);
    field[0].unseen_percent = 100;
    set_up(box, 2);
    see(0, 20, true);
    is(TMINI_FIELD_FREE);
}

void test_255_scans_that_free_a_field_can_be_counted(void)
{
    field[0].scans = 255;
    set_up(box, 2);
    see_free(254);
    is(TMINI_FIELD_BLIND);
    see_free(1);
    is(TMINI_FIELD_FREE);
    see_free(1);
    is(TMINI_FIELD_FREE);
    see(2, 0, true);
    see_free(254);
    is(TMINI_FIELD_OCCUPIED);
}

void test_clearing_makes_fields_blind(void)
{
    see_free(3);
    field[1] = field[0]; /* Not in the list. */
    tmini_fields_clear(&fields);
    is(TMINI_FIELD_BLIND);
    TEST_ASSERT_EQUAL_INT(TMINI_FIELD_FREE, tmini_field_state(&field[1], now_ms));
    see_free(2);
    is(TMINI_FIELD_BLIND);
}

void test_65536_points_in_a_field_occupy_it(void)
{
    const tmini_point_t point = {0, 400, 0, 0};
    tmini_fields_begin(&fields);
    for (uint32_t i = 0; i < 65536; i++) {
        tmini_fields_add(&fields, &point);
    }
    tmini_fields_end(&fields, true, now_ms);
    is(TMINI_FIELD_OCCUPIED);
    TEST_ASSERT_EQUAL_UINT16(65535, field[0].inside);
}

void test_each_field_is_judged_for_itself(void)
{
    static const tmini_xy_t behind[] = {{-10, -300}, {-600, 300}};
    field[1] = (tmini_field_t){.corners = behind, .corner_count = 2, .scans = 1};
    fields.count = 2;
    set_up(box, 2);
    begin();
    add(0, 400);
    add(1, 400);
    add(180, 3000);
    now_ms += 100;
    scan.end_ms = now_ms;
    tmini_fields_step(&fields, &scan);
    is(TMINI_FIELD_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(TMINI_FIELD_FREE, tmini_field_state(&field[1], now_ms));
}

/* ---------------------------------------------------------------------------------- the places */

/* Where a single point lies. */
typedef struct {
    int16_t degrees;
    uint16_t distance_mm;
    bool inside;
    bool ahead; /* Whether the direction is one of the field's. */
} place_t;

static void check_places(const place_t *places, size_t count)
{
    char number[] = "place ?";
    for (size_t i = 0; i < count; i++) {
        number[6] = (char)('a' + i);
        const tmini_point_t seen = {(uint16_t)((places[i].degrees + 360) % 360 * 64),
                                    places[i].distance_mm, 0, 0};
        tmini_fields_begin(&fields);
        tmini_fields_add(&fields, &seen);
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(places[i].inside, field[0].inside, number);
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(places[i].ahead, field[0].directions, number);
    }
}

/* Its far corners are at 26.57 degrees. */
void test_a_box_reaches_from_corner_to_corner(void)
{
    static const place_t places[] = {
        {0, 600, true, true},     {0, 601, false, true},   {26, 667, true, true},
        {26, 669, false, true},   {-26, 667, true, true},  {27, 660, true, true},
        {27, 662, false, true},   {89, 299, true, true},   {-89, 299, true, true},
        {90, 301, false, true},   {-90, 301, false, true}, {91, 100, false, false},
        {-91, 100, false, false}, {180, 1, false, false},
    };
    static const tmini_xy_t turned[] = {{600, -300}, {0, 300}};
    check_places(places, COUNT(places));
    set_up(turned, 2);
    check_places(places, COUNT(places));
}

/* The same box, the lidar on its edge; the edge is the first, a middle and the last one. */
void test_a_polygon_may_begin_anywhere_and_run_either_way(void)
{
    static const tmini_xy_t corners[] = {{0, 300}, {600, 300}, {600, -300}, {0, -300},
                                         {0, 300}, {600, 300}, {600, -300}};
    static const tmini_xy_t back[] = {{0, -300}, {600, -300}, {600, 300}, {0, 300},
                                      {0, -300}, {600, -300}, {600, 300}};
    static const place_t places[] = {
        {0, 599, true, true},    {0, 601, false, true},    {27, 660, true, true},
        {27, 662, false, true},  {85, 299, true, true},    {-85, 299, true, true},
        {95, 100, false, false}, {-95, 100, false, false},
    };
    for (size_t i = 0; i < 4; i++) {
        set_up(&corners[i], 4);
        check_places(places, COUNT(places));
        set_up(&back[i], 4);
        check_places(places, COUNT(places));
    }
}

/* An L around the lidar's left: from (-200, 100) to (1000, 500), and down to (800, -500). */
void test_a_polygon_may_have_a_dent(void)
{
    static const tmini_xy_t corners[] = {{-200, 100},  {800, 100},  {800, -500},
                                         {1000, -500}, {1000, 500}, {-200, 500}};
    static const place_t places[] = {
        {0, 799, false, true},     {0, 801, true, true},     {0, 999, true, true},
        {0, 1001, false, true},    {30, 920, false, true},   {30, 930, true, true},
        {33, 950, false, false},   {-90, 99, false, true},   {-90, 101, true, true},
        {-90, 501, false, true},   {-150, 210, true, true},  {-150, 240, false, true},
        {-154, 100, false, false}, {-120, 100, false, true}, {180, 150, false, false},
    };
    set_up(corners, COUNT(corners));
    check_places(places, COUNT(places));
}

void test_a_polygon_may_have_255_corners(void)
{
    static const place_t places[] = {{0, 999, false, true},
                                     {0, 1500, true, true},
                                     {0, 2300, false, true},
                                     {7, 1500, false, false}};
    tmini_xy_t corners[255];
    for (int16_t i = 0; i < 255; i++) {
        corners[i].x_mm = (int16_t)(1000 + 10 * (i < 128 ? i : 254 - i));
        corners[i].y_mm = i < 128 ? -100 : 100;
    }
    set_up(corners, 255);
    check_places(places, COUNT(places));
}

void test_a_field_around_the_lidar_has_all_directions(void)
{
    static const tmini_xy_t around[] = {{-500, -500}, {500, 500}};
    static const tmini_xy_t triangle[] = {{1000, 0}, {-500, 866}, {-500, -866}};
    static const place_t in_box[] = {{0, 500, true, true},    {135, 700, true, true},
                                     {135, 710, false, true}, {180, 500, true, true},
                                     {-90, 501, false, true}, {359, 20, true, true},
                                     {90, 500, true, true},   {270, 500, true, true}};
    static const tmini_xy_t aside[] = {{-200, -400}, {800, 500}};
    static const place_t in_aside[] = {{0, 799, true, true},   {90, 399, true, true},
                                       {180, 199, true, true}, {270, 499, true, true},
                                       {45, 600, false, true}, {225, 250, true, true}};
    static const place_t in_triangle[] = {{0, 999, true, true},    {60, 499, true, true},
                                          {60, 501, false, true},  {180, 499, true, true},
                                          {180, 501, false, true}, {120, 990, true, true}};
    set_up(around, 2);
    check_places(in_box, COUNT(in_box));
    set_up(triangle, 3);
    check_places(in_triangle, COUNT(in_triangle));
    set_up(aside, 2);
    check_places(in_aside, COUNT(in_aside));
}

/* A corner at the lidar, 2 mm from it, and 1 mm beside its axis. */
void test_a_field_may_begin_at_the_lidar(void)
{
    static const struct {
        tmini_xy_t box[2];
        int16_t not_ahead[2];
        int16_t ahead;
    } cases[] = {
        {{{0, 0}, {600, 300}}, {225, 1}, 315},
        {{{600, 300}, {0, 0}}, {225, 1}, 315},
        {{{2, 1}, {20, 300}}, {268, 359}, 315},
        {{{-2, -1}, {-20, -300}}, {88, 179}, 135},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const place_t places[] = {{cases[i].not_ahead[0], 1000, false, false},
                                  {cases[i].not_ahead[1], 1000, false, false},
                                  {cases[i].ahead, 1000, false, true}};
        set_up(cases[i].box, 2);
        check_places(places, COUNT(places));
    }
}

#if DBL_MANT_DIG > 24
/* Twice the area that two rays span; positive if `other` is to the left. */
static double span(double x, double y, double other_x, double other_y)
{
    return x * other_y - y * other_x;
}

/* True if a ray in this direction meets an edge. Clears `is_clear` where rounding may decide either
 * way: within 1/32 degree of a corner, or if the lidar is on an edge. */
static bool meets(const tmini_xy_t *corners, size_t count, double x, double y, bool *is_clear)
{
    bool is_met = false;
    for (size_t i = 0; i < count; i++) {
        const double from_x = corners[i].x_mm - fields.lidar.x_mm;
        const double from_y = corners[i].y_mm - fields.lidar.y_mm;
        const double to_x = corners[(i + 1) % count].x_mm - fields.lidar.x_mm;
        const double to_y = corners[(i + 1) % count].y_mm - fields.lidar.y_mm;
        const double from = span(x, y, from_x, from_y);
        const double to = span(x, y, to_x, to_y);
        const double along = x * (from_x * to - to_x * from) + y * (from_y * to - to_y * from);
        const bool is_on_edge =
            span(from_x, from_y, to_x, to_y) == 0 && from_x * to_x + from_y * to_y <= 0;
        *is_clear = *is_clear && !is_on_edge;
        is_met = is_met || ((from > 0) != (to > 0) && (to > from ? along > 0 : along < 0));
        *is_clear = *is_clear && from * from > 3.0e-7 * (from_x * from_x + from_y * from_y);
    }
    return is_met;
}

static void check_directions(const tmini_xy_t *corners, size_t count)
{
    double x = 1;
    double y = 0;
    for (uint16_t angle = 0; angle < TMINI_FULL_CIRCLE_Q6; angle++) {
        const tmini_point_t point = {angle, 0, 0, 0};
        bool is_clear = true;
        const bool is_met = meets(corners, count, x, y, &is_clear);
        tmini_fields_begin(&fields);
        tmini_fields_add(&fields, &point);
        TEST_ASSERT_TRUE(!is_clear || field[0].directions == is_met);
        const double ahead = x * 0.9999999628152566 + y * 0.00027270769224392545;
        y = y * 0.9999999628152566 - x * 0.00027270769224392545; /* 1/64 degree to the right. */
        x = ahead;
    }
}

/* Whether the place is inside: an odd number of edges is to its left. `is_clear` becomes false
 * within 2 mm of an edge. */
static bool encloses(const tmini_xy_t *corners, size_t count, double x, double y, bool *is_clear)
{
    bool is_odd = false;
    for (size_t i = 0; i < count; i++) {
        const double from_x = corners[i].x_mm - x;
        const double from_y = corners[i].y_mm - y;
        const double to_x = corners[(i + 1) % count].x_mm - x;
        const double to_y = corners[(i + 1) % count].y_mm - y;
        const double across = span(from_x, from_y, to_x, to_y);
        const double length = (to_x - from_x) * (to_x - from_x) + (to_y - from_y) * (to_y - from_y);
        is_odd =
            is_odd != ((from_x > 0) != (to_x > 0) && (to_x > from_x ? across < 0 : across > 0));
        *is_clear = *is_clear && across * across > 4 * length && from_x * from_x > 4;
    }
    return is_odd;
}

static void check_insides(const tmini_xy_t *corners, size_t count, uint32_t state)
{
    for (uint16_t i = 0; i < 400; i++) {
        state = state * 1664525u + 1013904223u;
        const tmini_point_t point = {(uint16_t)((state >> 8) % TMINI_FULL_CIRCLE_Q6),
                                     (uint16_t)(1 + i * 40u), 0, 0};
        const tmini_xy_t at = tmini_cartesian_point(&point); /* test_cartesian.c. */
        bool is_clear = true;
        const bool is_inside = encloses(corners, count, at.x_mm + fields.lidar.x_mm,
                                        at.y_mm + fields.lidar.y_mm, &is_clear);
        tmini_fields_begin(&fields);
        tmini_fields_add(&fields, &point);
        TEST_ASSERT_TRUE(!is_clear || field[0].inside == is_inside);
    }
}

static int16_t draw(uint32_t *state, int16_t limit)
{
    *state = *state * 1664525u + 1013904223u;
    return (int16_t)((int32_t)(*state >> 16) % (2 * limit + 1) - limit);
}

/* Each takes seconds on an emulated machine without a floating-point unit. */
#if SIZE_MAX > 0xFFFFFFFFu
#define POLYGONS 400u
#else
#define POLYGONS 8u
#endif

/* Polygons of any kind. Half of them have corners on a grid: straight ahead, behind or aside. */
void test_any_polygon_has_the_directions_and_the_places_that_geometry_gives_it(void)
{
    uint32_t state = 1;
    for (unsigned i = 0; i < POLYGONS; i++) {
        tmini_xy_t corners[5];
        const size_t count = 3 + i % 3;
        const int16_t grid = i % 2 == 0 ? 4000 : 3;
        for (size_t j = 0; j < count; j++) {
            corners[j].x_mm = (int16_t)(draw(&state, grid) * (grid == 3 ? 1000 : 1));
            corners[j].y_mm = (int16_t)(draw(&state, grid) * (grid == 3 ? 1000 : 1));
        }
        fields.lidar = (tmini_xy_t){draw(&state, 4000), draw(&state, 4000)};
        if (i % 4 == 3) { /* One of them straight ahead of, behind or beside the lidar. */
            fields.lidar.x_mm = i % 8 == 3 ? corners[0].x_mm : fields.lidar.x_mm;
            fields.lidar.y_mm = i % 8 == 7 ? corners[0].y_mm : fields.lidar.y_mm;
        }
        field[0] = (tmini_field_t){.corners = corners, .corner_count = (uint8_t)count};
        if (tmini_fields_init(&fields) == TMINI_OK) {
            check_directions(corners, count);
            check_insides(corners, count, state);
        }
    }
}
#else
void test_any_polygon_has_the_directions_and_the_places_that_geometry_gives_it(void) {}
#endif

/* The lidar is 300 mm ahead of the robot's middle and 100 mm to the left. */
void test_places_count_from_the_robot_and_the_lidar_has_its_own(void)
{
    static const place_t places[] = {{0, 299, true, true},   {0, 301, false, true},
                                     {90, 399, true, true},  {90, 401, false, true},
                                     {-90, 199, true, true}, {-90, 201, false, true},
                                     {180, 299, true, true}, {180, 301, false, true}};
    fields.lidar = (tmini_xy_t){300, 100};
    set_up(box, 2);
    check_places(places, COUNT(places));
}

/* Products of such numbers are just below 2^31. */
void test_the_largest_fields_do_not_overflow(void)
{
    static const tmini_xy_t corners[] = {{-16383, -16383}, {16383, -16383},  {16383, 16383},
                                         {-16383, 16383},  {-16383, -16383}, {16383, -16383},
                                         {16383, 16383}};
    static const place_t from_corner[] = {{135, 16383, true, true},  {91, 16383, true, true},
                                          {179, 16383, true, true},  {89, 100, false, false},
                                          {-179, 100, false, false}, {-45, 16383, false, false}};
    static const place_t from_middle[] = {{0, 16382, true, true}, {45, 16383, true, true}};
    for (size_t i = 0; i < 4; i++) {
        fields.lidar = (tmini_xy_t){16383, 16383};
        set_up(&corners[i], 4); /* The lidar is at one of the corners. */
        check_places(from_corner, COUNT(from_corner));
    }
    fields.lidar = (tmini_xy_t){0, 0};
    set_up(corners, 4);
    check_places(from_middle, COUNT(from_middle));
}

void test_fields_that_cannot_be_are_refused_and_stay_blind(void)
{
    static const tmini_xy_t flat[] = {{0, 0}, {0, 300}};
    static const tmini_xy_t low[] = {{0, 10}, {300, 10}};
    static const tmini_xy_t line[] = {{0, 0}, {100, 100}, {300, 300}};
    static const tmini_xy_t far[] = {{0, 0}, {16384, 300}};
    static const tmini_xy_t far_right[] = {{0, 0}, {100, -16384}};
    static const tmini_field_t bad[] = {{.corners = NULL, .corner_count = 2},
                                        {.corners = box, .corner_count = 1},
                                        {.corners = flat, .corner_count = 2},
                                        {.corners = low, .corner_count = 2},
                                        {.corners = line, .corner_count = 3},
                                        {.corners = far, .corner_count = 2},
                                        {.corners = far_right, .corner_count = 2},
                                        {.corners = box, .corner_count = 2, .unseen_percent = 101}};
    for (size_t i = 0; i < COUNT(bad); i++) {
        field[0] = bad[i];
        TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
        see_free(4);
        is(TMINI_FIELD_BLIND);
    }
    field[0] = (tmini_field_t){.corners = box, .corner_count = 2};
    fields.lidar = (tmini_xy_t){0, -16384};
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    fields = (tmini_fields_t){.list = NULL, .count = 1};
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    fields = (tmini_fields_t){.list = field, .count = 0};
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(NULL));
}

void test_a_bad_field_does_not_keep_the_good_ones_from_working(void)
{
    field[1] = (tmini_field_t){.corners = box, .corner_count = 2};
    field[0].corner_count = 0;
    fields.count = 2;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    see_free(3);
    is(TMINI_FIELD_BLIND);
    TEST_ASSERT_EQUAL_INT(TMINI_FIELD_FREE, tmini_field_state(&field[1], now_ms));
}

void test_fields_that_were_not_set_up_stay_blind(void)
{
    field[0] = (tmini_field_t){.corners = box, .corner_count = 2};
    see_free(4);
    is(TMINI_FIELD_BLIND);
    tmini_fields_step(NULL, &scan); /* Does nothing. */
}
