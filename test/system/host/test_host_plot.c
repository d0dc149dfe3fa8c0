/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* `tmini plot`, measured: is every point of the scan in the picture where it should be? The scale
 * is taken from the picture's own range rings and their labels, the points from the reference decoder. */

#include "encoder.h"
#include "png_reader.h"
#include "program.h"
#include "reference_decoder.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MAX 20000u
#define RECORDING_MAX 60000u

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

typedef struct {
    double x, y, r;
} circle_t;

/* The points with a distance of one scan, or of all, by the reference decoder. */
static reference_point_t points[POINTS_MAX];
static size_t point_count;
static unsigned scans_seen;
static unsigned scan_wanted; /* 0: all */

static circle_t lidar;
static double pixels_per_m;

void setUp(void) {}

void tearDown(void)
{
    program_clean_up();
}

static void expect_near(double tolerance, double expected, double value)
{
    char text[80];
    (void)snprintf(text, sizeof text, "expected %.3f, was %.3f", expected, value);
    TEST_ASSERT_TRUE_MESSAGE(fabs(value - expected) <= tolerance, text);
}

/* ------------------------------------------------------------------------ what should be drawn */

static void collect(void *context, const reference_item_t *item)
{
    (void)context;
    scans_seen += item->starts_revolution ? 1u : 0u;
    if (scans_seen == 0 || (scan_wanted != 0 && scans_seen != scan_wanted)) {
        return;
    }
    for (unsigned i = 0; i < item->lsn; i++) {
        const reference_point_t point = reference_point(item->bytes, i);
        if (point.distance_mm > 0) {
            points[point_count++] = point;
        }
    }
}

static void decode(const char *path, unsigned scan)
{
    const reference_options_t options = {.max_samples = 80};
    size_t size = 0;
    const char *const recording = program_read_file(1, path, &size);
    point_count = scans_seen = 0;
    scan_wanted = scan;
    (void)reference_decode((const uint8_t *)recording, size, &options, collect, NULL);
    TEST_ASSERT_TRUE(point_count > 0 && point_count < POINTS_MAX);
}

/* -------------------------------------------------------------------------------- what is drawn */

/* The part of the SVG between <g id="name"> and </g>. */
static const char *group(const char *svg, const char *name, const char **end)
{
    char opening[40];
    (void)snprintf(opening, sizeof opening, "<g id=\"%s\">", name);
    const char *const begin = strstr(svg, opening);
    TEST_ASSERT_NOT_NULL_MESSAGE(begin, name);
    *end = strstr(begin, "</g>");
    TEST_ASSERT_NOT_NULL(*end);
    return begin + strlen(opening);
}

/* The circles of a group; returns how many. */
static size_t circles(const char *svg, const char *name, circle_t *found, size_t room)
{
    const char *end = NULL;
    const char *at = group(svg, name, &end);
    size_t count = 0;
    while ((at = strstr(at, "<circle ")) != NULL && at < end) {
        TEST_ASSERT_TRUE(count < room);
        circle_t *const circle = &found[count++];
        TEST_ASSERT_EQUAL_INT(3, sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\" r=\"%lf\"", &circle->x,
                                        &circle->y, &circle->r));
        at++;
    }
    return count;
}

/* The labels of the rings, "1 m" … , in metres. */
static size_t labels(const char *svg, double *metres, size_t room)
{
    const char *end = NULL;
    const char *at = group(svg, "ranges", &end);
    size_t count = 0;
    while ((at = strstr(at, "<text ")) != NULL && at < end) {
        TEST_ASSERT_TRUE(count < room);
        metres[count++] = strtod(strchr(at, '>') + 1, NULL);
        at++;
    }
    return count;
}

/* Centre and scale from the rings: they must agree with each other and with their labels. */
static void measure_scale(const char *svg)
{
    circle_t rings[10];
    double metres[10];
    const size_t count = circles(svg, "rings", rings, 10);
    TEST_ASSERT_EQUAL_size_t(count, labels(svg, metres, 10));
    TEST_ASSERT_TRUE(count >= 3);
    lidar = rings[0];
    pixels_per_m = rings[count - 1].r / metres[count - 1];
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(rings[i].x == lidar.x && rings[i].y == lidar.y);
        expect_near(0.01, metres[i] * pixels_per_m, rings[i].r);
    }
    TEST_ASSERT_EQUAL_size_t(2, circles(svg, "lidar", rings, 10) - 1);
    TEST_ASSERT_TRUE(rings[0].x == lidar.x && rings[0].y == lidar.y);
}

/* Clockwise from straight up. */
static circle_t place_of(const reference_point_t *point)
{
    const double angle = point->angle_q6 / 64.0 * acos(-1) / 180;
    const double distance = point->distance_mm / 1000.0 * pixels_per_m;
    return (circle_t){lidar.x + distance * sin(angle), lidar.y - distance * cos(angle), 0};
}

static const char *read_svg(void)
{
    return program_read_file(0, program_path("picture.svg"), NULL);
}

static void expect_points(const char *svg)
{
    static circle_t drawn[POINTS_MAX];
    measure_scale(svg);
    TEST_ASSERT_EQUAL_size_t(point_count, circles(svg, "points", drawn, POINTS_MAX));
    for (size_t i = 0; i < point_count; i++) {
        const circle_t expected = place_of(&points[i]);
        expect_near(0.02, expected.x, drawn[i].x);
        expect_near(0.02, expected.y, drawn[i].y);
    }
}

static void plot(const char *recording, const char *option, const char *value)
{
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", recording, "-o",
                                                 program_path("picture.svg"), option, value)));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

/* ---------------------------------------------------------------------------------------- tests */

void test_the_last_complete_scan_is_drawn_point_by_point(void)
{
    plot(RECORDINGS "sim-6hz.bin", NULL, NULL);
    decode(RECORDINGS "sim-6hz.bin", 8);
    expect_points(read_svg());
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">Scan 8<"));
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">6.0 Hz \xC2\xB7 669 points, 653 with a distance "
                                            "\xC2\xB7 sim-6hz.bin<"));
}

void test_a_scan_can_be_chosen(void)
{
    plot(RECORDINGS "sim-10hz-plain.bin", "--scan", "3");
    decode(RECORDINGS "sim-10hz-plain.bin", 3);
    expect_points(read_svg());
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">Scan 3<"));
}

void test_an_unfinished_scan_can_be_chosen_and_is_called_so(void)
{
    plot(RECORDINGS "sim-6hz.bin", "--scan", "9");
    decode(RECORDINGS "sim-6hz.bin", 9);
    expect_points(read_svg());
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">Scan 9 (incomplete)<"));
}

void test_all_scans_fit_in_one_picture(void)
{
    plot(RECORDINGS "sim-12hz.bin", "--all", NULL);
    decode(RECORDINGS "sim-12hz.bin", 0);
    expect_points(read_svg());
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">Scans 1 to "));
}

/* A recording of one scan, made for this: a point each 90 degrees; the start packet first. */
static const char *cross_recording(uint8_t flag_right, uint8_t flag_back)
{
    static const uint16_t quarter = 5760;
    const encode_sample_t front = {1000, 10, 0};
    const encode_sample_t rest[3] = {{2000, 20, flag_right}, {3000, 30, flag_back}, {4000, 40, 0}};
    const encode_packet_t start = {121, 1, 0, 0, &front}; /* 6.0 Hz */
    const encode_packet_t packet = {0, 3, quarter, (uint16_t)(3 * quarter), rest};
    uint8_t bytes[100];
    size_t size = encode_packet(bytes, &start);
    size += encode_packet(bytes + size, &packet);
    size += encode_packet(bytes + size, &start);
    const char *const path = program_path("cross.bin");
    program_write_file(path, bytes, size);
    return path;
}

void test_front_is_up_and_angles_go_clockwise(void)
{
    circle_t drawn[4];
    plot(cross_recording(0, 0), "--scan", "1");
    measure_scale(read_svg());
    TEST_ASSERT_EQUAL_size_t(4, circles(read_svg(), "points", drawn, 4));
    /* 4 m is the outermost ring: 500 pixels. Front, right, back, left. */
    expect_near(0.001, 125, pixels_per_m);
    expect_near(0.02, lidar.y - 125, drawn[0].y);
    expect_near(0.02, lidar.x, drawn[0].x);
    expect_near(0.02, lidar.x + 250, drawn[1].x);
    expect_near(0.02, lidar.y, drawn[1].y);
    expect_near(0.02, lidar.y + 375, drawn[2].y);
    expect_near(0.02, lidar.x - 500, drawn[3].x);
}

void test_interference_and_the_nearest_point_are_marked(void)
{
    circle_t ring;
    plot(cross_recording(2, 3), "--scan", "1");
    const char *end = NULL;
    const char *const marks = group(read_svg(), "interference", &end);
    TEST_ASSERT_EQUAL_size_t(1, circles(read_svg(), "interference", &ring, 1));
    expect_near(0.02, lidar.x + 250, ring.x); /* Flag 2, to the right: a ring. */
    double x1 = 0;
    double y1 = 0;
    TEST_ASSERT_EQUAL_INT(2,
                          sscanf(strstr(marks, "<line "), "<line x1=\"%lf\" y1=\"%lf\"", &x1, &y1));
    expect_near(10, lidar.x, x1); /* Flag 3, behind: a cross. */
    expect_near(10, lidar.y + 375, y1);
    TEST_ASSERT_EQUAL_size_t(1, circles(read_svg(), "nearest", &ring, 1));
    expect_near(0.02, lidar.y - 125, ring.y);
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">nearest 1.000 m at 0.0\xC2\xB0<"));
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">specular (1)<"));
    TEST_ASSERT_NOT_NULL(strstr(read_svg(), ">ambient light (1)<"));
}

static const uint8_t *pixel(const png_t *png, double x, double y)
{
    return png->pixels + 3 * ((size_t)y * png->width + (size_t)x);
}

/* Beams and ground are dark; a point is not. */
static bool is_bright(const uint8_t *colour)
{
    return colour[0] > 140 || colour[1] > 140 || colour[2] > 140;
}

void test_the_png_shows_the_same_points_at_the_same_places(void)
{
    png_t png;
    size_t size = 0;
    plot(RECORDINGS "sim-6hz.bin", NULL, NULL);
    measure_scale(read_svg());
    decode(RECORDINGS "sim-6hz.bin", 8);
    const char *const picture = program_path("picture.png");
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", RECORDINGS "sim-6hz.bin", "-o", picture)));
    const char *const file = program_read_file(1, picture, &size);
    TEST_ASSERT_NULL(png_read((const uint8_t *)file, size, &png));
    TEST_ASSERT_EQUAL_UINT32(1200, png.width);
    TEST_ASSERT_EQUAL_UINT32(1360, png.height);
    for (size_t i = 0; i < point_count; i++) {
        const circle_t place = place_of(&points[i]);
        TEST_ASSERT_TRUE(is_bright(pixel(&png, place.x, place.y)));
    }
    /* Beside the axis to the right, within the room and behind its wall, there is nothing. */
    TEST_ASSERT_FALSE(is_bright(pixel(&png, lidar.x + 0.5 * pixels_per_m, lidar.y + 7)));
    TEST_ASSERT_FALSE(is_bright(pixel(&png, lidar.x + 4 * pixels_per_m, lidar.y + 7)));
    TEST_ASSERT_FALSE(is_bright(pixel(&png, 5, 5)));
}

void test_a_point_in_the_png_is_a_dot_of_seven_pixels(void)
{
    png_t png;
    size_t size = 0;
    const char *const picture = program_path("cross.png");
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini(WORDS("plot", cross_recording(0, 0), "--scan", "1", "-o", picture)));
    const char *const file = program_read_file(1, picture, &size);
    TEST_ASSERT_NULL(png_read((const uint8_t *)file, size, &png));
    /* The point 2 m to the right: 250 pixels from the middle (600, 690). */
    TEST_ASSERT_TRUE(is_bright(pixel(&png, 850, 690)));
    TEST_ASSERT_TRUE(is_bright(pixel(&png, 850, 692)));
    TEST_ASSERT_TRUE(is_bright(pixel(&png, 850, 687)));
    TEST_ASSERT_FALSE(is_bright(pixel(&png, 850, 694)));
    TEST_ASSERT_FALSE(is_bright(pixel(&png, 850, 685)));
}

static void expect_failure(int status, const char *reason, const char *const words[])
{
    TEST_ASSERT_EQUAL_INT(status, program_tmini(words));
    TEST_ASSERT_NOT_NULL(strstr(program_errors, "tmini: "));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, reason), program_errors);
}

void test_what_cannot_be_drawn_is_said(void)
{
    static const char *const room = RECORDINGS "sim-6hz.bin";
    expect_failure(2, "must end in .svg or .png", WORDS("plot", room, "-o", "picture.jpg"));
    expect_failure(2, "plot what, and where to?", WORDS("plot", room));
    expect_failure(2, "not both", WORDS("plot", room, "-o", "x.svg", "--all", "--scan", "1"));
    expect_failure(1, "has no scan 10, only 1 to 9",
                   WORDS("plot", room, "-o", "x.svg", "--scan", "10"));
    expect_failure(1, "cannot write /nowhere/x.svg", WORDS("plot", room, "-o", "/nowhere/x.svg"));
    expect_failure(1, "cannot write /nowhere/x.png", WORDS("plot", room, "-o", "/nowhere/x.png"));
    expect_failure(1, "no start packet",
                   WORDS("plot", RECORDINGS "manual-packet.bin", "-o", "x.svg"));
}
