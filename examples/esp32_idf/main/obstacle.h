/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop: decides from scans whether the robot may move. Pure functions with integers only,
 * the same on a PC and in firmware.
 *
 * The robot may move if a recent complete scan has seen something in front and nothing near. A scan
 * with gaps may have missed an obstacle: it can stop the robot, but not release it. A scan without
 * any distance means that the lidar sees nothing, not that the way is free. */

#ifndef OBSTACLE_H
#define OBSTACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "tmini/tmini_sectors.h"

#define OBSTACLE_SECTORS 8u

#define OBSTACLE_STOP_MM 300u
#define OBSTACLE_GO_MM 350u /* More than OBSTACLE_STOP_MM, to avoid stop and go. */
#define OBSTACLE_BLIND_MS 500u

typedef struct {
    tmini_sector_t sectors[OBSTACLE_SECTORS]; /* Clockwise, the first one ahead. */
    uint32_t seen_ms;                         /* When the last complete scan ended. */
    bool clear;                               /* Nothing near in front, as of the last scans. */
    bool seeing;                              /* A complete scan has come. */
} obstacle_t;

/* Takes a scan. */
void obstacle_see(obstacle_t *obstacle, const tmini_scan_t *scan);

/* The lidar sees nothing for now: it is faulty or lost. */
void obstacle_blind(obstacle_t *obstacle);

/* `now_ms` is the clock of the driver's port, read after the last tmini_poll(). */
bool obstacle_may_move(const obstacle_t *obstacle, uint32_t now_ms);

#endif
