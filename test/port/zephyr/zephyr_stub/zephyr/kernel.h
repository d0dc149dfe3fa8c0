/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: the kernel. */

#ifndef ZEPHYR_KERNEL_H
#define ZEPHYR_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "../autoconf.h"

typedef struct {
    int64_t ms;
} k_timeout_t;
#define K_MSEC(time_ms) ((k_timeout_t){.ms = (time_ms)})
#define K_NO_WAIT K_MSEC(0)
#define K_FOREVER K_MSEC(INT32_MAX)

typedef char k_thread_stack_t;
typedef void (*k_thread_entry_t)(void *p1, void *p2, void *p3);
struct k_thread {
    const char *name;
};
typedef struct k_thread *k_tid_t;
#define K_THREAD_STACK_DEFINE(name, size) k_thread_stack_t name[size]
k_tid_t k_thread_create(struct k_thread *thread, k_thread_stack_t *stack, size_t stack_size,
                        k_thread_entry_t entry, void *p1, void *p2, void *p3, int priority,
                        uint32_t options, k_timeout_t delay);
int k_thread_name_set(k_tid_t thread, const char *name);
int32_t k_sleep(k_timeout_t timeout);

struct k_mutex {
    struct task *owner;
    unsigned count;
};
int k_mutex_init(struct k_mutex *mutex);
int k_mutex_lock(struct k_mutex *mutex, k_timeout_t timeout);
int k_mutex_unlock(struct k_mutex *mutex);

struct k_sem {
    unsigned count;
    unsigned limit;
};
int k_sem_init(struct k_sem *sem, unsigned initial, unsigned limit);
int k_sem_take(struct k_sem *sem, k_timeout_t timeout);
void k_sem_give(struct k_sem *sem);

struct k_spinlock {
    bool held;
};
typedef struct {
    int key;
} k_spinlock_key_t;
k_spinlock_key_t k_spin_lock(struct k_spinlock *lock);
void k_spin_unlock(struct k_spinlock *lock, k_spinlock_key_t key);

uint32_t k_uptime_get_32(void);

#endif
