/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The simulated lidar as another program, on a pseudo-terminal, for tests in C of the POSIX port.
 * TMINI_SIM is the program's path. WORK_DIR is the folder in which the test runs. POSIX only. */

#ifndef PROGRAM_H
#define PROGRAM_H

/* A file's path in WORK_DIR; valid until the fourth call after this one. */
const char *program_path(const char *name);

/* Starts the simulated lidar with these options (up to a NULL). Returns its port, which stays
 * valid. */
const char *program_start_lidar(const char *const options[]);

/* As if the cable of the last one were pulled. */
void program_stop_lidar(void);

/* Makes the file "adapter" a link to this device, as the system does when an adapter is plugged in;
 * NULL: removes it. */
void program_plug_in(const char *device);

/* Ends all lidars. For tearDown(). */
void program_clean_up(void);

#endif
