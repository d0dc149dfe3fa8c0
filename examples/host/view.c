/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "view.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "direction.h"
#include "polar_scale.h"
#include "ramp.h"
#include "scan_list.h"
#include "tmini/tmini_sectors.h"

#define PANEL_COLUMNS 27
#define PICTURE_COLUMNS_MIN 24
#define LIDAR_CHARACTER 0x25B2u   /* a triangle that points up */
#define NEAREST_CHARACTER 0x25C6u /* a diamond */
#define DEGREE_SIGN 0xB0u

/* Ranges of the picture, and the rings in it. */
static const struct {
    unsigned range_mm;
    unsigned step_mm;
} zooms[] = {
    {500, 250},   {1000, 500},  {2000, 500},   {3000, 1000},  {4000, 1000},
    {6000, 2000}, {8000, 2000}, {12000, 4000}, {17000, 5000},
};
#define ZOOMS (sizeof zooms / sizeof zooms[0])

/* Where the picture is: in dots, which are as far apart across as down. */
typedef struct {
    int columns; /* Of the screen, that the picture may use. */
    double x;    /* The lidar. */
    double y;
    double radius;
    unsigned range_mm;
} frame_t;

/* ---------------------------------------------------------------------------------------- range */

static size_t zoom_of(unsigned range_mm)
{
    size_t i = 0;
    while (i + 1 < ZOOMS && zooms[i].range_mm < range_mm) {
        i++;
    }
    return i;
}

/* By itself the range only grows: a picture that breathes is hard to look at. */
static void choose_range(view_t *view)
{
    unsigned farthest_mm = 0;
    for (size_t i = 0; view->scan != NULL && i < view->scan->count; i++) {
        const unsigned distance_mm = view->scan->points[i].distance_mm;
        farthest_mm = distance_mm > farthest_mm ? distance_mm : farthest_mm;
    }
    if (view->zoom_mm > 0) {
        view->range_mm = view->zoom_mm;
    } else if (farthest_mm > view->range_mm) {
        view->range_mm = zooms[zoom_of(farthest_mm)].range_mm;
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

/* -------------------------------------------------------------------------------------- picture */

/* The largest circle that fits between the first and the last row. */
static frame_t frame_of(const screen_t *screen, const view_t *view)
{
    const int rows = screen->rows > 2 ? (int)screen->rows - 2 : 1;
    int columns = (int)screen->columns;
    if (columns >= PANEL_COLUMNS + PICTURE_COLUMNS_MIN) {
        columns -= PANEL_COLUMNS;
    }
    frame_t frame = {.columns = columns, .range_mm = view->range_mm};
    frame.x = columns - 0.5;
    frame.y = 4 + 2 * rows - 0.5;
    frame.radius = fmin(columns - 1, 2 * rows - 1);
    return frame;
}

/* A place in the picture: dots from the lidar, in a direction. */
typedef struct {
    double degrees;
    double distance;
} bearing_t;

static spot_t place_of(const frame_t *frame, bearing_t bearing)
{
    const double radians = bearing.degrees * acos(-1) / 180;
    return (spot_t){frame->x + bearing.distance * sin(radians),
                    frame->y - bearing.distance * cos(radians)};
}

static spot_t place_of_point(const frame_t *frame, const tmini_point_t *point)
{
    return place_of(frame, (bearing_t){point->angle_q6 / 64.0,
                                       frame->radius * point->distance_mm / frame->range_mm});
}

static void grid_dot(screen_t *screen, const frame_t *frame, bearing_t bearing)
{
    const spot_t spot = place_of(frame, bearing);
    screen_dot(screen, (int)lround(spot.x), (int)lround(spot.y), LAYER_GRID, COLOUR_GRID);
}

/* Rings with a dot at every third place, and the axes to the four sides. */
static void draw_grid(screen_t *screen, const frame_t *frame)
{
    const unsigned step_mm = zooms[zoom_of(frame->range_mm)].step_mm;
    for (unsigned mm = step_mm; mm <= frame->range_mm; mm += step_mm) {
        const double radius = frame->radius * mm / frame->range_mm;
        const int dots = (int)(2 * acos(-1) * fmax(radius, 3) / 3);
        for (int i = 0; i <= dots; i++) {
            grid_dot(screen, frame, (bearing_t){360.0 * i / dots, radius});
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int distance = 6; distance < frame->radius; distance += 4) {
            grid_dot(screen, frame, (bearing_t){90.0 * i, distance});
        }
    }
}

/* Metres, beside the axis to the back, where each ring crosses it. */
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

/* The colour of the terminal's 6 x 6 x 6 cube that is nearest to an intensity's. */
static uint8_t terminal_colour(double share)
{
    const paint_t paint = ramp_colour(share);
    const int red = (paint.red + 25) / 51;
    const int green = (paint.green + 25) / 51;
    const int blue = (paint.blue + 25) / 51;
    return (uint8_t)(16 + 36 * red + 6 * green + blue);
}

static void draw_points(screen_t *screen, const frame_t *frame, const tmini_scan_t *scan)
{
    scale_t scale;
    scale_fit(&scale, &(figure_t){.scans = &scan, .count = 1});
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        if (point->distance_mm > 0 && point->distance_mm <= frame->range_mm) {
            const spot_t spot = place_of_point(frame, point);
            screen_dot(screen, (int)lround(spot.x), (int)lround(spot.y), LAYER_POINTS,
                       terminal_colour(scale_intensity(&scale, point->intensity)));
        }
    }
}

static void mark_nearest(screen_t *screen, const frame_t *frame, const tmini_point_t *nearest)
{
    if (nearest == NULL || nearest->distance_mm > frame->range_mm) {
        return;
    }
    const spot_t spot = place_of_point(frame, nearest);
    screen_put(screen, (int)lround(spot.x) / 2, (int)lround(spot.y) / 4, NEAREST_CHARACTER,
               COLOUR_AMBER);
}

static void draw_picture(screen_t *screen, const view_t *view)
{
    const frame_t frame = frame_of(screen, view);
    draw_grid(screen, &frame);
    if (view->scan != NULL) {
        draw_points(screen, &frame, view->scan);
    }
    label_rings(screen, &frame);
    if (view->scan != NULL) {
        mark_nearest(screen, &frame, scan_nearest(view->scan));
    }
    screen_put(screen, (int)(frame.x / 2), (int)(frame.y / 4), LIDAR_CHARACTER, COLOUR_PLAIN);
}

/* ---------------------------------------------------------------------------------------- words */

static void say(screen_t *screen, int *row, const char *name, const char *value, uint8_t colour)
{
    const int column = (int)screen->columns - PANEL_COLUMNS + 1;
    screen_text(screen, column, *row, name, COLOUR_DIM);
    screen_text(screen, column + 10, *row, value, colour);
    (*row)++;
}

static void say_number(screen_t *screen, int *row, const char *name, uint64_t number)
{
    char text[24];
    (void)snprintf(text, sizeof text, "%" PRIu64, number);
    say(screen, row, name, text, COLOUR_PLAIN);
}

static void say_error(screen_t *screen, int *row, const char *name, uint64_t number)
{
    char text[24];
    (void)snprintf(text, sizeof text, "%" PRIu64, number);
    say(screen, row, name, text, number > 0 ? COLOUR_ALARM : COLOUR_PLAIN);
}

static void say_nearest(screen_t *screen, int *row, const tmini_scan_t *scan)
{
    const tmini_point_t *const nearest = scan_nearest(scan);
    if (nearest == NULL) {
        say(screen, row, "nearest", "nothing", COLOUR_AMBER);
        *row += 2;
        return;
    }
    char text[24];
    (void)snprintf(text, sizeof text, "%d.%03d m", nearest->distance_mm / 1000,
                   nearest->distance_mm % 1000);
    say(screen, row, "nearest", text, COLOUR_AMBER);
    (void)snprintf(text, sizeof text, "at %d deg,", nearest->angle_q6 / 64);
    say(screen, row, "", text, COLOUR_AMBER);
    const char *const name = direction_name(nearest->angle_q6);
    screen_text(screen, (int)screen->columns - (int)strlen(name) - 1, (*row)++, name, COLOUR_AMBER);
}

/* The nearest obstacle of each of eight sectors, where the sector is. */
static void say_sectors(screen_t *screen, int *row, const tmini_scan_t *scan)
{
    static const struct {
        int column, row;
    } places[8] = {{9, 0}, {17, 1}, {20, 2}, {17, 3}, {9, 4}, {1, 3}, {-2, 2}, {1, 1}};
    uint16_t nearest_mm[8];
    tmini_sectors_t sectors;
    (void)tmini_sectors_init(&sectors, nearest_mm, 8, 0, TMINI_FILTER_NONE);
    tmini_sectors_add_scan(&sectors, scan);
    const int column = (int)screen->columns - PANEL_COLUMNS + 3;
    for (size_t i = 0; i < 8; i++) {
        char text[16] = "-";
        if (nearest_mm[i] > 0) {
            (void)snprintf(text, sizeof text, "%d.%02d", nearest_mm[i] / 1000,
                           nearest_mm[i] % 1000 / 10);
        }
        screen_text(screen, column + places[i].column, *row + places[i].row, text, COLOUR_PLAIN);
    }
    screen_put(screen, column + 10, *row + 2, LIDAR_CHARACTER, COLOUR_DIM);
    *row += 5;
}

static void draw_panel(screen_t *screen, const view_t *view)
{
    char text[24];
    int row = 2;
    if (view->scan != NULL) {
        say_nearest(screen, &row, view->scan);
        row++;
        say_sectors(screen, &row, view->scan);
        row++;
        (void)snprintf(text, sizeof text, "%d, %zu valid", view->scan->count,
                       scan_valid_points(view->scan));
        say(screen, &row, "points", text, COLOUR_PLAIN);
    }
    (void)snprintf(text, sizeof text, "%g m%s", view->range_mm / 1000.0,
                   view->zoom_mm > 0 ? "" : ", auto");
    say(screen, &row, "range", text, COLOUR_PLAIN);
    say_number(screen, &row, "packets", view->packets);
    say_error(screen, &row, "checksums", view->checksum_errors);
    say_error(screen, &row, "lost", view->bytes_lost);
    if (view->health != NULL) {
        say(screen, &row, "health", view->is_faulty ? "FAULTY" : "healthy",
            view->is_faulty ? COLOUR_ALARM : COLOUR_PLAIN);
    }
}

static void draw_lines(screen_t *screen, const view_t *view)
{
    char text[64];
    const int last = (int)screen->rows - 1;
    screen_text(screen, 1, 0, view->source, COLOUR_PLAIN);
    if (view->scan != NULL) {
        (void)snprintf(text, sizeof text, "scan %" PRIu64 "  %d.%d Hz", view->scans,
                       view->scan->frequency_chz / 100, view->scan->frequency_chz / 10 % 10);
        screen_text(screen, (int)screen->columns - (int)strlen(text) - 1, 0, text, COLOUR_PLAIN);
    }
    screen_text(screen, 1, last, "q quit   + - zoom   a auto", COLOUR_DIM);
    const char *const state = view->is_faulty ? view->health : view->state;
    screen_text(screen, (int)screen->columns - (int)strlen(state) - 1, last, state,
                view->is_faulty ? COLOUR_ALARM : COLOUR_DIM);
}

void view_draw(view_t *view, screen_t *screen)
{
    choose_range(view);
    if (view->range_mm == 0) {
        view->range_mm = zooms[3].range_mm;
    }
    screen_clear(screen);
    draw_picture(screen, view);
    if (screen->columns >= PANEL_COLUMNS + PICTURE_COLUMNS_MIN) {
        draw_panel(screen, view);
    }
    draw_lines(screen, view);
}
