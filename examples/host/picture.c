/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "picture.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <errno.h>
#include <iconv.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "output.h"
#include "points.h"

#define WIDTH 1200
#define HEIGHT 1360
#define MIDDLE_X 600.0
#define MIDDLE_Y 690.0
#define RADIUS 500.0
#define LEGEND_Y 1290.0
#define RINGS_MAX 6u
#define EMPTY_MM 6000u /* The range of a picture without points. */
#define TURN (2 * 3.14159265358979323846)

/* How bright the beams are in a picture of one scan, which has about this many points. */
#define BEAM_ALPHA 0.05
#define BEAM_POINTS 700.0

static const colour_t background = {0.04, 0.06, 0.12};
static const colour_t ground = {0.06, 0.10, 0.18};
static const colour_t grid = {0.20, 0.27, 0.42};
static const colour_t faint = {0.14, 0.20, 0.31};
static const colour_t bright = {0.91, 0.94, 0.98};
static const colour_t muted = {0.55, 0.62, 0.75};
static const colour_t amber = {1.00, 0.70, 0.22};
static const colour_t specular = {1.00, 0.36, 0.67};
static const colour_t ambient = {1.00, 0.38, 0.28};

typedef struct {
    double x, y;
} spot_t;

/* The place at `distance` pixels from the lidar, `degrees` clockwise from its front. */
static spot_t at_bearing(double degrees, double distance)
{
    const double radians = degrees * TURN / 360;
    return (spot_t){MIDDLE_X + distance * sin(radians), MIDDLE_Y - distance * cos(radians)};
}

/* The smallest round step with which RINGS_MAX rings are enough. */
static unsigned ring_step_mm(const survey_t *survey)
{
    static const unsigned steps_mm[] = {50, 100, 200, 250, 500, 1000, 2000, 2500, 5000};
    size_t i = 0;
    while (steps_mm[i] * RINGS_MAX < (survey->valid > 0 ? survey->farthest_mm : EMPTY_MM)) {
        i++; /* It ends, because no distance is above 16383 mm. */
    }
    return steps_mm[i];
}

unsigned picture_range_mm(const survey_t *survey)
{
    const unsigned step_mm = ring_step_mm(survey);
    const unsigned farthest_mm = survey->valid > 0 ? survey->farthest_mm : EMPTY_MM;
    return (farthest_mm + step_mm - 1) / step_mm * step_mm;
}

static double pixels(const survey_t *survey, unsigned mm)
{
    return RADIUS * mm / picture_range_mm(survey);
}

static spot_t place_of(const tmini_point_t *point, const survey_t *survey)
{
    return at_bearing(point->angle_q6 / 64.0, pixels(survey, point->distance_mm));
}

static void ink(cairo_t *cr, colour_t colour, double width)
{
    cairo_set_source_rgb(cr, colour.red, colour.green, colour.blue);
    cairo_set_line_width(cr, width);
}

static void line(cairo_t *cr, spot_t from, spot_t to)
{
    cairo_move_to(cr, from.x, from.y);
    cairo_line_to(cr, to.x, to.y);
    cairo_stroke(cr);
}

/* A line of no length has round ends: a disc. */
static void disc(cairo_t *cr, spot_t at, double radius, colour_t colour)
{
    ink(cr, colour, 2 * radius);
    line(cr, at, at);
}

static void ring(cairo_t *cr, spot_t at, double radius)
{
    cairo_new_sub_path(cr);
    cairo_arc(cr, at.x, at.y, radius, 0, TURN);
    cairo_stroke(cr);
}

/* `align`: 0 begins at the place, 0.5 is centred on it, 1 ends there. Returns the text's width. */
static double text(cairo_t *cr, spot_t at, double align, double size, colour_t colour,
                   const char *words)
{
    cairo_text_extents_t extents;
    cairo_set_font_size(cr, size);
    cairo_text_extents(cr, words, &extents);
    ink(cr, colour, 1);
    cairo_move_to(cr, at.x - align * extents.x_advance, at.y);
    cairo_show_text(cr, words);
    return extents.x_advance;
}

static void draw_rings(cairo_t *cr, const survey_t *survey)
{
    const unsigned step_mm = ring_step_mm(survey);
    const unsigned range_mm = picture_range_mm(survey);
    for (unsigned mm = step_mm; mm <= range_mm; mm += step_mm) {
        ink(cr, mm == range_mm ? grid : faint, 1.5);
        ring(cr, (spot_t){MIDDLE_X, MIDDLE_Y}, pixels(survey, mm));
        spot_t at = at_bearing(15, pixels(survey, mm) - 16);
        char label[16];
        at.y += 6;
        (void)snprintf(label, sizeof label, "%g m", mm / 1000.0);
        (void)text(cr, at, 0.5, 16, muted, label);
    }
}

static void draw_bearings(cairo_t *cr)
{
    static const char *const sides[4] = {"front", "right", "back", "left"};
    for (int degrees = 0; degrees < 360; degrees += 5) {
        ink(cr, grid, 1.2);
        line(cr, at_bearing(degrees, RADIUS),
             at_bearing(degrees, RADIUS + (degrees % 10 == 0 ? 9 : 5)));
    }
    for (int degrees = 0; degrees < 360; degrees += 30) {
        const bool is_axis = degrees % 90 == 0;
        char label[16];
        ink(cr, faint, is_axis ? 1.5 : 1);
        line(cr, at_bearing(degrees, 24), at_bearing(degrees, RADIUS));
        spot_t at = at_bearing(degrees, RADIUS + 40);
        at.y += is_axis ? -3 : 7;
        (void)snprintf(label, sizeof label, "%d\xC2\xB0", degrees);
        (void)text(cr, at, 0.5, 20, bright, label);
        at.y += 21;
        (void)text(cr, at, 0.5, 17, muted, is_axis ? sides[degrees / 90] : "");
    }
}

/* The free space between lidar and points: faint beams that add up. */
static void draw_beams(cairo_t *cr, const figure_t *figure)
{
    cairo_set_line_width(cr, 1.6);
    cairo_set_source_rgba(cr, 0.35, 0.59, 1,
                          BEAM_ALPHA * fmin(1, BEAM_POINTS / (double)(figure->survey.valid + 1)));
    for (size_t i = 0; i < figure->survey.count; i++) {
        const tmini_point_t *const point = &figure->points[i];
        if (point->distance_mm > 0) {
            line(cr, at_bearing(point->angle_q6 / 64.0, 14), place_of(point, &figure->survey));
        }
    }
}

/* A ring for flag 2, a cross for flag 3 (section 5). */
static void draw_mark(cairo_t *cr, spot_t at, unsigned flag)
{
    if (flag == TMINI_FLAG_SPECULAR) {
        ink(cr, specular, 1.8);
        ring(cr, at, 7.4);
    } else if (flag == TMINI_FLAG_AMBIENT) {
        ink(cr, ambient, 1.8);
        line(cr, (spot_t){at.x - 6, at.y - 6}, (spot_t){at.x + 6, at.y + 6});
        line(cr, (spot_t){at.x - 6, at.y + 6}, (spot_t){at.x + 6, at.y - 6});
    }
}

bool picture_marks_flags(const survey_t *survey)
{
    return 2 * (survey->specular + survey->ambient) <= survey->valid;
}

/* The marks are above all points. */
static void draw_points(cairo_t *cr, const figure_t *figure)
{
    const survey_t *const survey = &figure->survey;
    for (size_t i = 0; i < survey->count; i++) {
        const tmini_point_t *const point = &figure->points[i];
        if (point->distance_mm > 0) {
            disc(cr, place_of(point, survey), 3.4, points_colour(survey, point->intensity));
        }
    }
    for (size_t i = 0; i < survey->count && picture_marks_flags(survey); i++) {
        const tmini_point_t *const point = &figure->points[i];
        if (point->distance_mm > 0) {
            draw_mark(cr, place_of(point, survey), point->flag);
        }
    }
    if (survey->nearest != NULL) {
        ink(cr, amber, 2.2);
        ring(cr, place_of(survey->nearest, survey), 12);
    } else {
        ink(cr, ground, 60); /* Hides the rings under the text. */
        line(cr, (spot_t){MIDDLE_X - 370, MIDDLE_Y + 140},
             (spot_t){MIDDLE_X + 370, MIDDLE_Y + 140});
        (void)text(cr, (spot_t){MIDDLE_X, MIDDLE_Y + 150}, 0.5, 30, amber,
                   "no point has a distance: is the window covered?");
    }
}

static void draw_lidar(cairo_t *cr)
{
    const spot_t middle = {MIDDLE_X, MIDDLE_Y};
    const spot_t tip = at_bearing(0, 32);
    disc(cr, middle, 11, background);
    disc(cr, middle, 3.5, bright);
    ink(cr, bright, 2);
    ring(cr, middle, 11);
    line(cr, at_bearing(0, 11), tip);
    line(cr, tip, (spot_t){tip.x - 6, tip.y + 8});
    line(cr, tip, (spot_t){tip.x + 6, tip.y + 8});
}

/* After text that is not UTF-8 cairo draws nothing more, and file names may contain any bytes. */
static void copy_utf8(char *copy, size_t size, const char *words)
{
    const iconv_t checker = iconv_open("UTF-8", "UTF-8");
    char *in = (char *)(uintptr_t)words;
    char *out = copy;
    size_t left = strlen(words);
    size_t room = size - 1;
    while (left > 0 && room > 0 && iconv(checker, &in, &left, &out, &room) == (size_t)-1 &&
           errno != E2BIG) {
        *out++ = '?';
        in++;
        left--;
        room--;
    }
    *out = '\0';
    (void)iconv_close(checker);
}

/* Makes the text smaller if it is too wide for the picture. */
static void heading(cairo_t *cr, double y, double size, colour_t colour, const char *words)
{
    char copy[600];
    cairo_text_extents_t extents;
    copy_utf8(copy, sizeof copy, words);
    cairo_set_font_size(cr, size);
    cairo_text_extents(cr, copy, &extents);
    const double share = fmin(1, (WIDTH - 80) / fmax(extents.x_advance, 1));
    (void)text(cr, (spot_t){MIDDLE_X, y}, 0.5, size * share, colour, copy);
}

static void draw_intensities(cairo_t *cr, const survey_t *survey)
{
    char words[24];
    (void)snprintf(words, sizeof words, "intensity %d ", survey->darkest);
    const double x = 50 + text(cr, (spot_t){50, LEGEND_Y}, 0, 17, muted, words);
    for (int i = 0; i < 64; i++) {
        const double share = survey->darkest + (survey->brightest - survey->darkest) * i / 63.0;
        ink(cr, points_colour(survey, (uint8_t)lround(share)), 12);
        cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
        line(cr, (spot_t){x + 3 * i, LEGEND_Y - 6}, (spot_t){x + 3 * i + 3, LEGEND_Y - 6});
    }
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    (void)snprintf(words, sizeof words, " %d", survey->brightest);
    (void)text(cr, (spot_t){x + 3 * 64, LEGEND_Y}, 0, 17, muted, words);
}

static void draw_flag(cairo_t *cr, double x, unsigned flag, const char *name, size_t count)
{
    char words[40];
    draw_mark(cr, (spot_t){x, LEGEND_Y - 6}, flag);
    (void)snprintf(words, sizeof words, "%s (%zu)", name, count);
    (void)text(cr, (spot_t){x + 18, LEGEND_Y}, 0, 17, muted, words);
}

static void draw_flags(cairo_t *cr, const survey_t *survey)
{
    if (picture_marks_flags(survey)) {
        draw_flag(cr, 470, TMINI_FLAG_SPECULAR, "specular", survey->specular);
        draw_flag(cr, 625, TMINI_FLAG_AMBIENT, "ambient light", survey->ambient);
    } else {
        char words[80];
        (void)snprintf(words, sizeof words, "%zu of %zu points flagged: not marked",
                       survey->specular + survey->ambient, survey->valid);
        (void)text(cr, (spot_t){450, LEGEND_Y}, 0, 17, muted, words);
    }
}

static void draw_nearest(cairo_t *cr, const tmini_point_t *nearest)
{
    char words[64];
    (void)snprintf(words, sizeof words, "nearest %.3f m at %.1f\xC2\xB0",
                   nearest->distance_mm / 1000.0, points_degrees(nearest));
    const double width = text(cr, (spot_t){1150, LEGEND_Y}, 1, 17, bright, words);
    ink(cr, amber, 2.2);
    ring(cr, (spot_t){1150 - width - 18, LEGEND_Y - 6}, 8);
}

static void draw_words(cairo_t *cr, const figure_t *figure)
{
    const survey_t *const survey = &figure->survey;
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    heading(cr, 62, 36, bright, figure->title);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    heading(cr, 98, 20, muted, figure->subtitle);
    if (survey->nearest != NULL) {
        draw_intensities(cr, survey);
        draw_flags(cr, survey);
        draw_nearest(cr, survey->nearest);
    }
    heading(cr, LEGEND_Y + 42, 15, muted,
            "seen from above \xC2\xB7 the lidar in the middle, its front up \xC2\xB7 "
            "angles clockwise");
}

static void draw(cairo_t *cr, const figure_t *figure)
{
    ink(cr, background, 1);
    cairo_paint(cr);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    disc(cr, (spot_t){MIDDLE_X, MIDDLE_Y}, RADIUS, ground);
    draw_beams(cr, figure);
    draw_rings(cr, &figure->survey);
    draw_bearings(cr);
    draw_points(cr, figure);
    draw_lidar(cr);
    draw_words(cr, figure);
}

static bool ends_with(const char *path, const char *ending)
{
    const size_t length = strlen(path);
    return length > strlen(ending) && strcmp(path + length - strlen(ending), ending) == 0;
}

bool picture_is_known(const char *path)
{
    return ends_with(path, ".svg") || ends_with(path, ".png") || ends_with(path, ".pdf") ||
           strcmp(path, "-") == 0;
}

static cairo_status_t write_bytes(void *file, const unsigned char *bytes, unsigned count)
{
    return fwrite(bytes, 1, count, file) == count ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static cairo_surface_t *sheet_for(const char *path, FILE *file)
{
    if (ends_with(path, ".png")) {
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, WIDTH, HEIGHT);
    }
    return (ends_with(path, ".pdf")
                ? cairo_pdf_surface_create_for_stream
                : cairo_svg_surface_create_for_stream)(write_bytes, file, WIDTH, HEIGHT);
}

static cairo_status_t save(const char *path, FILE *file, const figure_t *figure)
{
    cairo_surface_t *const sheet = sheet_for(path, file);
    cairo_t *const cr = cairo_create(sheet);
    draw(cr, figure);
    cairo_status_t status = cairo_status(cr);
    cairo_destroy(cr);
    if (status == CAIRO_STATUS_SUCCESS && ends_with(path, ".png")) {
        status = cairo_surface_write_to_png_stream(sheet, write_bytes, file);
    }
    cairo_surface_finish(sheet);
    status = status == CAIRO_STATUS_SUCCESS ? cairo_surface_status(sheet) : status;
    cairo_surface_destroy(sheet);
    return status;
}

int picture_write(const char *path, const figure_t *figure)
{
    FILE *const file = output_open(path);
    if (file == NULL) {
        return STATUS_FAILED;
    }
    const cairo_status_t status = save(path, file, figure);
    const int written = output_close(file, path, STATUS_OK);
    if (written == STATUS_OK && status != CAIRO_STATUS_SUCCESS && ferror(stdout) == 0) {
        return message_fail("cannot write %s: %s", path, cairo_status_to_string(status));
    }
    return written;
}
