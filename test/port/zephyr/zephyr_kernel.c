/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr's kernel on the model: the test's thread and one more. One runs while the other waits. */

#include <errno.h>
#include <stdlib.h>
#include <ucontext.h>

#include <zephyr/kernel.h>

#include "irq_lines.h"
#include "zephyr_model.h"

#define STEP_US 40u
#define STACK_SIZE (256u * 1024u)
#define THREADS 2

typedef struct {
    bool used;
    ucontext_t context;
    uint64_t until_us;
    const struct k_sem *awaited;
    k_thread_entry_t entry;
    void *arguments[3];
} thread_t;

static struct {
    thread_t threads[THREADS];
    int current;
} kernel;

static char stack_of_thread[STACK_SIZE];

void zephyr_kernel_begin(void)
{
    kernel.threads[0] = (thread_t){.used = true};
    kernel.threads[1].used = false;
    kernel.current = 0;
}

/* -------------------------------------------------------------------------------------- threads */

static bool may_run(const thread_t *thread)
{
    return thread->used && (machine.now_us >= thread->until_us ||
                            (thread->awaited != NULL && thread->awaited->count > 0));
}

static void switch_to(int number)
{
    const int from = kernel.current;
    kernel.current = number;
    if (swapcontext(&kernel.threads[from].context, &kernel.threads[number].context) != 0) {
        abort();
    }
}

/* Runs the other thread, or lets time pass, until the calling thread may continue. */
static void block(uint64_t us, const struct k_sem *awaited)
{
    thread_t *const me = &kernel.threads[kernel.current];
    const int other = 1 - kernel.current;
    me->until_us = machine.now_us + us;
    me->awaited = awaited;
    while (!may_run(me)) {
        if (may_run(&kernel.threads[other])) {
            switch_to(other);
        } else {
            machine_pass(STEP_US);
        }
    }
    me->awaited = NULL;
    if (machine.on_sleep != NULL && kernel.current == 0) {
        machine.on_sleep();
    }
}

static void enter(void)
{
    const thread_t *const me = &kernel.threads[1];
    me->entry(me->arguments[0], me->arguments[1], me->arguments[2]);
    abort(); /* The port's thread must not end. */
}

/* The new thread runs when the test's thread waits for the first time. */
k_tid_t k_thread_create(struct k_thread *thread, k_thread_stack_t *stack, size_t stack_size,
                        k_thread_entry_t entry, void *p1, void *p2, void *p3, int priority,
                        uint32_t options, k_timeout_t delay)
{
    thread_t *const created = &kernel.threads[1];
    (void)stack, (void)stack_size, (void)priority, (void)options, (void)delay;
    if (created->used || getcontext(&created->context) != 0) {
        abort();
    }
    created->used = true;
    created->until_us = 0;
    created->awaited = NULL;
    created->entry = entry;
    created->arguments[0] = p1;
    created->arguments[1] = p2;
    created->arguments[2] = p3;
    created->context.uc_stack.ss_sp = stack_of_thread;
    created->context.uc_stack.ss_size = sizeof stack_of_thread;
    created->context.uc_link = NULL;
    makecontext(&created->context, enter, 0);
    return thread;
}

int k_thread_name_set(k_tid_t thread, const char *name)
{
    thread->name = name;
    return 0;
}

int32_t k_sleep(k_timeout_t timeout)
{
    block((uint64_t)timeout.ms * 1000u, NULL);
    return 0;
}

uint32_t k_uptime_get_32(void)
{
    return (uint32_t)(machine.now_us / 1000u);
}

/* ------------------------------------------------------------------------- semaphores and locks */

int k_sem_init(struct k_sem *sem, unsigned initial, unsigned limit)
{
    *sem = (struct k_sem){.count = initial, .limit = limit};
    return 0;
}

void k_sem_give(struct k_sem *sem)
{
    if (sem->limit == 0) {
        abort(); /* The semaphore was not initialised. */
    }
    if (sem->count < sem->limit) {
        sem->count++;
    }
}

int k_sem_take(struct k_sem *sem, k_timeout_t timeout)
{
    irq_access();
    board.waits++;
    block((uint64_t)timeout.ms * 1000u, sem);
    if (sem->count == 0) {
        return -EAGAIN;
    }
    sem->count--;
    board.wakes++;
    return 0;
}

int k_mutex_init(struct k_mutex *mutex)
{
    *mutex = (struct k_mutex){.count = 0};
    return 0;
}

int k_mutex_lock(struct k_mutex *mutex, k_timeout_t timeout)
{
    (void)timeout;
    while (mutex->count > 0 && mutex->owner != kernel.current) {
        switch_to(mutex->owner);
    }
    mutex->owner = kernel.current;
    mutex->count++;
    return 0;
}

int k_mutex_unlock(struct k_mutex *mutex)
{
    if (mutex->count == 0 || mutex->owner != kernel.current) {
        abort(); /* -EPERM, -EINVAL: a bug of the port. */
    }
    mutex->count--;
    return 0;
}

/* On one processor a spin lock keeps interrupts out. */
k_spinlock_key_t k_spin_lock(struct k_spinlock *lock)
{
    irq_access();
    const k_spinlock_key_t key = {.key = irq.masked};
    if (lock->held) {
        abort(); /* A deadlock. */
    }
    lock->held = true;
    irq.masked = true;
    return key;
}

void k_spin_unlock(struct k_spinlock *lock, k_spinlock_key_t key)
{
    lock->held = false;
    irq.masked = key.key != 0;
    irq_access();
}
