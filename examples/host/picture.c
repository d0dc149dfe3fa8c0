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

#include "message.h"
#include "scale.h"

#define WIDTH 1200
#define HEIGHT 1360
#define MIDDLE_X 600.0
#define MIDDLE_Y 690.0
#define RADIUS 500.0
#define LEGEND_Y 1290.0
#define TURN (2 * 3.14159265358979323846)

/* Light of the beams in a picture of one scan, which has about so many points. */
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

/* The place that many pixels from the lidar, at an angle clockwise from the front. */
static spot_t at_bearing(double degrees, double distance)
{
    const double radians = degrees * TURN / 360;
    return (spot_t){MIDDLE_X + distance * sin(radians), MIDDLE_Y - distance * cos(radians)};
}

static double pixels(const scale_t *scale, unsigned mm)
{
    return RADIUS * mm / scale->range_mm;
}

static spot_t place_of(const tmini_point_t *point, const scale_t *scale)
{
    return at_bearing(point->angle_q6 / 64.0, pixels(scale, point->distance_mm));
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

/* A line from a place to itself has round ends and nothing between: the shortest way to say "disc".
 * */
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

static void draw_rings(cairo_t *cr, const scale_t *scale)
{
    char label[16];
    for (unsigned mm = scale->step_mm; mm <= scale->range_mm; mm += scale->step_mm) {
        ink(cr, mm == scale->range_mm ? grid : faint, 1.5);
        ring(cr, (spot_t){MIDDLE_X, MIDDLE_Y}, pixels(scale, mm));
    }
    for (unsigned mm = scale->step_mm; mm <= scale->range_mm; mm += scale->step_mm) {
        spot_t at = at_bearing(15, pixels(scale, mm) - 16);
        at.y += 6;
        (void)snprintf(label, sizeof label, "%.*f m", scale->decimals, mm / 1000.0);
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

/* What the lidar has looked through: faint beams that add up to light. */
static void draw_beams(cairo_t *cr, const figure_t *figure, const scale_t *scale)
{
    cairo_set_line_width(cr, 1.6);
    cairo_set_source_rgba(cr, 0.35, 0.59, 1,
                          BEAM_ALPHA * fmin(1, BEAM_POINTS / (double)(scale->valid + 1)));
    for (size_t i = 0; i < figure->count; i++) {
        const tmini_point_t *const point = &figure->points[i];
        if (point->distance_mm > 0) {
            line(cr, at_bearing(point->angle_q6 / 64.0, 14), place_of(point, scale));
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

/* Some units flag every sample (section 9.9): marks on all of them would hide the room. */
static bool is_marking(const scale_t *scale)
{
    return 2 * (scale->specular + scale->ambient) <= scale->valid;
}

static void draw_points(cairo_t *cr, const figure_t *figure, const scale_t *scale)
{
    for (size_t i = 0; i < figure->count; i++) {
        const tmini_point_t *const point = &figure->points[i];
        if (point->distance_mm > 0) {
            disc(cr, place_of(point, scale), 3.4, scale_colour(scale, point->intensity));
        }
    }
    for (size_t i = 0; i < figure->count && is_marking(scale); i++) {
        const tmini_point_t *const point = &figure->points[i];
        if (point->distance_mm > 0) {
            draw_mark(cr, place_of(point, scale), point->flag);
        }
    }
    if (scale->nearest != NULL) {
        ink(cr, amber, 2.2);
        ring(cr, place_of(scale->nearest, scale), 12);
    } else {
        (void)text(cr, (spot_t){MIDDLE_X, MIDDLE_Y - 150}, 0.5, 30, amber,
                   "no point has a distance: is the window covered?");
    }
}

/* The lidar, and an arrow towards its front. */
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

/* cairo draws nothing more after text that is not UTF-8, and names of files may be anything. */
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

/* As large as fits across the picture. */
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

static void draw_intensities(cairo_t *cr, const scale_t *scale)
{
    char words[24];
    (void)snprintf(words, sizeof words, "intensity %d ", scale->darkest);
    const double x = 50 + text(cr, (spot_t){50, LEGEND_Y}, 0, 17, muted, words);
    for (int i = 0; i < 64; i++) {
        const double share = scale->darkest + (scale->brightest - scale->darkest) * i / 63.0;
        ink(cr, scale_colour(scale, (uint8_t)lround(share)), 12);
        cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
        line(cr, (spot_t){x + 3 * i, LEGEND_Y - 6}, (spot_t){x + 3 * i + 3, LEGEND_Y - 6});
    }
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    (void)snprintf(words, sizeof words, " %d", scale->brightest);
    (void)text(cr, (spot_t){x + 3 * 64, LEGEND_Y}, 0, 17, muted, words);
}

static void draw_flags(cairo_t *cr, const scale_t *scale)
{
    char words[80];
    double x = 470;
    if (!is_marking(scale)) {
        (void)snprintf(words, sizeof words, "%zu of %zu points flagged: not marked",
                       scale->specular + scale->ambient, scale->valid);
        (void)text(cr, (spot_t){x, LEGEND_Y}, 0, 17, muted, words);
        return;
    }
    draw_mark(cr, (spot_t){x, LEGEND_Y - 6}, TMINI_FLAG_SPECULAR);
    (void)snprintf(words, sizeof words, "specular (%zu)", scale->specular);
    x += 52 + text(cr, (spot_t){x + 18, LEGEND_Y}, 0, 17, muted, words);
    draw_mark(cr, (spot_t){x, LEGEND_Y - 6}, TMINI_FLAG_AMBIENT);
    (void)snprintf(words, sizeof words, "ambient light (%zu)", scale->ambient);
    (void)text(cr, (spot_t){x + 18, LEGEND_Y}, 0, 17, muted, words);
}

static void draw_words(cairo_t *cr, const figure_t *figure, const scale_t *scale)
{
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
    heading(cr, 62, 36, bright, figure->title);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    heading(cr, 98, 20, muted, figure->subtitle);
    if (scale->nearest != NULL) {
        draw_intensities(cr, scale);
        draw_flags(cr, scale);
        char words[64];
        (void)snprintf(words, sizeof words, "nearest %.3f m at %.1f\xC2\xB0",
                       scale->nearest->distance_mm / 1000.0, scale->nearest->angle_q6 / 64.0);
        const double width = text(cr, (spot_t){1150, LEGEND_Y}, 1, 17, bright, words);
        ink(cr, amber, 2.2);
        ring(cr, (spot_t){1150 - width - 18, LEGEND_Y - 6}, 8);
    }
    heading(cr, LEGEND_Y + 42, 15, muted,
            "seen from above \xC2\xB7 the lidar in the middle, its front up \xC2\xB7 "
            "angles clockwise");
}

static void draw(cairo_t *cr, const figure_t *figure)
{
    scale_t scale;
    scale_fit(&scale, figure->points, figure->count);
    ink(cr, background, 1);
    cairo_paint(cr);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    disc(cr, (spot_t){MIDDLE_X, MIDDLE_Y}, RADIUS, ground);
    draw_beams(cr, figure, &scale);
    draw_rings(cr, &scale);
    draw_bearings(cr);
    draw_points(cr, figure, &scale);
    draw_lidar(cr);
    draw_words(cr, figure, &scale);
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
    FILE *const file = strcmp(path, "-") == 0 ? stdout : fopen(path, "wb");
    if (file == NULL) {
        return message_fail("cannot write %s: %s", path, strerror(errno));
    }
    errno = 0;
    const cairo_status_t status = save(path, file, figure);
    const bool is_written = (file == stdout ? fflush(file) : fclose(file)) == 0;
    if (status != CAIRO_STATUS_SUCCESS || !is_written) {
        return message_fail("cannot write %s: %s", path,
                            errno != 0 ? strerror(errno) : cairo_status_to_string(status));
    }
    return STATUS_OK;
}
