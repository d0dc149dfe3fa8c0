/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A story for the obstacle stops in examples/: an obstacle comes and goes, the lidar becomes faulty
 * and is repaired, and its power fails and returns. The program must print the lidar's model, and
 * stop the robot only while needed. */

#ifndef STORY_H
#define STORY_H

#include <stdbool.h>

/* Begins the story; `assert_stops` checks whether the program now stops the robot. */
void story_begin(void (*assert_stops)(bool stops));

/* Call this repeatedly: it does and checks what is due. Returns false at the end of the story. */
bool story_goes_on(void);

/* For a program that never ends: while it sleeps, story_go_on() lets the story go on, and leaves
 * the program at the end; story_leave() leaves it at once. */
void story_go_on(void);
void story_leave(void);
void story_run(int (*program)(void), void (*on_sleep)(void));

/* Tells the whole story; printing must leave time. */
void story_tell(int (*program)(void), void (*assert_stops)(bool stops), void (*on_sleep)(void));

#endif
