/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: several steps instead of the configuration's one. They are called in the order given:
 *
 *     static const tmini_one_step_t list[] = {
 *         {tmini_mount_step, &mount},       1. the robot's directions, its own parts masked
 *         {tmini_fields_step, &fields},     2. fields see each point
 *         {tmini_isolated_step, NULL},      3. filters come last
 *     };
 *     static const tmini_steps_t steps = {list, 3};
 *
 *     static const tmini_config_t config = {
 *         ..., .step = tmini_steps_step, .step_data = &steps,
 *     };
 *
 * Mounting first, because the others expect the robot's directions. Filters last, because what they
 * remove may be an obstacle. */

#ifndef TMINI_STEPS_H
#define TMINI_STEPS_H

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A step, as in the configuration, and its data. */
typedef struct {
    void (*step)(const void *data, tmini_scan_t *scan); /**< NULL: nothing happens. */
    const void *data;                                   /**< Passed to it. */
} tmini_one_step_t;

/** Steps in their order. */
typedef struct {
    const tmini_one_step_t *list; /**< Stays the caller's. */
    size_t count;                 /**< How many there are. */
} tmini_steps_t;

/** The step for the configuration's `step`, with a tmini_steps_t as its `step_data`; NULL does
 * nothing. */
void tmini_steps_step(const void *steps, tmini_scan_t *scan);

#ifdef __cplusplus
}
#endif

#endif
