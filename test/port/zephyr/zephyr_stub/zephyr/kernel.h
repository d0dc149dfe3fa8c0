/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: the kernel. */

#ifndef ZEPHYR_KERNEL_H
#define ZEPHYR_KERNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "../autoconf.h"

typedef struct {
    int64_t ms;
} k_timeout_t;
#define K_MSEC(time_ms) ((k_timeout_t){.ms = (time_ms)})

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
