/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: removes isolated points, such as come from dust, rain, the edges of things or another
 * lidar. A point is isolated if none of the two points before and the two after it is near; near is
 * a distance that grows with the range. Its distance becomes 0: unknown, not free. Integers only.
 *
 *     static const tmini_config_t config = {..., .step = tmini_isolated_step};
 *
 * With other values:
 *
 *     static const tmini_isolated_t isolated = {.near_mm = 30, .percent = 4};
 *
 *     static const tmini_config_t config = {
 *         ..., .step = tmini_isolated_step, .step_data = &isolated,
 *     };
 *
 * Of points at random distances it removes 96 %, of the simulated room's others 0.1 %, of a real
 * unit's recording 0.3 %. For maps and pictures, not for stopping: a thin thing far away (3 cm
 * beyond 1 m at 10 Hz) is one point, too. Fields (tmini_fields.h) see the points before this step
 * does; tmini_steps.h has the order. Any context; no waiting; about 75 instructions per point. */

#ifndef TMINI_ISOLATED_H
#define TMINI_ISOLATED_H

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** When two points are near each other: their places, not their ranges, are at most near_mm +
 * percent of the nearer one's range apart. Neighbouring points on a wall square to the beam are 0.9
 * % of the range apart at 6 Hz and 1.9 % at 12 Hz; on a wall at 60 degrees three times that. */
typedef struct {
    uint16_t near_mm; /**< 0: TMINI_ISOLATED_NEAR_MM. */
    uint8_t percent;  /**< 0: TMINI_ISOLATED_PERCENT. */
} tmini_isolated_t;

/** The default of near_mm. */
#define TMINI_ISOLATED_NEAR_MM 50u
/** The default of percent. */
#define TMINI_ISOLATED_PERCENT 6u

/** The step for the configuration's `step`, with a tmini_isolated_t as its `step_data`; NULL: the
 * defaults. The points keep their order and number. */
void tmini_isolated_step(const void *isolated, tmini_scan_t *scan);

#ifdef __cplusplus
}
#endif

#endif
