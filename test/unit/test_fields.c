/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fields: where they are, and when they are free, occupied and blind. */

#include "random.h"
#include "rows.h"

#include "tmini/tmini_fields.h"
#include "unity.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static const tmini_xy_t box[] = {{0, -300}, {600, 300}}; /* From straight left to straight right. */
static tmini_xy_t memory[8] = {{16000, -16000}}; /* What is around the corners does not count. */
static tmini_xy_t *const polygon = &memory[1];
static tmini_field_t field[2];
static tmini_field_t *one; /* Of these two. */
static tmini_fields_t fields;
static tmini_point_t points[20];
static tmini_scan_t scan;
static uint32_t now_ms;

static void set_up(const tmini_xy_t *list, size_t count)
{
    one->corners = list;
    one->corner_count = (uint8_t)count;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_fields_init(&fields));
}

void setUp(void)
{
    memset(field, 0, sizeof field);
    fields = (tmini_fields_t){.list = field, .count = 1};
    one = field;
    now_ms = 1000;
    set_up(box, 2);
}

static void is(tmini_field_state_t wanted)
{
    TEST_ASSERT_EQUAL_INT(wanted, tmini_field_state(one, now_ms));
}

static tmini_point_t point_at(long degrees, uint16_t distance_mm)
{
    return (tmini_point_t){(uint16_t)((degrees + 360) % 360 * 64), distance_mm, 0, 0};
}

/* A scan of the first points, 100 ms later. */
static void step(uint16_t count, bool complete)
{
    now_ms += 100;
    scan = (tmini_scan_t){.points = points, .count = count, .complete = complete, .end_ms = now_ms};
    tmini_fields_step(&fields, &scan);
}

/* Of 20 points ahead, `inside` are in the field, `unseen` have no range, others are beyond it. */
static void see(size_t inside, size_t unseen, bool complete)
{
    for (size_t i = 0; i < 20; i++) {
        points[i] = point_at((long)i * 2, i < inside ? 400 : i < inside + unseen ? 0 : 3000);
    }
    step(20, complete);
}

static void see_free(size_t times)
{
    for (; times > 0; times--) {
        see(0, 0, true);
    }
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows:
 *
 *     FREE OCCUPIED BLIND     the field's state
 *     free:3          three complete scans 100 ms apart, with nothing in the field
 *     see:2 see:2:18  such a scan with 2 points in the field; and 18 of 20 have no range
 *     part:2          the same, but the scan is incomplete
 *     back            a complete scan of a point straight back
 *     +301 clock:-250 this time passes; the clock is set
 *     clear           forgets what was seen
 *     fields:2 two one        the list's length; what follows is about the second field, the first
 *     points:5 scans:1 unseen:10 age:50       the user's figures
 *     box new         sets the fields up, this one as the box above; does not set it up
 *     corners:0,-300,600,300  sets it up with these corners: x, y
 *     no:0,0,0,300    it is refused with these corners, and stays blind
 *     lidar:300,100   where the lidar is, before that
 *     in:0,600 out:0,601 away:91,100  a point of this angle and distance is in the field; is out of
 *                     it, in one of its directions; is in none of them. Or several such points. */

static long next_number(const char **text)
{
    char *rest;
    const long number = strtol(*text, &rest, 10);
    *text = rest + (rest[0] == ',' ? 1 : 0);
    return number;
}

static size_t read_corners(const char *text)
{
    size_t count = 0;
    while (text[0] != '\0') {
        polygon[count].x_mm = (int16_t)next_number(&text);
        polygon[count++].y_mm = (int16_t)next_number(&text);
    }
    polygon[count] = memory[0];
    return count;
}

static void refuse(size_t count)
{
    one->corners = polygon;
    one->corner_count = (uint8_t)count;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    see_free(4);
    is(TMINI_FIELD_BLIND);
}

static void expect_places(const char *word)
{
    for (const char *text = row_text(word); text[0] != '\0';) {
        const long degrees = next_number(&text);
        const tmini_point_t point = point_at(degrees, (uint16_t)next_number(&text));
        tmini_fields_begin(&fields);
        tmini_fields_add(&fields, &point);
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(word[0] == 'i', field[0].inside, word);
        TEST_ASSERT_EQUAL_UINT16_MESSAGE(word[0] != 'a', field[0].directions, word);
    }
}

static void tell_word(char *word)
{
    const char *text = row_text(word);
    const uint32_t number = row_number(word);
    const row_member_t members[] = {
        {"fields", MEMBER(fields.count)}, {"points", MEMBER(one->points)},
        {"scans", MEMBER(one->scans)},    {"unseen", MEMBER(one->unseen_percent)},
        {"age", MEMBER(one->max_age_ms)}, {"clock", MEMBER(now_ms)},
    };
    if (row_stores(word, members)) {
        return;
    } else if (row_is(word, "one") || row_is(word, "two")) {
        one = &field[word[0] == 't'];
    } else if (strchr("FOB", word[0]) != NULL) {
        is(word[0] == 'F'   ? TMINI_FIELD_FREE
           : word[0] == 'O' ? TMINI_FIELD_OCCUPIED
                            : TMINI_FIELD_BLIND);
    } else if (row_is(word, "free")) {
        see_free(number);
    } else if (row_is(word, "see") || row_is(word, "part")) {
        see(number, row_number(text), word[0] == 's');
    } else if (row_is(word, "back")) {
        points[0] = point_at(180, 3000);
        step(1, true);
    } else if (word[0] == '+') {
        now_ms += (uint32_t)strtol(word + 1, NULL, 10);
    } else if (row_is(word, "clear")) {
        tmini_fields_clear(&fields);
    } else if (row_is(word, "new")) {
        *one = (tmini_field_t){.corners = box, .corner_count = 2};
    } else if (row_is(word, "box")) {
        set_up(box, 2);
    } else if (row_is(word, "lidar")) {
        fields.lidar.x_mm = (int16_t)next_number(&text);
        fields.lidar.y_mm = (int16_t)next_number(&text);
    } else if (row_is(word, "corners")) {
        set_up(polygon, read_corners(text));
    } else if (row_is(word, "no")) {
        refuse(read_corners(text));
    } else if (row_is(word, "in") || row_is(word, "out") || row_is(word, "away")) {
        expect_places(word);
    } else {
        TEST_FAIL_MESSAGE(word);
    }
}

/* The box above; its far corners are at 26.57 degrees. */
#define IN_BOX                                                                              \
    "in:0,600,26,667,-26,667,27,660,89,299,-89,299 out:0,601,26,669,27,662,90,301,-90,301 " \
    "away:91,100,-91,100,180,1 "
#define AT_CORNER "in:135,16383,91,16383,179,16383 away:89,100,-179,100,-45,16383 "

static const row_t rows[] IN_FLASH = {
    /* ---- States ---- */
    ROW(a_field_is_blind_until_three_complete_scans_have_seen_nothing_in_it,
        "BLIND free:2 BLIND free:1 FREE"),
    ROW(two_points_in_one_scan_occupy_a_field_at_once, /* One in each of two scans are not two. */
        "free:3 see:1 FREE see:1 FREE see:2 OCCUPIED"),
    ROW(three_complete_scans_in_a_row_free_a_field_again,
        "free:3 see:20 free:2 OCCUPIED see:2 free:2 OCCUPIED see:1 FREE"),
    ROW(an_incomplete_scan_occupies_a_field_and_never_frees_it,
        "free:3 part:2 OCCUPIED free:2 part:0 OCCUPIED free:1 FREE"),
    ROW(a_field_becomes_blind_without_complete_scans,
        "free:3 +300 FREE +1 BLIND free:2 BLIND free:1 FREE"),
    ROW(incomplete_scans_do_not_keep_a_field_free, "free:3 3( part:0 FREE ) part:0 BLIND"),
    ROW(a_gap_in_the_scans_is_noticed_even_if_nobody_asked_during_it,
        "free:3 +201 free:1 BLIND free:2 FREE"),
    ROW(a_field_that_was_blind_once_stays_blind_when_the_clock_wraps_around,
        "free:3 +301 BLIND +-301 BLIND"),
    ROW(the_clock_may_wrap_around_between_scans, "clock:-251 free:3 FREE"),
    ROW(directions_without_a_range_make_a_field_blind, /* In an incomplete scan: perhaps. */
        "free:3 see:0:10 FREE see:0:11 BLIND free:2 BLIND free:1 FREE part:0:20 FREE see:2:18 "
        "OCCUPIED"),
    ROW(a_complete_scan_without_any_point_in_a_fields_directions_makes_it_blind,
        "free:3 back BLIND"),
    ROW(the_users_figures_count,
        "points:5 scans:1 unseen:10 age:50 box see:4:2 FREE see:5 OCCUPIED see:0:3 BLIND free:1 "
        "+51 BLIND unseen:100 box see:0:20 FREE"),
    ROW(scans_that_free_a_field_can_be_255,
        "scans:255 box free:254 BLIND free:1 FREE free:1 FREE see:2 free:254 OCCUPIED"),
    ROW(a_field_that_cannot_be_is_refused, /* One corner; flat; low; a line; too far away. */
        "no:600,300 no:0,0,0,300 no:0,10,300,10 no:0,0,100,100,300,300 no:0,0,16384,300 "
        "no:16384,0,300,300 no:0,0,100,-16384 lidar:0,-16384 no:0,-300,600,300 lidar:0,0 "
        "unseen:101 "
        "no:0,-300,600,300 unseen:100 corners:0,-300,600,300"),
    ROW(fields_set_up_again_are_blind, "free:3 box BLIND free:2 BLIND free:1 FREE"),
    ROW(fields_that_were_not_set_up_stay_blind, "new free:4 BLIND"),
    ROW(each_field_is_judged_for_itself_and_set_back_with_its_list,
        "fields:2 two scans:1 corners:-10,-300,-600,300 see:2 BLIND one OCCUPIED back BLIND "
        "two FREE fields:1 one free:3 FREE clear BLIND two FREE one free:2 BLIND"),
    ROW(a_bad_field_does_not_keep_the_good_ones_from_working, "fields:2 two box one no: two FREE"),
    /* ---- Places ---- */
    ROW(a_box_reaches_from_corner_to_corner, IN_BOX "corners:600,-300,0,300 " IN_BOX),
    ROW(a_polygon_may_have_a_dent, /* An L around the lidar's left. */
        "corners:-200,100,800,100,800,-500,1000,-500,1000,500,-200,500 "
        "in:0,801,0,999,30,930,-90,101,-150,210 out:0,799,0,1001,30,920,-90,99,-90,501 "
        "out:-150,240,-120,100 away:33,950,-154,100,180,150"),
    ROW(a_box_around_the_lidar_has_all_directions,
        "corners:-500,-500,500,500 in:0,500,135,700,180,500,359,20,90,500,270,500 "
        "out:135,710,-90,501 corners:-200,-400,800,500 in:0,799,90,399,180,199,270,499,225,250 "
        "out:45,600"),
    ROW(a_triangle_around_the_lidar_has_all_directions,
        "corners:1000,0,-500,866,-500,-866 in:0,999,60,499,180,499,120,990 out:60,501,180,501"),
    ROW(a_field_may_begin_at_the_lidar, /* Also 2 mm from it, and 1 mm beside its axis. */
        "corners:0,0,600,300 away:225,1000,1,1000 out:315,1000 corners:600,300,0,0 "
        "away:225,1000,1,1000 out:315,1000 corners:2,1,20,300 away:268,1000,359,1000 out:315,1000 "
        "corners:-2,-1,-20,-300 away:88,1000,179,1000 out:135,1000"),
    ROW(places_count_from_the_robot_and_the_lidar_has_its_own,
        "lidar:300,100 box in:0,299,90,399,-90,199,180,299 out:0,301,90,401,-90,201,180,301"),
    ROW(the_largest_fields_do_not_overflow, /* Products just below 2^31. */
        "corners:-16383,-16383,16383,16383 in:0,16382,45,16383"),
    ROW(the_largest_fields_with_the_lidar_at_a_corner_do_not_overflow,
        "lidar:16383,16383 corners:-16383,-16383,16383,-16383,16383,16383,-16383,16383 " AT_CORNER
        "corners:16383,16383,-16383,16383,-16383,-16383,16383,-16383 " AT_CORNER),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* ------------------------------------------------------------------------------------ polygons */

/* The box, the lidar on its edge; the edge is the first, a middle and the last one. */
void test_a_polygon_may_begin_anywhere_and_run_either_way(void)
{
    static const tmini_xy_t clockwise[] = {{0, 300}, {600, 300}, {600, -300}, {0, -300},
                                           {0, 300}, {600, 300}, {600, -300}};
    for (size_t i = 0; i < 8; i++) {
        for (size_t j = 0; j < 4; j++) {
            polygon[j] = clockwise[i < 4 ? i + j : i - 1 - j];
        }
        set_up(polygon, 4);
        row_tell("in:0,599,27,660,85,299,-85,299 out:0,601,27,662 away:95,100,-95,100", tell_word);
    }
}

void test_a_polygon_may_have_255_corners(void)
{
    tmini_xy_t many[255];
    for (int16_t i = 0; i < 255; i++) {
        many[i].x_mm = (int16_t)(1000 + 10 * (i < 128 ? i : 254 - i));
        many[i].y_mm = i < 128 ? -100 : 100;
    }
    set_up(many, 255);
    row_tell("out:0,999 in:0,1500 out:0,2300 away:7,1500", tell_word);
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

static void check_insides(random_t *random, const tmini_xy_t *corners, size_t count)
{
    for (uint16_t i = 0; i < 400; i++) {
        const tmini_point_t point = {(uint16_t)random_below(random, TMINI_FULL_CIRCLE_Q6),
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

/* Between -limit and limit. */
static int16_t draw(random_t *random, int16_t limit)
{
    return (int16_t)((int32_t)random_below(random, 2u * (uint32_t)limit + 1) - limit);
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
    random_t random;
    random_seed(&random, 1);
    for (unsigned i = 0; i < POLYGONS; i++) {
        tmini_xy_t corners[5];
        const size_t count = 3 + i % 3;
        const int16_t grid = i % 2 == 0 ? 4000 : 3;
        for (size_t j = 0; j < count; j++) {
            corners[j].x_mm = (int16_t)(draw(&random, grid) * (grid == 3 ? 1000 : 1));
            corners[j].y_mm = (int16_t)(draw(&random, grid) * (grid == 3 ? 1000 : 1));
        }
        fields.lidar = (tmini_xy_t){draw(&random, 4000), draw(&random, 4000)};
        if (i % 4 == 3) { /* One of them straight ahead of, behind or beside the lidar. */
            fields.lidar.x_mm = i % 8 == 3 ? corners[0].x_mm : fields.lidar.x_mm;
            fields.lidar.y_mm = i % 8 == 7 ? corners[0].y_mm : fields.lidar.y_mm;
        }
        field[0] = (tmini_field_t){.corners = corners, .corner_count = (uint8_t)count};
        if (tmini_fields_init(&fields) == TMINI_OK) {
            check_directions(corners, count);
            check_insides(&random, corners, count);
        }
    }
}
#else
void test_any_polygon_has_the_directions_and_the_places_that_geometry_gives_it(void) {}
#endif

/* -------------------------------------------------------------------------------------- fields */

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

void test_all_points_of_a_large_scan_count(void)
{
    static tmini_point_t many[300];
    scan = (tmini_scan_t){.points = many, .count = 300, .complete = true, .end_ms = now_ms};
    many[298] = point_at(0, 400);
    many[299] = point_at(2, 400);
    tmini_fields_step(&fields, &scan);
    is(TMINI_FIELD_OCCUPIED);
}

/* Too large for a small machine. */
void test_a_list_may_have_65537_fields_and_what_is_after_it_does_not_count(void)
{
#if defined(__linux__)
    static tmini_field_t many[65538];
    tmini_field_t *const last = &many[65536];
    for (size_t i = 0; i < 65538; i++) {
        many[i] = (tmini_field_t){.corners = box, .corner_count = 2, .scans = 1};
    }
    fields = (tmini_fields_t){.list = many, .count = 65538};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_fields_init(&fields));
    fields.count = 65537;
    last[1].inside = 7;
    last[1].directions = 7;
    see_free(1);
    TEST_ASSERT_EQUAL_INT(TMINI_FIELD_FREE, tmini_field_state(last, now_ms));
    see(2, 0, true);
    TEST_ASSERT_EQUAL_INT(TMINI_FIELD_OCCUPIED, tmini_field_state(last, now_ms));
    tmini_fields_clear(&fields);
    TEST_ASSERT_EQUAL_INT(TMINI_FIELD_BLIND, tmini_field_state(last, now_ms));
    TEST_ASSERT_EQUAL_UINT16(7, last[1].inside);
    TEST_ASSERT_EQUAL_UINT16(7, last[1].directions);
    TEST_ASSERT_EQUAL_UINT32(0, last[1].seen_ms);
#endif
}

void test_fields_without_corners_or_a_list_are_refused(void)
{
    field[0].corners = NULL;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    field[0].corners = box;
    fields.count = 0;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    fields = (tmini_fields_t){.list = NULL, .count = 1};
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(&fields));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_fields_init(NULL));
    tmini_fields_step(NULL, &scan); /* Does nothing. */
}
