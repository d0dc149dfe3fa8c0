/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * This is no safety function: where people can be hurt, use a certified scanner or a bumper.
 *
 * Optional: fields around a robot, boxes or polygons in millimetres, each of which is free,
 * occupied or blind. Integers only. Places are the robot's: x ahead, y to the left, as in ROS.
 *
 *     static const tmini_xy_t stop_box[] = {{0, -250}, {600, 250}};   corners of a box
 *     static const tmini_xy_t slow_box[] = {{0, -250}, {1500, 250}};
 *     static tmini_field_t list[] = {
 *         {.corners = stop_box, .corner_count = 2, .unseen_percent = 10},      see "Blind"
 *         {.corners = slow_box, .corner_count = 2},
 *     };
 *     static const tmini_fields_t fields = {.list = list, .count = 2};
 *
 *     static const tmini_config_t config = {
 *         ..., .step = tmini_fields_step, .step_data = &fields,
 *     };
 *
 *     if (tmini_fields_init(&fields) != TMINI_OK) { halt(); }
 *     for (;;) {
 *         switch (tmini_poll(&lidar)) {
 *         ...
 *         }
 *         if (tmini_faults(&lidar) != 0) { tmini_fields_clear(&fields); }
 *         const uint32_t now = now_ms(NULL);               the clock of the driver's port
 *         if (tmini_field_state(&list[0], now) != TMINI_FIELD_FREE) { stop(); }
 *         else if (tmini_field_state(&list[1], now) != TMINI_FIELD_FREE) { drive_slowly(); }
 *         else { drive(); }
 *     }
 *
 * Occupied: at least `points` points lie in the field in one scan, complete or not.
 * Free: then `scans` complete scans in a row had fewer. An incomplete scan frees nothing.
 * Blind: before that; when no complete scan has come for `max_age_ms`; and after a complete scan in
 * which more than `unseen_percent` of the field's directions had no range. No range is not free:
 * the thing may be nearer than 5 cm, black, of glass, or farther away than 12 m. Masked directions
 * have no range.
 *
 * What stands before a field hides what is in it, so let fields begin at the robot. Such a field
 * spans half the circle: with an `unseen_percent` of 50 it may be free although 89 degrees straight
 * ahead have no range; 5 are 9 degrees. Fields must see the points before a filter does: leave the
 * configuration's `filter` 0, and see tmini_steps.h for the order of steps. A lidar that is turned
 * or upside down needs the mounting first (tmini_mount.h).
 *
 * How long it takes to see something, and how often noise stops the robot, for each `points` and
 * `scans`: docs/robotics.md, "Fields". All functions: one context, the one that polls; no waiting.
 * About 55 instructions per point and field on a Cortex-M4, and 100 more for a point that is no
 * farther than the field's corners. */

#ifndef TMINI_FIELDS_H
#define TMINI_FIELDS_H

#include "tmini_cartesian.h"
#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Corners are at most this far from the origin, in x and in y. */
#define TMINI_FIELD_CORNER_MAX_MM 16383
/** The default of points. */
#define TMINI_FIELD_POINTS 2u
/** The default of scans. */
#define TMINI_FIELD_SCANS 3u
/** The default of unseen_percent. */
#define TMINI_FIELD_UNSEEN_PERCENT 50u
/** The default of max_age_ms: three turns at 10 Hz. */
#define TMINI_FIELD_MAX_AGE_MS 300u

/** What a field is. */
typedef enum {
    TMINI_FIELD_BLIND,    /**< Unknown: not free. */
    TMINI_FIELD_FREE,     /**< Seen, and nothing in it. */
    TMINI_FIELD_OCCUPIED, /**< Something is in it. */
} tmini_field_state_t;

/** One field. The members up to max_age_ms are yours, and must not change after
 * tmini_fields_init(); `inside` may be read. */
typedef struct {
    const tmini_xy_t *corners; /**< Two opposite corners of a box, or those of a polygon in their
                                * order, either way round. Stays the caller's. */
    uint8_t corner_count;      /**< 2: a box; 3 to 255: a polygon. */
    uint8_t points;            /**< This many points make it occupied; 0: TMINI_FIELD_POINTS. */
    uint8_t scans;             /**< This many complete scans make it free; 0: TMINI_FIELD_SCANS. */
    uint8_t unseen_percent;    /**< If more of its directions have no range, it is blind; 0:
                                * TMINI_FIELD_UNSEEN_PERCENT; 100: whatever they have. */
    uint16_t max_age_ms;       /**< Without a complete scan for longer it is blind; 0:
                                * TMINI_FIELD_MAX_AGE_MS. At 6 Hz 500. */
    uint16_t inside;           /**< Points in it in the newest scan. */
    /** @cond private */
    uint16_t directions; /* Points of the newest scan in its directions, */
    uint16_t unseen;     /* and those of them without a range. */
    uint16_t from_q6;    /* Where its directions begin, clockwise. */
    uint16_t wide_q6;    /* How wide they are. */
    uint16_t reach_mm;   /* No place in it is farther from the lidar. */
    tmini_xy_t least;    /* The box around it. */
    tmini_xy_t most;
    uint32_t seen_ms;   /* When the newest complete scan ended. */
    uint8_t state;      /* A tmini_field_state_t. */
    uint8_t free_scans; /* Complete scans in a row that saw nothing in it. */
    bool is_set_up;
    /** @endcond */
} tmini_field_t;

/** A robot's fields, and where its lidar is. */
typedef struct {
    tmini_field_t *list; /**< The caller's array. */
    size_t count;        /**< How many fields it has. */
    tmini_xy_t lidar;    /**< The lidar's place; (0, 0): places count from the lidar. */
} tmini_fields_t;

/** Sets up the fields, all blind. Everything must outlive its use. The corners' directions are
 * searched here, so it takes some thousand instructions per corner.
 * Returns TMINI_OK, or TMINI_ERROR_ARGUMENT: null pointer, no field, fewer than two corners, a
 * corner or the lidar too far away, a field without an inside, more than 100 percent. Such fields
 * stay blind. */
tmini_status_t tmini_fields_init(const tmini_fields_t *fields);

/** The step for the configuration's `step`, with a tmini_fields_t as its `step_data`: the fields
 * see each scan. It changes no point. */
void tmini_fields_step(const void *fields, tmini_scan_t *scan);

/** Makes all fields blind: call it while the lidar reports a fault. */
void tmini_fields_clear(const tmini_fields_t *fields);

/** What the field is now. `now_ms`: the clock of the driver's port, read after the last
 * tmini_poll(). */
tmini_field_state_t tmini_field_state(tmini_field_t *field, uint32_t now_ms);

/** @name Without the step
 * For whole scans, and for points that come one by one: begin, add each point of a revolution,
 * end. */
/** @{ */

/** The fields see a scan, before or after it was delivered. */
void tmini_fields_add_scan(const tmini_fields_t *fields, const tmini_scan_t *scan);

/** Begins a scan. */
void tmini_fields_begin(const tmini_fields_t *fields);

/** Adds a point. */
void tmini_fields_add(const tmini_fields_t *fields, const tmini_point_t *point);

/** Ends the scan. `complete` and `end_ms`: those of the tmini_scan_t. */
void tmini_fields_end(const tmini_fields_t *fields, bool complete, uint32_t end_ms);

/** @} */

#ifdef __cplusplus
}
#endif

#endif
