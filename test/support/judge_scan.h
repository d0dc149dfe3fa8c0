/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Shows the library's points to the judge (sim_judge.h), which knows nothing of the library. */

#ifndef JUDGE_SCAN_H
#define JUDGE_SCAN_H

#include "sim_judge.h"

#include "tmini/tmini_types.h"

static inline void judge_point(sim_judge_t *judge, sim_reading_t *reading,
                               const tmini_point_t *point)
{
    const reference_point_t shown = {point->angle_q6, point->distance_mm, point->intensity,
                                     point->flag};
    sim_read_point(judge, reading, shown);
}

/* A scan that has not ended is not judged as a whole. */
static inline sim_reading_t judge_points(sim_judge_t *judge, const tmini_scan_t *scan)
{
    sim_reading_t reading = {0};
    for (unsigned i = 0; i < scan->count; i++) {
        judge_point(judge, &reading, &scan->points[i]);
    }
    return reading;
}

static inline sim_reading_t judge_scan(sim_judge_t *judge, const tmini_scan_t *scan)
{
    sim_reading_t reading = judge_points(judge, scan);
    (void)sim_read_end(judge, &reading, scan->complete, scan->gaps, scan->dropped);
    return reading;
}

#endif
