/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr's kernel on the model: the test's thread and one more. One runs while the other waits. */

#include <errno.h>
#include <stdlib.h>

#include <zephyr/kernel.h>

#include "irq_lines.h"
#include "tasks.h"
#include "zephyr_model.h"

void zephyr_kernel_begin(void)
{
    tasks_begin(0);
}

/* -------------------------------------------------------------------------------------- threads */

static void block(uint64_t us, bool (*is_awaited)(const task_t *))
{
    tasks_wait(machine.now_us + us, is_awaited);
    if (machine.on_sleep != NULL && tasks_is_test()) {
        machine.on_sleep();
    }
}

static struct {
    k_thread_entry_t entry;
    void *arguments[3];
} created;

static void enter(void *argument)
{
    (void)argument;
    created.entry(created.arguments[0], created.arguments[1], created.arguments[2]);
}

/* The new thread runs when the test's thread waits for the first time. */
k_tid_t k_thread_create(struct k_thread *thread, k_thread_stack_t *stack, size_t stack_size,
                        k_thread_entry_t entry, void *p1, void *p2, void *p3, int priority,
                        uint32_t options, k_timeout_t delay)
{
    (void)stack, (void)stack_size, (void)priority, (void)options, (void)delay;
    created.entry = entry;
    created.arguments[0] = p1;
    created.arguments[1] = p2;
    created.arguments[2] = p3;
    (void)tasks_new(0, enter, NULL);
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

static bool is_given(const task_t *task)
{
    return ((const struct k_sem *)task->awaited)->count > 0;
}

int k_sem_take(struct k_sem *sem, k_timeout_t timeout)
{
    irq_access();
    board.waits++;
    tasks_current->awaited = sem;
    block((uint64_t)timeout.ms * 1000u, is_given);
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
    while (mutex->count > 0 && mutex->owner != tasks_current) {
        tasks_run(mutex->owner);
    }
    mutex->owner = tasks_current;
    mutex->count++;
    return 0;
}

int k_mutex_unlock(struct k_mutex *mutex)
{
    if (mutex->count == 0 || mutex->owner != tasks_current) {
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
