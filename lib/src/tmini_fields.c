/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_fields.h"

#define ROUND_Q6 ((int32_t)TMINI_FULL_CIRCLE_Q6)
#define HALF_ROUND_Q6 (ROUND_Q6 / 2)
#define STRAIGHT_Q6 2 /* Directions are exact to 1/64 degree. */

/* --------------------------------------------------------------------------------- directions */

/* A corner as the lidar sees it. At most 32766 mm away in x and y, so that no product below is
 * above 2^30. */
typedef struct {
    int32_t x;
    int32_t y;
} place_t;

static place_t corner_at(const tmini_field_t *field, size_t index, tmini_xy_t lidar)
{
    const tmini_xy_t corner = field->corners[index];
    return (place_t){(int32_t)corner.x_mm - lidar.x_mm, (int32_t)corner.y_mm - lidar.y_mm};
}

/* A box has four corners, two of which are given. */
static place_t corner_of(const tmini_field_t *field, size_t index, tmini_xy_t lidar)
{
    if (field->corner_count > 2) {
        return corner_at(field, index, lidar);
    }
    const place_t one = corner_at(field, 0, lidar);
    const place_t other = corner_at(field, 1, lidar);
    return (place_t){index == 0 || index == 3 ? one.x : other.x, index < 2 ? one.y : other.y};
}

static size_t count_corners(const tmini_field_t *field)
{
    return field->corner_count > 2 ? field->corner_count : 4;
}

static bool is_origin(place_t place)
{
    return place.x == 0 && place.y == 0;
}

/* Halves the half circle that contains the place until 1/64 degree is left. */
static int32_t direction_of(place_t place)
{
    const bool is_left = place.y > 0 || (place.y == 0 && place.x < 0);
    int32_t from = is_left ? HALF_ROUND_Q6 : 0;
    int32_t wide = HALF_ROUND_Q6;
    while (wide > 1) {
        const int32_t middle = from + wide / 2;
        const tmini_xy_t ray = tmini_cartesian((uint16_t)middle, TMINI_FIELD_CORNER_MAX_MM);
        if (ray.x_mm * place.y <= ray.y_mm * place.x) { /* The place is clockwise of the ray. */
            wide -= wide / 2;
            from = middle;
        } else {
            wide /= 2;
        }
    }
    return from;
}

static int32_t larger(int32_t one, int32_t other)
{
    return one > other ? one : other;
}

/* The turn from one corner to the next, to the right positive. If the lidar is between them, it is
 * half a turn to either side: `straight` to that side. */
static int32_t turn(place_t from, place_t to, int32_t straight)
{
    int32_t angle = direction_of(to) - direction_of(from);
    angle += angle <= -HALF_ROUND_Q6 ? ROUND_Q6 : angle > HALF_ROUND_Q6 ? -ROUND_Q6 : 0;
    return larger(angle, -angle) >= HALF_ROUND_Q6 - STRAIGHT_Q6 ? straight : angle;
}

/* Walks around the field and sees how far the view turns to both sides. If the lidar is in the
 * field, that is a circle. A corner at the lidar itself has no direction. */
static void find_directions(tmini_field_t *field, tmini_xy_t lidar, int32_t straight)
{
    const size_t count = count_corners(field);
    const place_t zero = corner_of(field, 0, lidar);
    const place_t first = is_origin(zero) ? corner_of(field, 1, lidar) : zero;
    place_t corner = first;
    int32_t turned = 0;
    int32_t least = 0;
    int32_t most = 0;
    for (size_t i = 1; i <= count; i++) {
        const place_t next = i < count ? corner_of(field, i, lidar) : first;
        if (!is_origin(next)) {
            turned += turn(corner, next, straight);
            corner = next;
        }
        least = turned < least ? turned : least;
        most = turned > most ? turned : most;
    }
    const int32_t from = direction_of(first) + least;
    field->from_q6 = (uint16_t)(from < 0 ? from + ROUND_Q6 : from);
    field->wide_q6 = (uint16_t)(most - least < ROUND_Q6 ? most - least : ROUND_Q6);
}

/* At least the distance of the farthest place in the box around the field: sqrt(a * a + b * b) <=
 * a + b / 2 for a >= b. A place may be rounded into the field. */
static void find_reach(tmini_field_t *field, tmini_xy_t lidar)
{
    const int32_t ahead = larger(field->most.x_mm - lidar.x_mm, lidar.x_mm - field->least.x_mm);
    const int32_t aside = larger(field->most.y_mm - lidar.y_mm, lidar.y_mm - field->least.y_mm);
    const int32_t sum = ahead + aside + larger(ahead, aside);
    field->reach_mm = (uint16_t)(sum / 2 + 2);
}

static bool is_ahead(const tmini_field_t *field, uint16_t angle_q6)
{
    return tmini_clockwise(field->from_q6, angle_q6) <= field->wide_q6;
}

/* -------------------------------------------------------------------------------------- set up */

static bool is_near(tmini_xy_t place)
{
    return larger(place.x_mm, -place.x_mm) <= TMINI_FIELD_CORNER_MAX_MM &&
           larger(place.y_mm, -place.y_mm) <= TMINI_FIELD_CORNER_MAX_MM;
}

/* Finds the box around the field. False if a corner is too far away, or nothing is in it. */
static bool enclose(tmini_field_t *field)
{
    field->least = field->corners[0];
    field->most = field->corners[0];
    for (size_t i = 0; i < field->corner_count; i++) {
        const tmini_xy_t corner = field->corners[i];
        if (!is_near(corner)) {
            return false;
        }
        field->least.x_mm = corner.x_mm < field->least.x_mm ? corner.x_mm : field->least.x_mm;
        field->least.y_mm = corner.y_mm < field->least.y_mm ? corner.y_mm : field->least.y_mm;
        field->most.x_mm = corner.x_mm > field->most.x_mm ? corner.x_mm : field->most.x_mm;
        field->most.y_mm = corner.y_mm > field->most.y_mm ? corner.y_mm : field->most.y_mm;
    }
    return field->least.x_mm < field->most.x_mm && field->least.y_mm < field->most.y_mm;
}

/* False if all corners of a polygon are on one line. */
static bool has_inside(const tmini_field_t *field)
{
    const place_t first = corner_at(field, 1, field->corners[0]);
    for (size_t i = 2; i < field->corner_count; i++) {
        const place_t corner = corner_at(field, i, field->corners[0]);
        if (corner.x * first.y != corner.y * first.x) {
            return true;
        }
    }
    return field->corner_count == 2;
}

static void set_defaults(tmini_field_t *field)
{
    field->points = field->points != 0 ? field->points : TMINI_FIELD_POINTS;
    field->scans = field->scans != 0 ? field->scans : TMINI_FIELD_SCANS;
    field->unseen_percent =
        field->unseen_percent != 0 ? field->unseen_percent : TMINI_FIELD_UNSEEN_PERCENT;
    field->max_age_ms = field->max_age_ms != 0 ? field->max_age_ms : TMINI_FIELD_MAX_AGE_MS;
}

static void make_blind(tmini_field_t *field)
{
    field->state = TMINI_FIELD_BLIND;
    field->free_scans = 0;
}

static bool set_up(tmini_field_t *field, tmini_xy_t lidar)
{
    make_blind(field);
    field->is_set_up = false;
    if (field->corners == NULL || field->corner_count < 2 || field->unseen_percent > 100 ||
        !is_near(lidar) || !enclose(field) || !has_inside(field)) {
        return false;
    }
    set_defaults(field);
    find_reach(field, lidar);
    find_directions(field, lidar, HALF_ROUND_Q6);
    if (field->wide_q6 == ROUND_Q6) { /* Or the lidar is on its edge. */
        find_directions(field, lidar, -HALF_ROUND_Q6);
    }
    field->is_set_up = true;
    return true;
}

tmini_status_t tmini_fields_init(const tmini_fields_t *fields)
{
    bool is_good = fields != NULL && fields->list != NULL && fields->count > 0;
    if (!is_good) {
        return TMINI_ERROR_ARGUMENT;
    }
    for (size_t i = 0; i < fields->count; i++) {
        is_good = set_up(&fields->list[i], fields->lidar) && is_good;
    }
    return is_good ? TMINI_OK : TMINI_ERROR_ARGUMENT;
}

/* -------------------------------------------------------------------------------------- points */

static bool is_in_box(const tmini_field_t *field, place_t place)
{
    return place.x >= field->least.x_mm && place.x <= field->most.x_mm &&
           place.y >= field->least.y_mm && place.y <= field->most.y_mm;
}

/* True if the edge crosses the line that leads from the place to ahead. */
static bool crosses(tmini_xy_t from, tmini_xy_t to, place_t place)
{
    if ((from.y_mm > place.y) == (to.y_mm > place.y)) {
        return false;
    }
    const int32_t along = (place.x - from.x_mm) * ((int32_t)to.y_mm - from.y_mm);
    const int32_t aside = ((int32_t)to.x_mm - from.x_mm) * (place.y - from.y_mm);
    return to.y_mm > from.y_mm ? along < aside : along > aside;
}

/* A place in the box around the field. It is inside if an odd number of edges is ahead of it. */
static bool is_in_polygon(const tmini_field_t *field, place_t place)
{
    bool is_odd = false;
    tmini_xy_t from = field->corners[field->corner_count - 1u];
    for (size_t i = 0; i < field->corner_count; i++) {
        const tmini_xy_t to = field->corners[i];
        is_odd = is_odd != crosses(from, to, place);
        from = to;
    }
    return is_odd;
}

/* A count that went back to 0 would make a field free. */
static void count_up(uint16_t *count)
{
    *count = (uint16_t)(*count + (*count < UINT16_MAX ? 1 : 0));
}

void tmini_fields_begin(const tmini_fields_t *fields)
{
    for (size_t i = 0; i < fields->count; i++) {
        fields->list[i].inside = 0;
        fields->list[i].directions = 0;
        fields->list[i].unseen = 0;
    }
}

/* A point that has a range. Most are beyond the field, so the place is looked for last. */
static bool is_inside(const tmini_field_t *field, const tmini_point_t *point, tmini_xy_t lidar)
{
    if (point->distance_mm > field->reach_mm) {
        return false;
    }
    const tmini_xy_t seen = tmini_cartesian_point(point);
    const place_t place = {(int32_t)seen.x_mm + lidar.x_mm, (int32_t)seen.y_mm + lidar.y_mm};
    return is_in_box(field, place) && (field->corner_count == 2 || is_in_polygon(field, place));
}

void tmini_fields_add(const tmini_fields_t *fields, const tmini_point_t *point)
{
    const bool has_range = point->distance_mm != 0;
    for (size_t i = 0; i < fields->count; i++) {
        tmini_field_t *const field = &fields->list[i];
        if (is_ahead(field, point->angle_q6)) {
            count_up(&field->directions);
            if (!has_range) {
                count_up(&field->unseen);
            }
        }
        if (has_range && is_inside(field, point, fields->lidar)) {
            count_up(&field->inside);
        }
    }
}

/* --------------------------------------------------------------------------------------- state */

static bool is_unseen(const tmini_field_t *field)
{
    return field->directions == 0 ||
           (uint32_t)100 * field->unseen > (uint32_t)field->unseen_percent * field->directions;
}

/* A complete scan without enough points in the field. */
static void see_nothing(tmini_field_t *field)
{
    if (is_unseen(field)) {
        make_blind(field);
    } else if (++field->free_scans >= field->scans) { /* From then on their number is of no use. */
        field->state = TMINI_FIELD_FREE;
    }
}

static void judge_field(tmini_field_t *field, bool complete)
{
    if (field->inside >= field->points) {
        field->state = TMINI_FIELD_OCCUPIED;
        field->free_scans = 0;
    } else if (complete) {
        see_nothing(field);
    }
}

void tmini_fields_end(const tmini_fields_t *fields, bool complete, uint32_t end_ms)
{
    for (size_t i = 0; i < fields->count; i++) {
        tmini_field_t *const field = &fields->list[i];
        if (field->is_set_up) {
            (void)tmini_field_state(field, end_ms); /* It may have aged. */
            field->seen_ms = complete ? end_ms : field->seen_ms;
            judge_field(field, complete);
        }
    }
}

void tmini_fields_add_scan(const tmini_fields_t *fields, const tmini_scan_t *scan)
{
    tmini_fields_begin(fields);
    for (size_t i = 0; i < scan->count; i++) {
        tmini_fields_add(fields, &scan->points[i]);
    }
    tmini_fields_end(fields, scan->complete, scan->end_ms);
}

void tmini_fields_step(const void *fields, tmini_scan_t *scan)
{
    if (fields != NULL) {
        tmini_fields_add_scan(fields, scan);
    }
}

void tmini_fields_clear(const tmini_fields_t *fields)
{
    for (size_t i = 0; i < fields->count; i++) {
        make_blind(&fields->list[i]);
    }
}

tmini_field_state_t tmini_field_state(tmini_field_t *field, uint32_t now_ms)
{
    if (now_ms - field->seen_ms > field->max_age_ms) {
        make_blind(field);
    }
    return (tmini_field_state_t)field->state;
}
