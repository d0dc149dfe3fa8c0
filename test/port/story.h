/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A story for the obstacle stops in examples/: an obstacle comes and goes, and the lidar's power
 * fails and returns. The program must print the lidar's model, and stop the robot only while
 * needed. */

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
