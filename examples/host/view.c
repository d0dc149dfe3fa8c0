/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "view.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "points.h"
#include "tmini/tmini_sectors.h"

#define PANEL_COLUMNS 27
#define PICTURE_COLUMNS_MIN 24
#define PANEL_ROWS 20             /* With fewer rows, only the more important values are shown. */
#define LIDAR_CHARACTER 0x25B2u   /* a triangle that points up */
#define NEAREST_CHARACTER 0x25C6u /* a diamond */

/* Ranges of the picture, and the rings in it. */
static const struct {
    unsigned range_mm;
    unsigned step_mm;
} zooms[] = {
    {500, 250},   {1000, 500},  {2000, 500},   {3000, 1000},  {4000, 1000},
    {6000, 2000}, {8000, 2000}, {12000, 4000}, {17000, 5000},
};
#define EMPTY_MM 3000u /* The range of a picture without points. */
#define ZOOMS (sizeof zooms / sizeof zooms[0])

/* Where the picture is, in dots, which have the same distance in both directions. */
typedef struct {
    double x; /* The lidar. */
    double y;
    double radius;
    unsigned range_mm;
} frame_t;

static size_t zoom_of(unsigned range_mm)
{
    size_t i = 0;
    while (i + 1 < ZOOMS && zooms[i].range_mm < range_mm) {
        i++;
    }
    return i;
}

/* Automatic changes only widen range and colours, so that the picture does not flicker. */
static void choose_scale(view_t *view)
{
    const survey_t *const survey = &view->survey;
    survey_t *const colours = &view->colours;
    if (view->range_mm == 0 || survey->darkest < colours->darkest) {
        colours->darkest = survey->darkest;
    }
    if (view->range_mm == 0 || survey->brightest > colours->brightest) {
        colours->brightest = survey->brightest;
    }
    if (view->zoom_mm > 0) {
        view->range_mm = view->zoom_mm;
    } else if (survey->farthest_mm > view->range_mm) {
        view->range_mm = zooms[zoom_of(survey->farthest_mm)].range_mm;
    } else if (view->range_mm == 0) {
        view->range_mm = EMPTY_MM;
    }
}

void view_zoom(view_t *view, bool in)
{
    const size_t now = zoom_of(view->range_mm);
    if (in && now > 0) {
        view->zoom_mm = zooms[now - 1].range_mm;
    } else if (!in && now + 1 < ZOOMS) {
        view->zoom_mm = zooms[now + 1].range_mm;
    }
}

static bool has_panel(const screen_t *screen)
{
    return screen->columns >= PANEL_COLUMNS + PICTURE_COLUMNS_MIN;
}

/* The largest circle that fits between the first and the last row. */
static frame_t frame_of(const screen_t *screen, const view_t *view)
{
    const int rows = screen->rows > 2 ? (int)screen->rows - 2 : 1;
    const int columns = (int)screen->columns - (has_panel(screen) ? PANEL_COLUMNS : 0);
    return (frame_t){.x = columns - 0.5,
                     .y = 4 + 2 * rows - 0.5,
                     .radius = fmin(columns - 1, 2 * rows - 1),
                     .range_mm = view->range_mm};
}

typedef struct {
    double x, y;
} spot_t;

static spot_t place_of(const frame_t *frame, double degrees, double distance)
{
    const double radians = degrees * acos(-1) / 180;
    return (spot_t){frame->x + distance * sin(radians), frame->y - distance * cos(radians)};
}

static spot_t place_of_point(const frame_t *frame, const tmini_point_t *point)
{
    return place_of(frame, point->angle_q6 / 64.0,
                    frame->radius * point->distance_mm / frame->range_mm);
}

static void grid_dot(screen_t *screen, const frame_t *frame, double degrees, double distance)
{
    const spot_t spot = place_of(frame, degrees, distance);
    screen_dot(screen, (int)lround(spot.x), (int)lround(spot.y), LAYER_GRID, COLOUR_GRID);
}

static void draw_grid(screen_t *screen, const frame_t *frame)
{
    const unsigned step_mm = zooms[zoom_of(frame->range_mm)].step_mm;
    for (unsigned mm = step_mm; mm <= frame->range_mm; mm += step_mm) {
        const double radius = frame->radius * mm / frame->range_mm;
        const int dots = (int)(2 * acos(-1) * fmax(radius, 3) / 3);
        for (int i = 0; i <= dots; i++) {
            grid_dot(screen, frame, 360.0 * i / dots, radius);
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int distance = 6; distance < frame->radius; distance += 4) {
            grid_dot(screen, frame, 90.0 * i, distance);
        }
    }
}

/* Writes the distance in metres where each ring crosses the axis to the back. */
static void label_rings(screen_t *screen, const frame_t *frame)
{
    const unsigned step_mm = zooms[zoom_of(frame->range_mm)].step_mm;
    for (unsigned mm = step_mm; mm <= frame->range_mm; mm += step_mm) {
        const double y = frame->y + frame->radius * mm / frame->range_mm;
        char text[16];
        (void)snprintf(text, sizeof text, "%g m", mm / 1000.0);
        screen_text(screen, (int)(frame->x / 2) + 2, (int)(y / 4), text, COLOUR_DIM);
    }
}

/* The nearest colour in the terminal's 6 x 6 x 6 cube of colours. */
static uint8_t terminal_colour(colour_t colour)
{
    return (uint8_t)(16 + 36 * lround(colour.red * 5) + 6 * lround(colour.green * 5) +
                     lround(colour.blue * 5));
}

static void draw_points(screen_t *screen, const frame_t *frame, const view_t *view)
{
    const tmini_scan_t *const scan = &view->stream->scan;
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        if (point->distance_mm > 0 && point->distance_mm <= frame->range_mm) {
            const spot_t spot = place_of_point(frame, point);
            screen_dot(screen, (int)lround(spot.x), (int)lround(spot.y), LAYER_POINTS,
                       terminal_colour(points_colour(&view->colours, point->intensity)));
        }
    }
}

static void mark_nearest(screen_t *screen, const frame_t *frame, const tmini_point_t *nearest)
{
    if (nearest != NULL && nearest->distance_mm <= frame->range_mm) {
        const spot_t spot = place_of_point(frame, nearest);
        screen_put(screen, (int)lround(spot.x) / 2, (int)lround(spot.y) / 4, NEAREST_CHARACTER, 'X',
                   COLOUR_AMBER);
    }
}

static void draw_picture(screen_t *screen, const view_t *view)
{
    const frame_t frame = frame_of(screen, view);
    draw_grid(screen, &frame);
    draw_points(screen, &frame, view);
    label_rings(screen, &frame);
    mark_nearest(screen, &frame, view->survey.nearest);
    screen_put(screen, (int)(frame.x / 2), (int)(frame.y / 4), LIDAR_CHARACTER, 'A', COLOUR_PLAIN);
}

/* Leaves out rows that do not fit: the last row is for keys, the one above for faults. */
static void say(screen_t *screen, int *row, const char *name, uint8_t colour, const char *format,
                ...)
{
    const int column = (int)screen->columns - PANEL_COLUMNS + 1;
    char value[40];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(value, sizeof value, format, arguments);
    va_end(arguments);
    if (*row < (int)screen->rows - 2) {
        screen_text(screen, column, *row, name, COLOUR_DIM);
        screen_text(screen, column + 10, *row, value, colour);
    }
    (*row)++;
}

/* Right-aligned, and cut off at `from`. */
static void say_right(screen_t *screen, int from, int row, const char *text, uint8_t colour)
{
    const int column = (int)screen->columns - (int)strlen(text) - 1;
    screen_text(screen, column > from ? column : from, row, text, colour);
}

static void say_nearest(screen_t *screen, int *row, const tmini_point_t *nearest)
{
    if (nearest == NULL) {
        say(screen, row, "nearest", COLOUR_AMBER, "nothing");
        *row += 2;
        return;
    }
    say(screen, row, "nearest", COLOUR_AMBER, "%.3f m", nearest->distance_mm / 1000.0);
    say(screen, row, "", COLOUR_AMBER, "at %d deg,", nearest->angle_q6 / 64);
    say_right(screen, (int)screen->columns - PANEL_COLUMNS, (*row)++,
              direction_name(nearest->angle_q6), COLOUR_AMBER);
}

/* Shows the nearest obstacle of each of eight sectors, at the sector's place around the lidar. */
static void say_sectors(screen_t *screen, int *row, const tmini_scan_t *scan)
{
    static const struct {
        int column, row;
    } places[8] = {{9, 0}, {17, 1}, {20, 2}, {17, 3}, {9, 4}, {1, 3}, {-2, 2}, {1, 1}};
    tmini_sector_t held[8];
    tmini_sectors_t sectors;
    (void)tmini_sectors_init(&sectors, held, 8, TMINI_FILTER_NONE);
    tmini_sectors_add_scan(&sectors, scan);
    const int column = (int)screen->columns - PANEL_COLUMNS + 3;
    for (size_t i = 0; i < 8; i++) {
        char text[16] = "-";
        if (!tmini_sector_is_blind(&held[i])) {
            (void)snprintf(text, sizeof text, "%.2f", held[i].nearest_mm / 1000.0);
        }
        screen_text(screen, column + places[i].column, *row + places[i].row, text, COLOUR_PLAIN);
    }
    screen_put(screen, column + 10, *row + 2, LIDAR_CHARACTER, 'A', COLOUR_DIM);
    *row += 5;
}

static bool is_faulty(const view_t *view)
{
    return view->faults != 0 && view->faults != TMINI_FAULTS_UNKNOWN;
}

static const char *health_name(const view_t *view)
{
    if (view->faults == TMINI_FAULTS_UNKNOWN) {
        return stream_reports_nothing(view->stream) ? "not reported" : "unknown";
    }
    return view->faults == 0 ? "healthy" : "FAULTY";
}

static void draw_panel(screen_t *screen, const view_t *view)
{
    const stream_t *const stream = view->stream;
    int row = 2;
    if (stream->scans > 0 && screen->rows >= PANEL_ROWS) {
        say_nearest(screen, &row, view->survey.nearest);
        row++;
        say_sectors(screen, &row, &stream->scan);
        row++;
    }
    if (stream->scans > 0) {
        say(screen, &row, "points", COLOUR_PLAIN, "%zu, %zu valid", view->survey.count,
            view->survey.valid);
    }
    say(screen, &row, "range", COLOUR_PLAIN, "%g m%s", view->range_mm / 1000.0,
        view->zoom_mm > 0 ? "" : ", auto");
    say(screen, &row, "packets", COLOUR_PLAIN, "%llu", stream->packets);
    say(screen, &row, "damaged", stream->damaged > 0 ? COLOUR_ALARM : COLOUR_PLAIN, "%s",
        damaged_text(stream));
    say(screen, &row, "health", is_faulty(view) ? COLOUR_ALARM : COLOUR_PLAIN, "%s",
        health_name(view));
}

static void draw_lines(screen_t *screen, const view_t *view)
{
    char text[FAULTS_TEXT_SIZE];
    const int last = (int)screen->rows - 1;
    const tmini_scan_t *const scan = &view->stream->scan;
    screen_text(screen, 1, 0, view->source, COLOUR_PLAIN);
    if (view->stream->scans > 0) {
        (void)snprintf(text, sizeof text, "  %sscan %llu  %s", scan->complete ? "" : "incomplete ",
                       view->stream->number, frequency_text(scan->frequency_chz));
        say_right(screen, 0, 0, text, scan->complete ? COLOUR_PLAIN : COLOUR_ALARM);
    }
    if (is_faulty(view)) {
        say_right(screen, 0, last - 1, faults_text(view->faults, text), COLOUR_ALARM);
    }
    const int keys = (int)strlen(view->keys);
    const bool fits = (int)screen->columns >= keys + (int)strlen(view->state) + 4;
    screen_text(screen, 1, last, fits ? view->keys : "q quit", COLOUR_DIM);
    say_right(screen, fits ? keys + 3 : 9, last, view->state, COLOUR_DIM);
}

void view_draw(view_t *view, screen_t *screen)
{
    view->survey = points_survey(view->stream->scan.points, view->stream->scan.count);
    choose_scale(view);
    screen_clear(screen);
    draw_picture(screen, view);
    if (has_panel(screen)) {
        draw_panel(screen, view);
    }
    draw_lines(screen, view);
}
