/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "polar.h"

#include <math.h>
#include <stdio.h>

#include "polar_scale.h"
#include "ramp.h"

#define RADIUS 500.0
#define POINT_RADIUS 3.4
#define LEGEND_Y 1290.0

static const spot_t centre = {600, 690};

static const paint_t background = {10, 16, 30, 1};
static const paint_t ground = {16, 25, 45, 1};
static const paint_t grid = {52, 70, 108, 1};
static const paint_t faint = {36, 50, 80, 1};
static const paint_t bright = {232, 239, 250, 1};
static const paint_t muted = {140, 158, 190, 1};
static const paint_t amber = {255, 178, 56, 1};
static const paint_t specular = {255, 92, 170, 1};
static const paint_t ambient = {255, 96, 72, 1};

static double pixels_per_mm(const scale_t *scale)
{
    return RADIUS / scale->range_mm;
}

/* The place that many pixels from the lidar, at an angle clockwise from the front. */
static spot_t at_bearing(double degrees, double distance)
{
    const double radians = degrees * acos(-1) / 180;
    return (spot_t){centre.x + distance * sin(radians), centre.y - distance * cos(radians)};
}

static spot_t place_of(const tmini_point_t *point, const scale_t *scale)
{
    return at_bearing(point->angle_q6 / 64.0, point->distance_mm * pixels_per_mm(scale));
}

/* Calls `draw` for each point that has a distance. */
static void for_each_point(const sheet_t *sheet, const figure_t *figure, const scale_t *scale,
                           void (*draw)(const sheet_t *, const tmini_point_t *, const scale_t *))
{
    for (size_t i = 0; i < figure->count; i++) {
        const tmini_scan_t *const scan = figure->scans[i];
        for (size_t j = 0; j < scan->count; j++) {
            if (scan->points[j].distance_mm > 0) {
                draw(sheet, &scan->points[j], scale);
            }
        }
    }
}

/* ------------------------------------------------------------------------------------- the grid */

static void draw_ground(const sheet_t *sheet)
{
    sheet->begin(sheet->self, "ground");
    sheet->box(sheet->self, (spot_t){0, 0}, (spot_t){POLAR_WIDTH, POLAR_HEIGHT}, background);
    sheet->disc(sheet->self, centre, RADIUS, ground);
    sheet->end(sheet->self);
}

static void draw_rings(const sheet_t *sheet, const scale_t *scale)
{
    sheet->begin(sheet->self, "rings");
    for (unsigned mm = scale->step_mm; mm <= scale->range_mm; mm += scale->step_mm) {
        const pen_t pen = {mm == scale->range_mm ? grid : faint, 1.5, false};
        sheet->ring(sheet->self, centre, mm * pixels_per_mm(scale), &pen);
    }
    sheet->end(sheet->self);
}

static void draw_spokes(const sheet_t *sheet)
{
    sheet->begin(sheet->self, "spokes");
    for (int degrees = 0; degrees < 360; degrees += 30) {
        const bool is_axis = degrees % 90 == 0;
        const pen_t pen = {faint, is_axis ? 1.5 : 1, false};
        sheet->line(sheet->self, at_bearing(degrees, 24), at_bearing(degrees, RADIUS), &pen);
    }
    const pen_t tick = {grid, 1.2, false};
    for (int degrees = 0; degrees < 360; degrees += 5) {
        const double length = degrees % 10 == 0 ? 9 : 5;
        sheet->line(sheet->self, at_bearing(degrees, RADIUS), at_bearing(degrees, RADIUS + length),
                    &tick);
    }
    sheet->end(sheet->self);
}

static void draw_bearings(const sheet_t *sheet)
{
    static const char *const sides[4] = {"front", "right", "back", "left"};
    const font_t number = {bright, 20, ALIGN_CENTRE, false};
    const font_t word = {muted, 17, ALIGN_CENTRE, false};
    sheet->begin(sheet->self, "bearings");
    for (int degrees = 0; degrees < 360; degrees += 30) {
        const bool is_axis = degrees % 90 == 0;
        spot_t at = at_bearing(degrees, RADIUS + 40);
        char text[16];
        (void)snprintf(text, sizeof text, "%d\xC2\xB0", degrees);
        at.y += is_axis ? -3 : 7;
        sheet->text(sheet->self, at, text, &number);
        if (is_axis) {
            at.y += 21;
            sheet->text(sheet->self, at, sides[degrees / 90], &word);
        }
    }
    sheet->end(sheet->self);
}

/* Along the bearing of 15 degrees, each just within its ring. */
static void draw_ranges(const sheet_t *sheet, const scale_t *scale)
{
    const font_t font = {muted, 16, ALIGN_CENTRE, false};
    sheet->begin(sheet->self, "ranges");
    for (unsigned mm = scale->step_mm; mm <= scale->range_mm; mm += scale->step_mm) {
        const spot_t at = at_bearing(15, mm * pixels_per_mm(scale) - 16);
        char text[16];
        (void)snprintf(text, sizeof text, "%.*f m", scale->decimals, mm / 1000.0);
        sheet->text(sheet->self, (spot_t){at.x, at.y + 6}, text, &font);
    }
    sheet->end(sheet->self);
}

/* ----------------------------------------------------------------------------------- the points */

/* What the lidar has looked through: faint beams that add up to light. */
static void draw_beam(const sheet_t *sheet, const tmini_point_t *point, const scale_t *scale)
{
    const pen_t pen = {{90, 150, 255, scale->beam_alpha}, 1.6, false};
    sheet->line(sheet->self, at_bearing(point->angle_q6 / 64.0, 14), place_of(point, scale), &pen);
}

static void draw_point(const sheet_t *sheet, const tmini_point_t *point, const scale_t *scale)
{
    sheet->disc(sheet->self, place_of(point, scale), POINT_RADIUS,
                ramp_colour(scale_intensity(scale, point->intensity)));
}

/* A ring for flag 2, a cross for flag 3 (section 5). */
static void draw_mark(const sheet_t *sheet, spot_t at, unsigned flag)
{
    if (flag == TMINI_FLAG_SPECULAR) {
        const pen_t pen = {specular, 1.8, false};
        sheet->ring(sheet->self, at, POINT_RADIUS + 4, &pen);
    } else if (flag == TMINI_FLAG_AMBIENT) {
        const pen_t pen = {ambient, 1.8, false};
        sheet->line(sheet->self, (spot_t){at.x - 6, at.y - 6}, (spot_t){at.x + 6, at.y + 6}, &pen);
        sheet->line(sheet->self, (spot_t){at.x - 6, at.y + 6}, (spot_t){at.x + 6, at.y - 6}, &pen);
    }
}

static void draw_interference(const sheet_t *sheet, const tmini_point_t *point,
                              const scale_t *scale)
{
    draw_mark(sheet, place_of(point, scale), point->flag);
}

static void draw_points(const sheet_t *sheet, const figure_t *figure, const scale_t *scale)
{
    sheet->begin(sheet->self, "points");
    for_each_point(sheet, figure, scale, draw_point);
    sheet->end(sheet->self);
    sheet->begin(sheet->self, "interference");
    for_each_point(sheet, figure, scale, draw_interference);
    sheet->end(sheet->self);
}

static void draw_nearest(const sheet_t *sheet, const scale_t *scale)
{
    if (scale->nearest == NULL) {
        return;
    }
    const pen_t pen = {amber, 2.2, false};
    sheet->begin(sheet->self, "nearest");
    sheet->ring(sheet->self, place_of(scale->nearest, scale), 12, &pen);
    sheet->end(sheet->self);
}

/* The lidar, and an arrow towards its front. */
static void draw_lidar(const sheet_t *sheet)
{
    const pen_t edge = {bright, 2, false};
    const spot_t tip = at_bearing(0, 32);
    sheet->begin(sheet->self, "lidar");
    sheet->disc(sheet->self, centre, 11, background);
    sheet->ring(sheet->self, centre, 11, &edge);
    sheet->disc(sheet->self, centre, 3.5, bright);
    sheet->line(sheet->self, at_bearing(0, 11), tip, &edge);
    sheet->line(sheet->self, tip, (spot_t){tip.x - 6, tip.y + 8}, &edge);
    sheet->line(sheet->self, tip, (spot_t){tip.x + 6, tip.y + 8}, &edge);
    sheet->end(sheet->self);
}

/* ------------------------------------------------------------------------------------- the words */

static void draw_title(const sheet_t *sheet, const figure_t *figure)
{
    const font_t title = {bright, 36, ALIGN_CENTRE, true};
    const font_t subtitle = {muted, 20, ALIGN_CENTRE, false};
    sheet->begin(sheet->self, "title");
    sheet->text(sheet->self, (spot_t){centre.x, 62}, figure->title, &title);
    sheet->text(sheet->self, (spot_t){centre.x, 98}, figure->subtitle, &subtitle);
    sheet->end(sheet->self);
}

static void draw_intensities(const sheet_t *sheet, const scale_t *scale)
{
    enum { STRIPES = 64 };
    const font_t font = {muted, 17, ALIGN_LEFT, false};
    const font_t low = {bright, 17, ALIGN_RIGHT, false};
    const font_t high = {bright, 17, ALIGN_LEFT, false};
    char text[8];
    for (int i = 0; i < STRIPES; i++) {
        sheet->box(sheet->self, (spot_t){180 + 3.0 * i, LEGEND_Y - 12}, (spot_t){3, 12},
                   ramp_colour((i + 0.5) / STRIPES));
    }
    sheet->text(sheet->self, (spot_t){50, LEGEND_Y}, "intensity", &font);
    (void)snprintf(text, sizeof text, "%d", scale->darkest);
    sheet->text(sheet->self, (spot_t){170, LEGEND_Y}, text, &low);
    (void)snprintf(text, sizeof text, "%d", scale->brightest);
    sheet->text(sheet->self, (spot_t){190 + 3.0 * STRIPES, LEGEND_Y}, text, &high);
}

static void draw_flags(const sheet_t *sheet, const scale_t *scale)
{
    const font_t font = {muted, 17, ALIGN_LEFT, false};
    const spot_t ring_at = {470, LEGEND_Y - 6};
    const spot_t cross_at = {660, LEGEND_Y - 6};
    char text[48];
    draw_mark(sheet, ring_at, TMINI_FLAG_SPECULAR);
    (void)snprintf(text, sizeof text, "specular (%zu)", scale->specular);
    sheet->text(sheet->self, (spot_t){ring_at.x + 18, LEGEND_Y}, text, &font);
    draw_mark(sheet, cross_at, TMINI_FLAG_AMBIENT);
    (void)snprintf(text, sizeof text, "ambient light (%zu)", scale->ambient);
    sheet->text(sheet->self, (spot_t){cross_at.x + 18, LEGEND_Y}, text, &font);
}

static void draw_nearest_words(const sheet_t *sheet, const scale_t *scale)
{
    if (scale->nearest == NULL) {
        return;
    }
    const font_t font = {bright, 17, ALIGN_LEFT, false};
    const pen_t pen = {amber, 2.2, false};
    char text[64];
    (void)snprintf(text, sizeof text, "nearest %.3f m at %.1f\xC2\xB0",
                   scale->nearest->distance_mm / 1000.0, scale->nearest->angle_q6 / 64.0);
    sheet->text(sheet->self, (spot_t){924, LEGEND_Y}, text, &font);
    sheet->ring(sheet->self, (spot_t){906, LEGEND_Y - 6}, 8, &pen);
}

static void draw_legend(const sheet_t *sheet, const scale_t *scale)
{
    const font_t font = {muted, 15, ALIGN_CENTRE, false};
    sheet->begin(sheet->self, "legend");
    draw_intensities(sheet, scale);
    draw_flags(sheet, scale);
    draw_nearest_words(sheet, scale);
    sheet->text(sheet->self, (spot_t){centre.x, LEGEND_Y + 42},
                "seen from above \xC2\xB7 the lidar in the middle, its front up \xC2\xB7 "
                "angles clockwise",
                &font);
    sheet->end(sheet->self);
}

void polar_draw(const sheet_t *sheet, const figure_t *figure)
{
    scale_t scale;
    scale_fit(&scale, figure);
    draw_ground(sheet);
    sheet->begin(sheet->self, "beams");
    for_each_point(sheet, figure, &scale, draw_beam);
    sheet->end(sheet->self);
    draw_rings(sheet, &scale);
    draw_spokes(sheet);
    draw_bearings(sheet);
    draw_ranges(sheet, &scale);
    draw_points(sheet, figure, &scale);
    draw_nearest(sheet, &scale);
    draw_lidar(sheet);
    draw_title(sheet, figure);
    draw_legend(sheet, &scale);
}
