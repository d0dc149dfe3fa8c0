/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A FreeRTOS kernel as far as the port talks to it, and the example's board
 * (examples/freertos/board.h) with the simulated lidar on it. One processor: of the tasks that are
 * ready the one with the highest priority runs, alone. Time passes when none is ready, or when the
 * one that runs works; then bytes come and the UART's interrupt is served, and a task of higher
 * priority that it wakes runs at once.
 *
 * The test itself is a task, of the priority given at the beginning. */

#ifndef FREERTOS_MODEL_H
#define FREERTOS_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

/* A fresh world, with a lidar at rest that `observer` watches; the caller becomes a task. */
void freertos_model_begin(const sim_observer_t *observer, unsigned priority);

/* The lidar; see simulator.h. */
sim_t *freertos_model_lidar(void);

uint64_t freertos_model_now_us(void);

/* The running task is busy for this long. */
void freertos_model_work(uint32_t us);

/* The same, with interrupts disabled. */
void freertos_model_work_undisturbed(uint32_t us);

/* Bytes as if the lidar had sent them now, after an overrun or not; no task runs meanwhile. */
void freertos_model_receive(bool overrun, const uint8_t *bytes, size_t count);

/* The UART reports an overrun with the next interrupt. */
void freertos_model_overrun(void);

/* Something else switches the UART's interrupt off. */
void freertos_model_disable_interrupt(void);

/* Only the clock advances: no byte comes and no task runs. */
void freertos_model_skip(uint64_t us);

/* Bytes that have come on the line, and those that the UART's FIFO had no room for. */
uint32_t freertos_model_line_bytes(void);
uint32_t freertos_model_overrun_bytes(void);

/* How often the test's task has been woken by a notification. */
unsigned freertos_model_wakes(void);

/* Tasks besides the test's. */
unsigned freertos_model_tasks(void);

#endif
