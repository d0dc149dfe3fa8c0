/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Measures the pictures of `tmini plot`: every point must be in the right place. The points come
 * from the reference decoder, the scale from the tool's message and from the measured rings. */

#include "encoder.h"
#include "program.h"
#include "reference_decoder.h"

#include "unity.h"

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MAX 20000u

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

/* The layout of the picture, in pixels. */
#define MIDDLE_X 600.0
#define MIDDLE_Y 690.0
#define OUTERMOST 500.0
#define POINT_WIDTH 6.8
#define POINTS_ONE_SCAN 1000u

typedef struct {
    double x, y;
} place_t;

/* The points with a distance, of one scan or of all, from the reference decoder. */
static reference_point_t points[POINTS_MAX];
static size_t point_count;
static unsigned scans_seen;
static unsigned scan_wanted; /* 0: all */

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

/* ----------------------------------------------------------------------- what should be drawn */

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

/* ------------------------------------------------------------------------------ what is drawn */

/* Finds the discs of this width in pixels, and returns their number. The picture has them as lines
 * of length 0 with round ends. */
static size_t discs(const char *svg, double width, place_t *found, size_t room)
{
    size_t count = 0;
    for (const char *at = svg; (at = strstr(at, "<path ")) != NULL; at++) {
        const char *const end = strchr(at, '>');
        const char *const stroke = strstr(at, "stroke-width");
        const char *const data = strstr(at, " d=\"M ");
        place_t from;
        place_t to;
        if (end == NULL || stroke == NULL || stroke > end || data == NULL || data > end ||
            fabs(strtod(stroke + strcspn(stroke, "0123456789"), NULL) - width) > 0.01 ||
            sscanf(data, " d=\"M %lf %lf L %lf %lf", &from.x, &from.y, &to.x, &to.y) != 4 ||
            from.x != to.x || from.y != to.y) {
            continue;
        }
        TEST_ASSERT_TRUE(count < room);
        found[count++] = from;
    }
    return count;
}

/* The number of rings of this radius around (x, y); their paths begin at the rightmost point. */
static unsigned rings(const char *svg, double x, double y, double radius)
{
    unsigned count = 0;
    for (const char *at = svg; (at = strstr(at, " d=\"M ")) != NULL; at++) {
        place_t from;
        if (sscanf(at, " d=\"M %lf %lf C", &from.x, &from.y) == 2 &&
            strchr(at, 'C') < strchr(at, '>') && fabs(from.x - x - radius) < 0.02 &&
            fabs(from.y - y) < 0.02) {
            count++;
        }
    }
    return count;
}

/* Points are bright; beams and background are dark. */
static bool is_bright(cairo_surface_t *png, double x, double y)
{
    uint32_t pixel = 0;
    TEST_ASSERT_EQUAL_INT(CAIRO_STATUS_SUCCESS, cairo_surface_status(png));
    memcpy(&pixel,
           cairo_image_surface_get_data(png) +
               (size_t)y * (size_t)cairo_image_surface_get_stride(png) + 4 * (size_t)x,
           sizeof pixel);
    return (pixel >> 16 & 255) > 140 || (pixel >> 8 & 255) > 140 || (pixel & 255) > 140;
}

/* Angles go clockwise from straight up. */
static place_t place_of(const reference_point_t *point)
{
    const double angle = point->angle_q6 / 64.0 * acos(-1) / 180;
    const double distance = point->distance_mm / 1000.0 * pixels_per_m;
    return (place_t){MIDDLE_X + distance * sin(angle), MIDDLE_Y - distance * cos(angle)};
}

static const char *read_svg(void)
{
    return program_read_file(0, program_path("picture.svg"), NULL);
}

/* `metres`: the radius of the outermost ring, as the tool prints it. */
static void expect_points(double metres)
{
    static place_t drawn[POINTS_MAX];
    char words[40];
    (void)snprintf(words, sizeof words, "; rings to %g m\n", metres);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, words), program_errors);
    pixels_per_m = OUTERMOST / metres;
    TEST_ASSERT_EQUAL_UINT(1, rings(read_svg(), MIDDLE_X, MIDDLE_Y, OUTERMOST));
    TEST_ASSERT_EQUAL_size_t(point_count, discs(read_svg(), POINT_WIDTH, drawn, POINTS_MAX));
    for (size_t i = 0; i < point_count; i++) {
        const place_t expected = place_of(&points[i]);
        expect_near(0.02, expected.x, drawn[i].x);
        expect_near(0.02, expected.y, drawn[i].y);
    }
}

static void plot(const char *recording, const char *option, const char *value)
{
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", recording, "-o",
                                                 program_path("picture.svg"), option, value)));
}

static void expect_said(const char *words)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(program_errors, words), program_errors);
}

/* -------------------------------------------------------------------------------------- tests */

void test_the_last_complete_scan_is_drawn_point_by_point(void)
{
    plot(RECORDINGS "sim-6hz.bin", NULL, NULL);
    decode(RECORDINGS "sim-6hz.bin", 8);
    expect_points(6);
    expect_said("picture.svg: Scan 8; 6.0 Hz \xC2\xB7 669 points, 653 with a distance "
                "\xC2\xB7 sim-6hz.bin; ");
}

void test_a_scan_can_be_chosen(void)
{
    plot(RECORDINGS "sim-10hz-plain.bin", "--scan", "3");
    decode(RECORDINGS "sim-10hz-plain.bin", 3);
    expect_points(6);
    expect_said(": Scan 3; ");
}

void test_an_unfinished_scan_can_be_chosen_and_is_called_so(void)
{
    plot(RECORDINGS "sim-6hz.bin", "--scan", "9");
    decode(RECORDINGS "sim-6hz.bin", 9);
    expect_points(6);
    expect_said(": Scan 9 (incomplete); 6.0 Hz ");
}

void test_all_scans_fit_in_one_picture(void)
{
    plot(RECORDINGS "sim-12hz.bin", "--all", NULL);
    decode(RECORDINGS "sim-12hz.bin", 0);
    expect_points(6);
    expect_said(": Scans 1 to ");
}

/* A recording of one scan with a point every 90 degrees, beginning with the start packet. */
static const char *cross_recording(uint8_t flag_right, uint8_t flag_back)
{
    const encode_sample_t samples[4] = {
        {1000, 10, 0}, {2000, 20, flag_right}, {3000, 30, flag_back}, {4000, 40, 0}};
    return program_write_turn("cross.bin", samples);
}

void test_front_is_up_and_angles_go_clockwise(void)
{
    place_t drawn[4];
    plot(cross_recording(0, 0), "--scan", "1");
    expect_said("; rings to 4 m\n");
    TEST_ASSERT_EQUAL_size_t(4, discs(read_svg(), POINT_WIDTH, drawn, 4));
    /* The outermost ring is 4 m, 500 pixels. The points: front, right, back, left. */
    expect_near(0.02, MIDDLE_Y - 125, drawn[0].y);
    expect_near(0.02, MIDDLE_X, drawn[0].x);
    expect_near(0.02, MIDDLE_X + 250, drawn[1].x);
    expect_near(0.02, MIDDLE_Y, drawn[1].y);
    expect_near(0.02, MIDDLE_Y + 375, drawn[2].y);
    expect_near(0.02, MIDDLE_X - 500, drawn[3].x);
}

void test_interference_and_the_nearest_point_are_marked(void)
{
    plot(cross_recording(2, 3), "--scan", "1");
    const char *const svg = read_svg();
    TEST_ASSERT_EQUAL_UINT(1, rings(svg, MIDDLE_X + 250, MIDDLE_Y, 7.4)); /* Flag 2: a ring. */
    /* Flag 3: a cross of two lines, 3 m to the back. */
    TEST_ASSERT_EQUAL_UINT(1, program_count(svg, "M 594 1059 L 606 1071"));
    TEST_ASSERT_EQUAL_UINT(1, program_count(svg, "M 594 1071 L 606 1059"));
    TEST_ASSERT_EQUAL_UINT(1, rings(svg, MIDDLE_X, MIDDLE_Y - 125, 12)); /* The nearest point. */
}

void test_a_unit_that_flags_every_sample_is_not_covered_with_marks(void)
{
    const encode_sample_t samples[4] = {{2000, 20, 2}, {2000, 20, 2}, {3000, 30, 3}, {4000, 40, 3}};
    plot(program_write_turn("flagged.bin", samples), "--scan", "1");
    place_t drawn[4];
    TEST_ASSERT_EQUAL_size_t(4, discs(read_svg(), POINT_WIDTH, drawn, 4));
    TEST_ASSERT_EQUAL_UINT(0, rings(read_svg(), MIDDLE_X + 250, MIDDLE_Y, 7.4));
    TEST_ASSERT_EQUAL_UINT(0, program_count(read_svg(), "M 594 1059"));
    expect_said("4 of 4 points flagged");
}

void test_a_covered_lidar_is_no_empty_disc(void)
{
    static const encode_sample_t none[4];
    plot(program_write_turn("covered.bin", none), "--scan", "1");
    expect_said("; rings to 6 m\n"); /* The default scale. */
    expect_said("no point has a distance: is the window covered?");
    /* The picture also says so, below the lidar. */
    const char *const picture = program_path("covered.png");
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini(WORDS("plot", program_path("covered.bin"), "--scan", "1", "-o", picture)));
    cairo_surface_t *const png = cairo_image_surface_create_from_png(picture);
    unsigned lit = 0;
    for (int x = 200; x < 1000; x++) {
        lit += is_bright(png, x, MIDDLE_Y + 142) ? 1 : 0;
    }
    TEST_ASSERT_TRUE(lit > 30);
    cairo_surface_destroy(png);
}

void test_the_png_shows_the_same_points_at_the_same_places(void)
{
    plot(RECORDINGS "sim-6hz.bin", NULL, NULL);
    decode(RECORDINGS "sim-6hz.bin", 8);
    pixels_per_m = OUTERMOST / 6;
    const char *const picture = program_path("picture.png");
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", RECORDINGS "sim-6hz.bin", "-o", picture)));
    cairo_surface_t *const png = cairo_image_surface_create_from_png(picture);
    TEST_ASSERT_EQUAL_INT(1200, cairo_image_surface_get_width(png));
    TEST_ASSERT_EQUAL_INT(1360, cairo_image_surface_get_height(png));
    for (size_t i = 0; i < point_count; i++) {
        const place_t place = place_of(&points[i]);
        TEST_ASSERT_TRUE(is_bright(png, place.x, place.y));
    }
    /* Next to the axis to the right there is no point, neither inside nor outside the room. */
    TEST_ASSERT_FALSE(is_bright(png, MIDDLE_X + 0.5 * pixels_per_m, MIDDLE_Y + 7));
    TEST_ASSERT_FALSE(is_bright(png, MIDDLE_X + 4 * pixels_per_m, MIDDLE_Y + 7));
    TEST_ASSERT_FALSE(is_bright(png, 5, 5));
    cairo_surface_destroy(png);
}

void test_a_point_in_the_png_is_a_dot_of_seven_pixels(void)
{
    const char *const picture = program_path("cross.png");
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini(WORDS("plot", cross_recording(0, 0), "--scan", "1", "-o", picture)));
    cairo_surface_t *const png = cairo_image_surface_create_from_png(picture);
    /* The point 2 m to the right: 250 pixels from the middle (600, 690). */
    TEST_ASSERT_TRUE(is_bright(png, 850, 690));
    TEST_ASSERT_TRUE(is_bright(png, 850, 692));
    TEST_ASSERT_TRUE(is_bright(png, 850, 687));
    TEST_ASSERT_FALSE(is_bright(png, 850, 694));
    TEST_ASSERT_FALSE(is_bright(png, 850, 685));
    cairo_surface_destroy(png);
}

void test_a_plot_can_be_a_pdf(void)
{
    size_t size = 0;
    const char *const picture = program_path("picture.pdf");
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", RECORDINGS "sim-6hz.bin", "-o", picture)));
    const char *const file = program_read_file(1, picture, &size);
    TEST_ASSERT_EQUAL_STRING_LEN("%PDF-", file, 5);
    TEST_ASSERT_TRUE(size > 10000);
}

/* The name may be long, and may be invalid UTF-8 (0xFF), at which cairo would stop drawing. */
void test_any_name_of_a_file_can_stand_below_the_title(void)
{
    static const char *const names[] = {
        "Raum \xC3\xBC\xE4\xB8\xAD\xF0\x9F\x98\x80.bin",
        "not utf-8 \xFF\xC3.bin",
        ("a_name_that_is_much_longer_than_the_picture_is_wide_a_name_that_is_much_longer_than_the_"
         "picture_is_wide_a_name_that_is_much_longer_than_the_picture_is_wide.bin"),
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        size_t size = 0;
        place_t drawn[POINTS_ONE_SCAN];
        const char *const recording = program_read_file(1, RECORDINGS "sim-6hz.bin", &size);
        const char *const path = program_path(names[i]);
        program_write_file(path, recording, size);
        plot(path, NULL, NULL);
        TEST_ASSERT_EQUAL_size_t(653, discs(read_svg(), POINT_WIDTH, drawn, POINTS_ONE_SCAN));
        (void)remove(path);
        /* The last text of the picture is there, too. */
        TEST_ASSERT_NOT_NULL(strstr(read_svg(), "y=\"1332\""));
    }
}

/* 100 MB contain 30 million points: 180 MB in memory, and far more as SVG. */
void test_all_scans_of_a_long_recording_fit_in_bounded_memory(void)
{
    size_t size = 0;
    const char *const room = program_read_file(1, RECORDINGS "sim-6hz.bin", &size);
    FILE *const file = fopen("big.bin", "wb");
    TEST_ASSERT_NOT_NULL(file);
    for (size_t written = 0; written < 100000000; written += size) {
        TEST_ASSERT_EQUAL_size_t(size, fwrite(room, 1, size, file));
    }
    fclose(file);
    (void)setenv("TOOL", TMINI, 1);
    TEST_ASSERT_EQUAL_INT(
        0, system(PROGRAM_LIMIT("180000") "\"$TOOL\" plot big.bin --all -o big.png 2>said"));
    const char *const said = program_read_file(0, "said", NULL);
    const char *const thinned = strstr(said, " points with a distance, one in 512 ");
    TEST_ASSERT_NOT_NULL_MESSAGE(thinned, said);
    TEST_ASSERT_NULL(strchr(said, '%')); /* Progress is for terminals. */
    (void)remove("big.bin");
}

void test_a_dash_is_a_recording_from_standard_input(void)
{
    TEST_ASSERT_EQUAL_INT(
        0, program_tmini_from(RECORDINGS "sim-6hz.bin", WORDS("plot", "-", "-o", "picture.svg")));
    expect_said("picture.svg: Scan 8; ");
    expect_said("standard input; ");
}

void test_a_dash_is_standard_output_as_svg(void)
{
    TEST_ASSERT_EQUAL_INT(0, program_tmini(WORDS("plot", RECORDINGS "sim-6hz.bin", "-qo", "-")));
    TEST_ASSERT_EQUAL_STRING_LEN("<?xml", program_output, 5);
    TEST_ASSERT_NOT_NULL(strstr(program_output, "</svg>"));
    TEST_ASSERT_EQUAL_STRING("", program_errors);
}

void test_what_cannot_be_drawn_is_reported(void)
{
    static const char *const room = RECORDINGS "sim-6hz.bin";
    program_expect_failure(2, "must end in .svg, .png or .pdf",
                           WORDS("plot", room, "-o", "picture.jpg"));
    program_expect_failure(2, "plot what, and into which picture", WORDS("plot", room));
    program_expect_failure(2, "not both",
                           WORDS("plot", room, "-o", "x.svg", "--all", "--scan", "1"));
    program_expect_failure(1, "has no scan 10, only 1 to 9",
                           WORDS("plot", room, "-o", "x.svg", "--scan", "10"));
    program_expect_failure(1, "cannot write /nowhere/x.svg",
                           WORDS("plot", room, "-o", "/nowhere/x.svg"));
    program_expect_failure(1, "cannot write /nowhere/x.png",
                           WORDS("plot", room, "-o", "/nowhere/x.png"));
    program_expect_failure(1, "no start packet",
                           WORDS("plot", RECORDINGS "manual-packet.bin", "-o", "x.svg"));
}
