/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A story for the obstacle stops in examples/, with the simulated lidar in its simulated room: an
 * obstacle comes and goes, and the lidar's power fails and returns. Checks that the program prints
 * the lidar's model, and stops the robot only while it must. */

#ifndef STORY_H
#define STORY_H

#include <stdbool.h>
#include <stdint.h>

#include "simulator.h"

typedef struct {
    sim_t *lidar;
    uint64_t (*now_us)(void);
    void (*assert_stops)(bool stops); /* Checks whether the program now stops the robot. */
} story_board_t;

void story_begin(const story_board_t *board);

/* Call this repeatedly: it does and checks what is due. Returns false at the end of the story. */
bool story_goes_on(void);

#endif
