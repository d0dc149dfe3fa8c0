/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* This is no safety function: where people can be hurt, use a certified scanner or a bumper.
 *
 * Obstacle stop: decides from scans whether the robot may move. Pure functions with integers only,
 * the same on a PC and in firmware. The robot may move while a field before it is free: seen by
 * complete scans, the newest of which is young, and nothing in it (tmini_fields.h). */

#ifndef OBSTACLE_H
#define OBSTACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini/tmini_fields.h"
#include "tmini/tmini_sectors.h"

#define OBSTACLE_SECTORS 8u

#define OBSTACLE_STOP_MM 300
#define OBSTACLE_GO_MM 350    /* More than OBSTACLE_STOP_MM, to avoid stop and go. */
#define OBSTACLE_ASIDE_MM 150 /* Half of the robot's width, and some room. */
#define OBSTACLE_BLIND_MS 300 /* Three turns at 10 Hz. */

typedef struct {
    tmini_sector_t sectors[OBSTACLE_SECTORS]; /* To show; clockwise, the first one ahead. */
    tmini_field_t fields[2]; /* Where something stops it; what must be free to go on. */
    bool moves;              /* As decided last. */
} obstacle_t;

/* Takes a scan. */
void obstacle_see(obstacle_t *obstacle, const tmini_scan_t *scan);

/* The lidar sees nothing for now: it is faulty or lost. */
void obstacle_blind(obstacle_t *obstacle);

/* `now_ms` is the clock of the driver's port, read after the last tmini_poll(). */
bool obstacle_may_move(obstacle_t *obstacle, uint32_t now_ms);

#endif
