/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What tmini-sim writes down: the log, and the truth about every sample sent. */

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

/* Opens what is asked for (NULL: nothing, "-": standard output) and observes device and link.
 * False after a message on standard error. */
bool report_open(report_t *report, const char *log_path, const char *truth_path, sim_t *sim,
                 sim_link_t *link);

/* Writes the totals. False, after a message, if not all could be written. */
bool report_close(report_t *report, uint64_t now_us, uint64_t lost_by_host);

#endif
