/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The files that tmini-sim writes: a log, and the true value of every sample sent. */

#ifndef REPORT_H
#define REPORT_H

#include "link.h"

#include <stdio.h>

typedef struct {
    FILE *log;   /* NULL: none */
    FILE *truth; /* NULL: none */
    const sim_t *sim;
    const sim_link_t *link;
} report_t;

/* Opens the files (NULL: none, "-": standard output) and observes device and link. On failure
 * prints a message and returns false. */
bool report_open(report_t *report, const char *log_path, const char *truth_path, sim_t *sim,
                 sim_link_t *link);

/* Writes the totals. If writing has failed, prints a message and returns false. */
bool report_close(report_t *report, uint64_t now_us, uint64_t lost_by_host);

/* A file that is written: NULL if there is no path, standard output for "-". False: it cannot be
 * opened, and a message is printed; or not all was written. */
bool report_open_file(FILE **file, const char *path);
bool report_close_file(FILE *file);

#endif
