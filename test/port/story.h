/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A story for the obstacle stops in examples/: an obstacle comes and goes, the lidar becomes faulty
 * and is repaired, and its power fails and returns. The program must print the lidar's model, and
 * stop the robot only while needed; printing must leave time.
 *
 * story.c holds the test. The test of each example defines the functions example_…(). */

#ifndef STORY_H
#define STORY_H

#include <stdbool.h>

void example_begin(void);              /* Resets the model. */
int example_play(void);                /* Runs the program; while that sleeps, story_go_on(). */
void example_assert_stops(bool stops); /* Whether the program now stops the robot. */

/* The program's main() with another name. */
int example_main(void);

/* Does and checks what is due; leaves the program at the end of the story. */
void story_go_on(void);

/* Leaves the program that story_run() has begun. */
void story_leave(void);
void story_run(int (*program)(void));

#endif
