/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tasks on one processor, for the models of kernels. Only the ready task with the highest priority
 * runs. The first task is the test itself. Time passes when no task is ready, or when the running
 * one lets it pass. */

#ifndef TASKS_H
#define TASKS_H

#include <stdbool.h>
#include <stdint.h>
#include <ucontext.h>

typedef struct task {
    bool used;
    unsigned priority;
    uint64_t until_us;                       /* It waits until then, */
    bool (*is_awaited)(const struct task *); /* or until this is true; NULL: only for the time. */
    const void *awaited;                     /* For the kernel. */
    uint32_t notices;
    void (*function)(void *argument);
    void *argument;
    ucontext_t context;
} task_t;

extern task_t *tasks_current;

/* Forgets all tasks; the caller becomes the first one. */
void tasks_begin(unsigned priority);

task_t *tasks_new(unsigned priority, void (*function)(void *argument), void *argument);

/* Gives the processor to a task that is more urgent. */
void tasks_yield(void);

/* Gives it to this one. */
void tasks_run(task_t *next);

/* Gives it to the next task that is ready, whatever its priority: it has a processor of its own. */
void tasks_alternate(void);

/* Ends the running task. */
void tasks_end(void);

void tasks_wait(uint64_t until_us, bool (*is_awaited)(const task_t *));

/* The number of tasks, not counting the test. */
unsigned tasks_count(void);
bool tasks_is_test(void);

#endif
