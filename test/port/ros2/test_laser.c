/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the conversion that port/ros2 and examples/micro_ros share. Expected numbers follow from
 * ROS's definition of the messages. */

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "rows.h"
#include "tmini_cloud.h"
#include "tmini_laser.h"

#include "unity.h"

#define DEGREE 64u
#define RAYS 360u
#define NEAR 1e-5f
#define POINTS 400u
#define UNTOUCHED 77.0f

static tmini_laser_config_t config;
static tmini_laser_t laser;
static tmini_laser_fields_t fields;
static tmini_point_t points[POINTS + 5];
static tmini_scan_t scan;
static float ranges[RAYS];
static float intensities[RAYS];
static tmini_cloud_point_t cloud[POINTS + 5];

void setUp(void)
{
    config = tmini_laser_default;
    tmini_laser_init(&laser, &config);
    memset(&fields, 0xEE, sizeof fields);
    for (size_t i = 0; i < RAYS; i++) {
        ranges[i] = intensities[i] = UNTOUCHED;
    }
    scan = (tmini_scan_t){
        .points = points,
        .frequency_chz = 1000,
        .start_ms = 5000,
        .end_ms = 5100,
        .complete = true,
    };
}

static void add(float degrees, uint16_t distance_mm, uint8_t intensity)
{
    const uint16_t angle_q6 = (uint16_t)lroundf(degrees * 64.0f) % TMINI_FULL_CIRCLE_Q6;
    points[scan.count++] = (tmini_point_t){angle_q6, distance_mm, intensity, 0};
}

/* A turn at 10 Hz: 400 points, 0.9 degrees apart. Its distances tell the points apart: 1 m, 1.001
 * m, … */
static void add_turn(float begin)
{
    for (size_t i = 0; i < POINTS; i++) {
        add(begin + 0.9f * (float)i, (uint16_t)(1000u + i), 7);
    }
}

static void convert(void)
{
    tmini_laser_init(&laser, &config);
    TEST_ASSERT_TRUE(tmini_laser_of_scan(&laser, &scan, ranges, intensities, &fields));
}

/* --------------------------------------------------------------------------- angles and times */

static const struct {
    const char *name;
    bool is_mirrored;
    bool is_turned;
    float begin;     /* Of the turn, by the lidar's angles. */
    float angle_min; /* Of the message; degrees. */
} layouts[] = {
    {"upright", false, false, 0.48f, 0},
    {"turned", false, true, 0.48f, -180},
    {"mirrored", true, false, 0.48f, 0},
    {"mirrored and turned", true, true, 0.48f, -180},
    {"begins at 3 degrees", false, false, 3, 0},
    {"begins at 4 degrees", false, false, 4, -3},
    {"begins at 116 degrees", false, false, 116, -115},
    {"the same, turned", false, true, 116, 65},
    {"the same, mirrored", true, false, 116, 116},
    {"the same, mirrored and turned", true, true, 116, -64},
    {"begins at 116.45 degrees", false, false, 116.45f, -115},
    {"begins behind", false, false, 180.9f, -180},
    {"the same, mirrored", true, false, 180.2f, -180},
};
#define LAYOUTS (sizeof layouts / sizeof layouts[0])

static float expected_degrees(size_t layout, float lidar_degrees)
{
    const float counted = layouts[layout].is_mirrored ? lidar_degrees : -lidar_degrees;
    return counted + (layouts[layout].is_turned ? 180.0f : 0.0f);
}

static void use_layout(size_t layout)
{
    config.is_mirrored = layouts[layout].is_mirrored;
    config.is_turned = layouts[layout].is_turned;
    scan.count = 0;
    add_turn(layouts[layout].begin);
}

/* The point that a ray's range comes from. */
static float point_of(size_t ray)
{
    return roundf((ranges[ray] - 1.0f) * 1000.0f);
}

void test_the_first_ray_is_where_the_turn_begins_and_the_rays_go_once_around(void)
{
    for (size_t i = 0; i < LAYOUTS; i++) {
        use_layout(i);
        convert();
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(NEAR, layouts[i].angle_min * 0.0174532925f,
                                         fields.angle_min, layouts[i].name);
        TEST_ASSERT_FLOAT_WITHIN(NEAR, fields.angle_min + 6.26573201f, fields.angle_max);
        TEST_ASSERT_FLOAT_WITHIN(1e-8f, 0.01745329f, fields.angle_increment);
    }
}

/* Points are 250 us apart, and the turn ended at end_ms. If it began up to 3 degrees beside ahead,
 * ray 0 is ahead nevertheless: all times are up to 0.8 ms off, and 3 rays have the time of the
 * other end. */
void test_every_ray_has_the_direction_and_the_time_of_its_point(void)
{
    for (size_t i = 0; i < LAYOUTS; i++) {
        const bool is_beside = i == 4;
        use_layout(i);
        convert();
        for (size_t ray = 0; ray < RAYS; ray++) {
            const float point = layouts[i].begin + 0.9f * point_of(ray);
            const float degrees = layouts[i].angle_min + (float)ray;
            const float apart = remainderf(degrees - expected_degrees(i, point), 360.0f);
            const float measured_us = 250.0f * point_of(ray) - 100000.0f;
            const float claimed_us =
                (float)fields.stamp_us + 1e6f * fields.time_increment * (float)ray;
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.51f, 0.0f, apart, layouts[i].name);
            if (!is_beside || ray < RAYS - 3) {
                TEST_ASSERT_FLOAT_WITHIN_MESSAGE(is_beside ? 1200.0f : 600.0f, measured_us,
                                                 claimed_us, layouts[i].name);
            }
        }
    }
}

/* The clock may be late at the start of a turn, but not at its end. */
void test_the_times_of_a_turn_follow_from_its_end_and_its_frequency_or_are_unknown(void)
{
    add_turn(0);
    for (scan.start_ms = 5000; scan.start_ms >= 4980; scan.start_ms -= 20) {
        convert();
        TEST_ASSERT_FLOAT_WITHIN(NEAR, 0.1f, fields.scan_time);
        TEST_ASSERT_FLOAT_WITHIN(1e-8f, -0.1f / 360.0f, fields.time_increment);
        TEST_ASSERT_EQUAL_INT32(0, fields.stamp_us);
    }
    scan.frequency_chz = 0;
    scan.complete = false;
    TEST_ASSERT_TRUE(tmini_laser_of_scan(&laser, &scan, ranges, intensities, &fields));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, fields.scan_time);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, fields.time_increment);
}

/* Points 100 to 199 of a turn at 10 Hz: from 90 to 179.1 degrees, 25 ms after its beginning. The
 * scan is ended by a packet that comes much later. The turn was from 7000 to 7100. */
void test_the_times_of_a_part_of_a_turn_follow_from_its_first_point(void)
{
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        config.is_mirrored = mirrored != 0;
        scan.count = 0;
        scan.complete = true;
        add_turn(0);
        convert();
        memmove(points, &points[100], 100 * sizeof points[0]);
        scan.count = 100;
        scan.complete = false;
        scan.start_ms = 7025;
        scan.end_ms = 7400;
        TEST_ASSERT_TRUE(tmini_laser_of_scan(&laser, &scan, ranges, intensities, &fields));
        TEST_ASSERT_INT32_WITHIN(300, mirrored != 0 ? -400000 : -300000, fields.stamp_us);
    }
}

void test_without_a_scan_or_rays_nothing_is_written(void)
{
    TEST_ASSERT_FALSE(tmini_laser_of_scan(&laser, NULL, ranges, intensities, &fields));
    add_turn(0);
    config.rays = 0;
    tmini_laser_init(&laser, &config);
    TEST_ASSERT_FALSE(tmini_laser_of_scan(&laser, &scan, ranges, intensities, &fields));
    TEST_ASSERT_EQUAL_FLOAT(UNTOUCHED, ranges[0]);
    TEST_ASSERT_EQUAL_FLOAT(UNTOUCHED, intensities[0]);
}

/* -------------------------------------------------------------------------------------- ranges */

void test_masks_count_in_the_messages_degrees_and_are_unknown_never_free(void)
{
    for (size_t i = 0; i < LAYOUTS; i++) {
        config.missing_inf = true;
        config.seen = (tmini_laser_arc_t){-90.0f, 120.0f};
        config.masked_count = 2;
        config.masked[0] = (tmini_laser_arc_t){10.0f, 20.0f};
        config.masked[1] = (tmini_laser_arc_t){-5.0f, -5.0f};
        use_layout(i);
        convert();
        for (int ray = 0; ray < (int)RAYS; ray++) {
            const int degrees = ((int)layouts[i].angle_min + ray + 540) % 360 - 180;
            const bool is_seen =
                degrees >= -90 && degrees <= 120 && degrees != -5 && (degrees < 10 || degrees > 20);
            TEST_ASSERT_EQUAL_MESSAGE(!is_seen, isnan(ranges[ray]) != 0, layouts[i].name);
            TEST_ASSERT_EQUAL_FLOAT(is_seen ? 7.0f : 0.0f, intensities[ray]);
        }
    }
}

/* --------------------------------------------------------------------------------------- cloud */

void test_a_cloud_has_every_range_where_it_was_measured_and_when(void)
{
    for (size_t i = 0; i < LAYOUTS; i++) {
        use_layout(i);
        TEST_ASSERT_EQUAL_size_t(POINTS, tmini_cloud_of_scan(&config, &scan, cloud));
        for (size_t point = 0; point < POINTS; point++) {
            const float degrees =
                expected_degrees(i, layouts[i].begin + 0.9f * (float)point) * 0.0174532925f;
            const float range = 1.0f + 0.001f * (float)point;
            TEST_ASSERT_FLOAT_WITHIN(5e-4f, range * cosf(degrees), cloud[point].x);
            TEST_ASSERT_FLOAT_WITHIN(5e-4f, range * sinf(degrees), cloud[point].y);
            TEST_ASSERT_EQUAL_FLOAT(0.0f, cloud[point].z);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, 250e-6f * (float)point, cloud[point].time);
        }
    }
}

/* ------------------------------------------------------------------------------ told in words */

/* "90,4000,40": a point with its angle, distance and intensity; "turn": many; "begins:-3": the
 * first ray. "ray:270=3,30": its range and intensity. To the right is 90 degrees for the lidar, -90
 * for ROS: ray 270. "cloud:2": it has two points; "shown:0=3": the intensity of the first. */
static void tell(char *word)
{
    const row_member_t members[] = {{"min", MEMBER(config.min_mm)},
                                    {"max", MEMBER(config.max_mm)},
                                    {"inf", MEMBER(config.missing_inf)},
                                    {"complete", MEMBER(scan.complete)}};
    const size_t number = row_number(word);
    float a = 0;
    float b = 0;
    unsigned distance_mm = 0;
    unsigned intensity = 0;
    if (sscanf(word, "%f,%u,%u", &a, &distance_mm, &intensity) == 3) {
        add(a, (uint16_t)distance_mm, (uint8_t)intensity);
    } else if (row_is(word, "turn")) {
        add_turn((float)number);
    } else if (row_is(word, "empty")) {
        scan.count = 0;
    } else if (sscanf(word, "begins:%f", &a) == 1) {
        TEST_ASSERT_TRUE(tmini_laser_of_scan(&laser, &scan, ranges, intensities, &fields));
        TEST_ASSERT_FLOAT_WITHIN(NEAR, a * 0.0174532925f, fields.angle_min);
    } else if (row_is(word, "seen")) {
        config.seen = (tmini_laser_arc_t){-(float)number, (float)number};
    } else if (sscanf(word, "ray:%*u=%f,%f", &a, &b) == 2) {
        convert();
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(a, ranges[number], word);
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(b, intensities[number], word);
    } else if (sscanf(word, "limits:%f,%f", &a, &b) == 2) {
        TEST_ASSERT_EQUAL_FLOAT(a, fields.range_min);
        TEST_ASSERT_EQUAL_FLOAT(b, fields.range_max);
    } else if (row_is(word, "cloud")) {
        TEST_ASSERT_EQUAL_size_t(number, tmini_cloud_of_scan(&config, &scan, cloud));
    } else if (sscanf(word, "shown:%*u=%f", &a) == 1) {
        TEST_ASSERT_EQUAL_FLOAT(a, cloud[number].intensity);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_stores(word, members), word);
    }
}

#define LIMITED "min:200 max:8000 turn ray:0=1,7 empty 0,0,0 "

static const row_t rows[] = {
    ROW(the_first_ray_is_ahead_until_a_complete_scan_shows_where_it_stays,
        "turn:116 complete:0 begins:0 complete:1 begins:-115 empty turn:118 begins:-115"),
    /* The last points of a turn may lie beyond its first one, here nearer than those. */
    ROW(where_a_turn_overlaps_itself_each_ray_has_its_own_end,
        "turn 0,500,0 0.9,501,0 1.8,502,0 2.7,503,0 3.6,504,0 ray:0=0.5,0 ray:359=1.001,7 "
        "ray:358=1.002,7 ray:357=1.003,7 ray:356=1.004,7"),
    ROW(a_ray_has_its_nearest_point_and_that_points_intensity,
        "0,1,0 90,4000,40 90.2,3000,30 90.4,5000,50 ray:270=3,30"),
    ROW(of_the_scan_before_nothing_remains, LIMITED "90,0,9 ray:270=nan,0 ray:271=nan,0"),
    ROW(what_is_missing_may_be_infinite, LIMITED "90,0,9 inf:1 ray:270=inf,0 ray:271=inf,0"),
    ROW(what_is_too_near_is_missing, LIMITED "90,199,9 ray:270=nan,0 ray:271=nan,0"),
    ROW(what_is_too_near_is_never_infinite, LIMITED "90,199,9 inf:1 ray:270=nan,0 ray:271=inf,0"),
    ROW(the_lower_limit_itself_is_shown, LIMITED "90,200,9 inf:1 ray:270=0.2,9 limits:0.2,8"),
    ROW(the_upper_limit_itself_is_shown, LIMITED "90,8000,9 ray:270=8,9 limits:0.2,8"),
    ROW(what_is_too_far_is_missing, LIMITED "90,8001,9 ray:270=nan,0"),
    ROW(what_is_too_far_may_be_infinite, LIMITED "90,8001,9 inf:1 ray:270=inf,0"),
    ROW(too_near_a_point_does_not_hide_another_and_is_never_free,
        "inf:1 0,0,0 90,20,1 90.3,4000,2 180,4000,3 180.3,20,4 ray:270=4,2 ray:180=4,3"),
    ROW(a_cloud_leaves_out_what_has_no_range_or_is_masked,
        "seen:100 0,0,1 10,49,2 20,50,3 90,12000,4 95,12001,5 180,1000,6 cloud:2 shown:0=3 "
        "shown:1=4 min:0 cloud:3"),
};

void test_each_row(void)
{
    tell_rows(rows, tell);
}
