/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tasks.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine.h"

#define TASKS 4
#define STACK_SIZE (256u * 1024u)

static task_t tasks[TASKS];
static char stacks[TASKS][STACK_SIZE];

task_t *tasks_current;

void tasks_begin(unsigned priority)
{
    memset(tasks, 0, sizeof tasks);
    tasks[0] = (task_t){.used = true, .priority = priority};
    tasks_current = &tasks[0];
}

static void fail(const char *what)
{
    fprintf(stderr, "%s\n", what);
    abort();
}

static void enter(void)
{
    tasks_current->function(tasks_current->argument);
    fail("a task must not return");
}

task_t *tasks_new(unsigned priority, void (*function)(void *argument), void *argument)
{
    int i = 0;
    while (i < TASKS && tasks[i].used) {
        i++;
    }
    if (i == TASKS || getcontext(&tasks[i].context) != 0) {
        fail("no more tasks");
    }
    task_t *const task = &tasks[i];
    task->used = true;
    task->priority = priority;
    task->function = function;
    task->argument = argument;
    task->context.uc_stack.ss_sp = stacks[i];
    task->context.uc_stack.ss_size = STACK_SIZE;
    task->context.uc_link = NULL;
    makecontext(&task->context, enter, 0);
    return task;
}

static bool is_ready(const task_t *task)
{
    return task->used && (machine.now_us >= task->until_us ||
                          (task->is_awaited != NULL && task->is_awaited(task)));
}

static task_t *most_urgent(void)
{
    task_t *chosen = NULL;
    for (int i = 0; i < TASKS; i++) {
        if (is_ready(&tasks[i]) && (chosen == NULL || tasks[i].priority > chosen->priority)) {
            chosen = &tasks[i];
        }
    }
    return chosen;
}

/* When the first of those that wait has waited long enough. */
static uint64_t first_us(void)
{
    uint64_t first = UINT64_MAX;
    for (int i = 0; i < TASKS; i++) {
        if (tasks[i].used && tasks[i].until_us < first) {
            first = tasks[i].until_us;
        }
    }
    return first;
}

void tasks_run(task_t *next)
{
    task_t *const self = tasks_current;
    tasks_current = next;
    if (next != self && swapcontext(&self->context, &next->context) != 0) {
        fail("no change of tasks");
    }
}

void tasks_alternate(void)
{
    ptrdiff_t next = tasks_current - tasks;
    do {
        next = (next + 1) % TASKS;
    } while (!is_ready(&tasks[next]));
    tasks_run(&tasks[next]);
}

void tasks_yield(void)
{
    task_t *const next = most_urgent();
    if (next != NULL && next->priority > tasks_current->priority) {
        tasks_run(next);
    }
}

void tasks_wait(uint64_t until_us, bool (*is_awaited)(const task_t *))
{
    task_t *const self = tasks_current;
    task_t *next;
    self->until_us = until_us;
    self->is_awaited = is_awaited;
    do {
        while ((next = most_urgent()) == NULL) {
            machine_idle(first_us());
        }
        tasks_run(next);
    } while (!is_ready(self));
    self->until_us = 0;
    self->is_awaited = NULL;
}

/* Nobody runs it again. */
void tasks_end(void)
{
    tasks_current->used = false;
    tasks_wait(0, NULL);
}

unsigned tasks_count(void)
{
    unsigned count = 0;
    for (int i = 1; i < TASKS; i++) {
        count += tasks[i].used;
    }
    return count;
}

bool tasks_is_test(void)
{
    return tasks_current == &tasks[0];
}
