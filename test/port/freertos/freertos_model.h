/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of the FreeRTOS functions that the port uses, and of the example's board
 * (examples/freertos/board.h) with the simulated lidar. There is one processor: only the ready task
 * with the highest priority runs. Time passes when no task is ready, or when the running task calls
 * freertos_model_work(). Then bytes arrive and the UART's interrupt is served. If it wakes a task
 * of higher priority, this task runs at once.
 *
 * The test itself is a task, with the priority given to freertos_model_begin(). */

#ifndef FREERTOS_MODEL_H
#define FREERTOS_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

/* Resets the model, with a lidar at rest that `observer` watches. The caller becomes a task. */
void freertos_model_begin(const sim_observer_t *observer, unsigned priority);

sim_t *freertos_model_lidar(void);

uint64_t freertos_model_now_us(void);

/* The running task is busy for this long. */
void freertos_model_work(uint32_t us);

/* As above, but with interrupts disabled. */
void freertos_model_work_undisturbed(uint32_t us);

/* Puts bytes in the UART's FIFO, after an overrun or not. No task runs meanwhile. */
void freertos_model_receive(bool overrun, const uint8_t *bytes, size_t count);

/* The UART reports an overrun with the next interrupt. */
void freertos_model_overrun(void);

/* Switches the UART's interrupt off, as other code could do. */
void freertos_model_disable_interrupt(void);

/* Advances only the clock: no byte arrives and no task runs. */
void freertos_model_skip(uint64_t us);

/* Bytes on the line so far, and those that found the UART's FIFO full. */
uint32_t freertos_model_line_bytes(void);
uint32_t freertos_model_overrun_bytes(void);

/* How often the test's task has been woken by a notification. */
unsigned freertos_model_wakes(void);

/* The number of tasks, not counting the test's. */
unsigned freertos_model_tasks(void);

#endif
