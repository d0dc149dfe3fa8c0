/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "calibrate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define RADIANS (PI / 180.0)

/* A wall must be seen this well. */
#define WALL_LONG_MM 600.0
#define WALL_ROUGH_MM 15.0
#define WALL_NEAR_MM 150.0
#define WALL_FAR_MM 5000.0
#define WALL_POINTS 20u /* In each scan. */
#define WALLS 6u

void calibrate_begin(sample_t *sample)
{
    sample->count = 0;
    sample->scans = 0;
}

void calibrate_add(sample_t *sample, const tmini_scan_t *scan)
{
    for (size_t i = 0; i < scan->count && sample->count < CALIBRATE_POINTS; i++) {
        const tmini_point_t *const point = &scan->points[i];
        if (point->distance_mm != 0) {
            const double angle = point->angle_q6 / 64.0 * RADIANS;
            sample->points[sample->count].x = point->distance_mm * cos(angle);
            sample->points[sample->count].y = point->distance_mm * sin(angle);
            sample->points[sample->count].scan = sample->scans;
            sample->count++;
        }
    }
    sample->scans++;
}

void calibrate_shift(sample_t *sample, double offset_mm)
{
    for (size_t i = 0; i < sample->count; i++) {
        const double range_mm = hypot(sample->points[i].x, sample->points[i].y);
        sample->points[i].x *= (range_mm + offset_mm) / range_mm;
        sample->points[i].y *= (range_mm + offset_mm) / range_mm;
    }
}

/* ----------------------------------------------------------------------------------- the walls */

/* A straight piece: the direction and distance of the foot of the perpendicular, and from where to
 * where it goes, seen from that foot. */
typedef struct {
    double angle; /* In radians, clockwise. */
    double away_mm;
    double from_mm;
    double to_mm;
} line_t;

#define EVERYWHERE (-1e6), 1e6

#define ANGLES 720u
#define AWAY_STEPS 250u
#define AWAY_STEP_MM 20.0

/* The line on which most points lie, among those that are not used up. */
static line_t strongest(const sample_t *sample, const bool *used)
{
    static unsigned votes[ANGLES][AWAY_STEPS];
    unsigned best = 0;
    line_t line = {0, 0, EVERYWHERE};
    memset(votes, 0, sizeof votes);
    for (unsigned a = 0; a < ANGLES; a++) {
        const double cosine = cos(a * 2 * PI / ANGLES);
        const double sine = sin(a * 2 * PI / ANGLES);
        for (size_t i = 0; i < sample->count; i += 3) { /* A third of them is enough. */
            const double away = sample->points[i].x * cosine + sample->points[i].y * sine;
            const unsigned step = away > 0 ? (unsigned)(away / AWAY_STEP_MM) : AWAY_STEPS;
            if (!used[i] && step < AWAY_STEPS && ++votes[a][step] > best) {
                best = votes[a][step];
                line = (line_t){a * 2 * PI / ANGLES, (step + 0.5) * AWAY_STEP_MM, EVERYWHERE};
            }
        }
    }
    return line;
}

static double off_line(const sample_t *sample, size_t index, line_t line)
{
    return sample->points[index].x * cos(line.angle) + sample->points[index].y * sin(line.angle) -
           line.away_mm;
}

static double along_line(const sample_t *sample, size_t index, line_t line)
{
    return sample->points[index].y * cos(line.angle) - sample->points[index].x * sin(line.angle);
}

static bool is_on(const sample_t *sample, size_t index, line_t line, double within_mm)
{
    const double along = along_line(sample, index, line);
    return fabs(off_line(sample, index, line)) < within_mm && along >= line.from_mm &&
           along <= line.to_mm;
}

/* Which scans, and which points are used up (NULL: none). */
typedef struct {
    unsigned from;
    unsigned to;
    const bool *used;
} part_t;

static bool is_in_part(const sample_t *sample, size_t index, part_t part)
{
    return sample->points[index].scan >= part.from && sample->points[index].scan < part.to &&
           (part.used == NULL || !part.used[index]);
}

/* Fits the line to the points that are on it, by the least squares of their distances from it.
 * Returns how many there were. */
static size_t fit(const sample_t *sample, part_t part, double within_mm, line_t *line)
{
    double n = 0;
    double x = 0;
    double y = 0;
    double xx_yy = 0;
    double xy = 0;
    for (size_t i = 0; i < sample->count; i++) {
        if (is_in_part(sample, i, part) && is_on(sample, i, *line, within_mm)) {
            const double px = sample->points[i].x;
            const double py = sample->points[i].y;
            n += 1;
            x += px;
            y += py;
            xx_yy += px * px - py * py;
            xy += px * py;
        }
    }
    if (n < 2) {
        return 0;
    }
    line->angle = 0.5 * atan2(2 * (xy - x * y / n), xx_yy - (x * x - y * y) / n) + PI / 2;
    if (x * cos(line->angle) + y * sin(line->angle) < 0) {
        line->angle += PI;
    }
    line->away_mm = (x * cos(line->angle) + y * sin(line->angle)) / n;
    return (size_t)n;
}

#define PIECES 1000u
#define PIECE_MM 20.0
#define GAP_PIECES 15u

/* Cuts the line to its longest piece without a gap of more than 300 mm. */
static void cut(const sample_t *sample, const bool *used, double within_mm, line_t *line)
{
    static bool is_taken[PIECES];
    unsigned from = 0;
    unsigned last = 0;
    unsigned longest = 0;
    memset(is_taken, 0, sizeof is_taken);
    line->from_mm = -PIECE_MM * (PIECES / 2.0 - 1);
    line->to_mm = -line->from_mm;
    for (size_t i = 0; i < sample->count; i++) {
        if (!used[i] && is_on(sample, i, *line, within_mm)) {
            is_taken[(unsigned)(along_line(sample, i, *line) / PIECE_MM + PIECES / 2.0)] = true;
        }
    }
    for (unsigned i = 0; i < PIECES; i++) {
        if (is_taken[i]) {
            from = i - last > GAP_PIECES ? i : from;
            last = i;
            if (i + 1 - from > longest) {
                longest = i + 1 - from;
                line->from_mm = (from - PIECES / 2.0) * PIECE_MM;
                line->to_mm = (i + 1 - PIECES / 2.0) * PIECE_MM;
            }
        }
    }
}

/* Measures how rough the wall is, and uses its points up. */
static void measure_and_use(const sample_t *sample, bool *used, line_t line, wall_t *wall)
{
    double squares = 0;
    size_t count = 0;
    for (size_t i = 0; i < sample->count; i++) {
        if (!used[i] && is_on(sample, i, line, 60)) {
            const double off = off_line(sample, i, line);
            used[i] = true;
            squares += off * off;
            count++;
        }
    }
    wall->degrees = fmod(line.angle / RADIANS + 720, 360);
    wall->away_mm = line.away_mm;
    wall->long_mm = line.to_mm - line.from_mm;
    wall->rough_mm = count > 0 ? sqrt(squares / (double)count) : 0;
}

static double apart_deg(double one, double other)
{
    return fabs(remainder(one - other, 360));
}

/* The walls of the room. Returns how many. */
static size_t find_walls(const sample_t *sample, wall_t walls[WALLS], line_t lines[WALLS])
{
    static bool used[CALIBRATE_POINTS];
    size_t count = 0;
    memset(used, 0, sizeof used);
    for (unsigned i = 0; i < 3 * WALLS && count < WALLS; i++) {
        line_t line = strongest(sample, used);
        size_t points = 0;
        for (unsigned again = 0; again < 5; again++) {
            const double within_mm = again < 2 ? 60 : 30;
            cut(sample, used, within_mm, &line);
            points = fit(sample, (part_t){0, sample->scans, used}, within_mm, &line);
        }
        if (points == 0 || points < WALL_POINTS * sample->scans) {
            break;
        }
        lines[count] = line;
        measure_and_use(sample, used, line, &walls[count]);
        count += walls[count].long_mm >= WALL_LONG_MM ? 1 : 0;
    }
    return count;
}

/* Between the first half of the scans and the second. */
static bool has_moved(const sample_t *sample, line_t line)
{
    line_t early = line;
    line_t late = line;
    (void)fit(sample, (part_t){0, sample->scans / 2, NULL}, 60, &early);
    (void)fit(sample, (part_t){sample->scans / 2, sample->scans, NULL}, 60, &late);
    return apart_deg(early.angle / RADIANS, late.angle / RADIANS) > 0.3 ||
           fabs(early.away_mm - late.away_mm) > 10;
}

#define AHEAD_DEG 3.0
#define AHEAD_POINTS 3u /* In each scan. */

/* True if the wall is there where the robot's front would meet it: two faces with another thing
 * between them look like one wall. */
static bool is_ahead(const sample_t *sample, line_t line)
{
    const double aside_mm = line.away_mm * tan(AHEAD_DEG * RADIANS);
    size_t count = 0;
    for (size_t i = 0; i < sample->count; i++) {
        count += is_on(sample, i, line, 60) && fabs(along_line(sample, i, line)) < aside_mm ? 1 : 0;
    }
    return count >= AHEAD_POINTS * sample->scans;
}

static const char *judge(const wall_t *wall)
{
    static char reason[160];
    if (wall->away_mm < WALL_NEAR_MM || wall->away_mm > WALL_FAR_MM) {
        (void)snprintf(reason, sizeof reason, "the wall is %.0f mm away; it must be 150 to 5000",
                       wall->away_mm);
        return reason;
    }
    if (wall->rough_mm > WALL_ROUGH_MM) {
        (void)snprintf(reason, sizeof reason,
                       "the wall is not straight: its points are %.0f mm off it on average",
                       wall->rough_mm);
        return reason;
    }
    return NULL;
}

const char *calibrate_wall(sample_t *sample, bool is_rough, double rough_deg, wall_t *wall)
{
    static char reason[160];
    wall_t walls[WALLS];
    line_t lines[WALLS];
    const size_t count = find_walls(sample, walls, lines);
    const wall_t *nearest = NULL;
    const wall_t *rival = NULL;
    for (size_t i = 0; i < count; i++) {
        const bool is_meant = !is_rough || apart_deg(walls[i].degrees, rough_deg) <= 30;
        if (is_meant && (nearest == NULL || walls[i].away_mm < nearest->away_mm)) {
            nearest = &walls[i];
        }
    }
    if (nearest == NULL) {
        return is_rough ? "there is no straight wall of 0.6 m within 30 degrees of --front"
                        : "there is no straight wall of 0.6 m";
    }
    for (size_t i = 0; i < count; i++) { /* Pieces of one wall look the same way. */
        const bool is_meant = !is_rough || apart_deg(walls[i].degrees, rough_deg) <= 30;
        if (is_meant && apart_deg(walls[i].degrees, nearest->degrees) > 5 &&
            walls[i].away_mm < 1.2 * nearest->away_mm) {
            rival = &walls[i];
        }
    }
    if (rival != NULL) {
        (void)snprintf(reason, sizeof reason,
                       "two walls are about equally near, at %.0f and %.0f degrees: move closer to "
                       "one, or give --front roughly",
                       nearest->degrees, rival->degrees);
        return reason;
    }
    if (has_moved(sample, lines[nearest - walls])) {
        return "the robot or the wall has moved";
    }
    if (!is_ahead(sample, lines[nearest - walls])) {
        (void)snprintf(reason, sizeof reason,
                       "straight towards the nearest wall, at %.0f degrees, is another thing: give "
                       "--front roughly",
                       nearest->degrees);
        return reason;
    }
    *wall = *nearest;
    return judge(nearest);
}

/* ---------------------------------------------------------------------------------- the offset */

const char *calibrate_offset(const sample_t *sample, double front_deg, double true_mm,
                             double *offset_mm)
{
    static char reason[160];
    const double cosine = cos(front_deg * RADIANS);
    const double sine = sin(front_deg * RADIANS);
    double n = 0;
    double sum = 0;
    double squares = 0;
    for (size_t i = 0; i < sample->count; i++) {
        const double ahead = sample->points[i].x * cosine + sample->points[i].y * sine;
        const double aside = sample->points[i].y * cosine - sample->points[i].x * sine;
        if (fabs(atan2(aside, ahead)) < AHEAD_DEG * RADIANS) {
            n += 1;
            sum += ahead;
            squares += ahead * ahead;
        }
    }
    if (n < (double)(AHEAD_POINTS * sample->scans)) {
        return "there are not enough ranges straight ahead";
    }
    const double rough_mm = sqrt(fmax(0, squares / n - (sum / n) * (sum / n)));
    if (rough_mm > WALL_ROUGH_MM) {
        (void)snprintf(reason, sizeof reason,
                       "what is ahead is not flat and square to the robot, or has moved: %.0f mm "
                       "rough",
                       rough_mm);
        return reason;
    }
    if (fabs(true_mm - sum / n) > 200) {
        (void)snprintf(reason, sizeof reason,
                       "the lidar measures %.0f mm straight ahead: that is another thing", sum / n);
        return reason;
    }
    *offset_mm = true_mm - sum / n;
    return NULL;
}

/* ----------------------------------------------------------------------------------- the masks */

#define ROBOT_MM 1000u /* Its parts are nearer. */
#define WIDER_DEG 2
#define TURNS_MIN 30u

void calibrate_begin_turning(turning_t *turning)
{
    turning->scans = 0;
}

void calibrate_add_turning(turning_t *turning, const tmini_mount_t *mount, const tmini_scan_t *scan)
{
    if (turning->scans == CALIBRATE_TURNS) {
        return;
    }
    uint16_t *const row = turning->nearest_mm[turning->scans++];
    for (unsigned i = 0; i < 360; i++) {
        row[i] = UINT16_MAX;
    }
    for (size_t i = 0; i < scan->count; i++) {
        const uint16_t angle_q6 = tmini_mount_angle(mount, scan->points[i].angle_q6);
        uint16_t *const cell = &row[(angle_q6 + 32u) / 64u % 360u];
        const uint16_t mm = scan->points[i].distance_mm;
        *cell = *cell == UINT16_MAX || *cell == 0 || (mm != 0 && mm < *cell) ? mm : *cell;
    }
}

static int compare(const void *one, const void *other)
{
    return (int)*(const uint16_t *)one - (int)*(const uint16_t *)other;
}

/* The middle one of the ranges in a direction, and how many of a hundred are near it. */
static unsigned steadiness(const turning_t *turning, unsigned degree, uint16_t *middle_mm)
{
    uint16_t sorted[CALIBRATE_TURNS];
    unsigned count = 0;
    unsigned near = 0;
    for (unsigned i = 0; i < turning->scans; i++) {
        if (turning->nearest_mm[i][degree] != UINT16_MAX) {
            sorted[count++] = turning->nearest_mm[i][degree];
        }
    }
    *middle_mm = 0;
    if (count == 0) {
        return 0;
    }
    qsort(sorted, count, sizeof sorted[0], compare);
    *middle_mm = sorted[count / 2];
    for (unsigned i = 0; i < count; i++) {
        near += abs((int)sorted[i] - (int)*middle_mm) <= 20 + *middle_mm / 30;
    }
    return 100 * near / count;
}

/* Which directions are the robot's, and how many of the others show something that has moved. */
static unsigned find_robot(const turning_t *turning, bool is_robot[360], unsigned *robots)
{
    unsigned moved = 0;
    *robots = 0;
    for (unsigned i = 0; i < 360; i++) {
        uint16_t middle_mm = 0;
        const unsigned steady = steadiness(turning, i, &middle_mm);
        is_robot[i] = steady >= 70 && middle_mm > 0 && middle_mm < ROBOT_MM;
        *robots += is_robot[i];
        moved += steady < 70;
    }
    return moved;
}

static bool is_begin(const bool is_robot[360], int degree)
{
    if (!is_robot[degree]) {
        return false;
    }
    for (int i = 1; i <= 2 * WIDER_DEG; i++) {
        if (is_robot[(degree + 360 - i) % 360]) {
            return false;
        }
    }
    return true;
}

/* Directions that are closer to each other than the arcs are made wider are one arc. */
static size_t make_arcs(const bool is_robot[360], tmini_arc_t arcs[CALIBRATE_ARCS])
{
    size_t count = 0;
    for (int i = 0; i < 360; i++) {
        if (!is_begin(is_robot, i)) {
            continue;
        }
        int last = i;
        for (int at = i; at - last <= 2 * WIDER_DEG; at++) {
            last = is_robot[at % 360] ? at : last;
        }
        if (count < CALIBRATE_ARCS) {
            arcs[count].from_deg = (int16_t)((i - WIDER_DEG + 360) % 360);
            arcs[count].to_deg = (int16_t)((last + WIDER_DEG) % 360);
        }
        count++;
    }
    return count;
}

const char *calibrate_masks(const turning_t *turning, tmini_arc_t arcs[CALIBRATE_ARCS],
                            size_t *count)
{
    bool is_robot[360];
    unsigned robots = 0;
    if (turning->scans < TURNS_MIN) {
        return "there were not enough scans: turn for longer (--seconds)";
    }
    const unsigned moved = find_robot(turning, is_robot, &robots);
    if (robots > 180) {
        return moved < 90 ? "nothing has moved: the robot was not turned"
                          : "more than half of what the lidar sees turns with the robot";
    }
    if (moved < (360 - robots) / 2) {
        return "too little has moved: the robot was not turned, or not far enough";
    }
    *count = make_arcs(is_robot, arcs);
    return *count > CALIBRATE_ARCS ? "too many parts turn with the robot: more than 8" : NULL;
}
