/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of the FreeRTOS functions that the port uses, and of the example's board
 * (examples/freertos/board.h) with the simulated lidar. There is one processor: only the ready task
 * with the highest priority runs. Time passes when no task is ready, or when the running task calls
 * machine_pass(). Then bytes arrive and the UART's interrupt is served. If it wakes a task
 * of higher priority, this task runs at once.
 *
 * The test itself is a task, with the priority given to freertos_model_begin(). */

#ifndef FREERTOS_MODEL_H
#define FREERTOS_MODEL_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "FreeRTOS.h"
#include "machine.h"
#include "task.h"

#define TASKS 4u

struct freertos_task {
    pthread_t thread;
    pthread_cond_t turn;
    TaskFunction_t function;
    void *argument;
    UBaseType_t priority;
    bool used;
    bool suspended;
    bool waiting;    /* Waits until `until_us`. */
    bool for_notice; /* A notification also ends the wait. */
    uint64_t until_us;
    uint32_t notices;
};

typedef struct {
    struct freertos_task tasks[TASKS]; /* The first one is the test itself. */
    struct freertos_task *current;
    bool ending;
    bool pending;           /* The test has raised the UART's interrupt. */
    uint64_t skipped_us;    /* By the tick alone: no byte arrived, and no task ran. */
    bool interrupt_enabled; /* Other code could switch it off. */
    bool overrun;           /* The UART reports it with the next interrupt. */
    unsigned wakes;         /* How often the test's task has been woken by a notification. */
} freertos_world_t;

extern freertos_world_t world;

/* Resets the model, with a lidar at rest that `observer` watches. The caller becomes a task. */
void freertos_model_begin(const sim_observer_t *observer, unsigned priority);

/* Puts bytes in the UART's FIFO, after an overrun or not. No task runs meanwhile. */
void freertos_model_receive(bool overrun, const uint8_t *bytes, size_t count);

/* The number of tasks, not counting the test's. */
unsigned freertos_model_tasks(void);

#endif
