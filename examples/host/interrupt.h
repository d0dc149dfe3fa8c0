/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Ctrl-C, and the other signals that ask a program to end: they are noted, so that the lidar can be
 * stopped and the terminal restored before leaving. A second one ends the program at once. */

#ifndef INTERRUPT_H
#define INTERRUPT_H

#include <stdbool.h>

/* From now on SIGINT, SIGTERM, SIGHUP and SIGQUIT are only noted, and a reader that has gone (`| head`)
 * makes writing fail instead of ending the program. */
void interrupt_watch(void);

/* True once one of them has come. */
bool interrupt_has_come(void);

#endif
