/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ctrl-C, and the other signals that ask a program to end: they are noted, so that the lidar can be
 * stopped and the terminal restored before leaving. A second signal, or five seconds, end the
 * program at once, after the functions of interrupt_last_words(). */

#ifndef INTERRUPT_H
#define INTERRUPT_H

#include <stdbool.h>

/* From now on a closed pipe (`| head`) ends the program at once and silently, as usual, but the
 * functions of interrupt_last_words() still run. A file at its size limit is treated as a full
 * disk. */
void interrupt_watch_pipes(void);

/* From now on SIGINT, SIGTERM, SIGHUP and SIGQUIT are only noted, unless they are ignored. With
 * `writes_whole`, output that has begun is completed, if its reader takes it in time; without it
 * the signal cuts the output off. */
void interrupt_watch(bool writes_whole);

/* Registers a function that is called from the signal's handler when a second signal comes or a
 * pipe is closed. Up to two functions; a function that is registered already is not added again. */
void interrupt_last_words(void (*speak)(void));

bool interrupt_has_come(void);

#endif
