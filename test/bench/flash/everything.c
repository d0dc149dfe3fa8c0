/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The full driver and all optional modules. */

#include "full_driver.h"

#include "tmini/tmini_blocking.h"

static tmini_info_t info;
static tmini_health_t health;
static uint16_t frequency_chz;

static void waiting_commands(void)
{
    (void)tmini_read_info(&lidar, &info, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_read_health(&lidar, &health, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_read_frequency(&lidar, &frequency_chz, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_write_frequency(&lidar, 1000, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_start_and_wait(&lidar, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_stop_and_wait(&lidar, TMINI_BLOCKING_TIMEOUT_MS);
}

void bench_main(void)
{
    full_driver();
    waiting_commands();
}
