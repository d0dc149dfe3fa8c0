/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What happens to an obstacle stop of examples/ with the simulated lidar in its room: an obstacle
 * comes and goes, power fails and returns. The program names the lidar on its console, and stops
 * the robot only while it must. */

#ifndef STORY_H
#define STORY_H

#include <stdbool.h>
#include <stdint.h>

#include "simulator.h"

typedef struct {
    sim_t *lidar;
    uint64_t (*now_us)(void);
    void (*assert_stops)(bool stops); /* Whether the program stops the robot now. */
} story_board_t;

void story_begin(const story_board_t *board);

/* To be called again and again: what is due happens. False once all has happened. */
bool story_goes_on(void);

#endif
