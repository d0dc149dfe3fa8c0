/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tasks are threads, and time advances only when all of them wait, in steps of up to half a
 * millisecond. So results do not depend on how busy the computer is. */

#include "idf.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define STEP_US 500u
#define TICK_US (1000000u / CONFIG_FREERTOS_HZ)
#define WAITERS 8u

typedef struct {
    bool used;
    bool released;
    bool for_event; /* False: it only waits for the time. */
    uint64_t until_us;
} waiter_t;

static struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    unsigned tasks; /* With the test itself. */
    unsigned waiting;
    waiter_t waiters[WAITERS];
} world = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

void idf_lock(void)
{
    pthread_mutex_lock(&world.lock);
}

void idf_unlock(void)
{
    pthread_mutex_unlock(&world.lock);
}

void idf_begin_tasks(void)
{
    idf_lock();
    world.tasks = 1;
    world.waiting = 0;
    memset(world.waiters, 0, sizeof world.waiters);
    idf_unlock();
}

unsigned idf_tasks(void)
{
    idf_lock();
    const unsigned tasks = world.tasks;
    idf_unlock();
    return tasks;
}

static bool is_over(const waiter_t *waiter)
{
    return machine.now_us >= waiter->until_us || (waiter->for_event && idf.queue_count > 0);
}

static void release_waiters(void)
{
    for (unsigned i = 0; i < WAITERS; i++) {
        waiter_t *const waiter = &world.waiters[i];
        if (waiter->used && !waiter->released && is_over(waiter)) {
            waiter->released = true;
            world.waiting--;
        }
    }
    pthread_cond_broadcast(&world.changed);
}

static void let_time_pass(void)
{
    while (world.tasks > 0 && world.waiting == world.tasks) {
        machine_step(STEP_US);
        release_waiters();
    }
}

void idf_wait(TickType_t ticks, bool for_event)
{
    waiter_t *waiter = world.waiters;
    while (waiter->used) {
        waiter++;
    }
    *waiter = (waiter_t){.used = true,
                         .for_event = for_event,
                         .until_us = machine.now_us + (uint64_t)ticks * TICK_US};
    world.waiting++;
    release_waiters();
    let_time_pass();
    while (!waiter->released) {
        pthread_cond_wait(&world.changed, &world.lock);
    }
    waiter->used = false;
}

typedef struct {
    TaskFunction_t function;
    void *argument;
} start_t;

static void *run_task(void *argument)
{
    const start_t start = *(start_t *)argument;
    free(argument);
    start.function(start.argument);
    return NULL;
}

void idf_begin_task(TaskFunction_t function, void *argument)
{
    pthread_t thread;
    start_t *const start = malloc(sizeof *start);
    if (start == NULL) {
        abort();
    }
    *start = (start_t){.function = function, .argument = argument};
    idf_lock();
    world.tasks++;
    idf_unlock();
    if (pthread_create(&thread, NULL, run_task, start) != 0) {
        abort();
    }
    pthread_detach(thread);
}

void idf_end_task(void)
{
    idf_lock();
    world.tasks--;
    let_time_pass();
    idf_unlock();
    pthread_exit(NULL);
}
