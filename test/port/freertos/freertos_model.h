/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of the FreeRTOS functions that the port uses, and of the example's board
 * (examples/freertos/board.h) with the simulated lidar. Time passes when no task is ready
 * (tasks.h), or when the running task calls machine_pass(). Then bytes arrive and the UART's
 * interrupt is served. If it wakes a task of higher priority, this task runs at once. */

#ifndef FREERTOS_MODEL_H
#define FREERTOS_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "FreeRTOS.h"
#include "machine.h"
#include "task.h"
#include "tasks.h"

typedef struct {
    uint64_t skipped_us;    /* By the tick alone: no byte arrived, and no task ran. */
    bool interrupt_enabled; /* Other code could switch it off. */
    bool overrun;           /* The UART reports it with the next interrupt. */
    unsigned wakes;         /* How often the test's task has been woken by a notification. */
} freertos_world_t;

extern freertos_world_t world;

/* Resets the model, with a lidar at rest that `observer` watches. The caller becomes a task. */
void freertos_model_begin(const sim_observer_t *observer, unsigned priority);

#endif
