/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program with the full driver, the blocking helpers and sectors. */

#include "full_driver.h"

#include "tmini/tmini_blocking.h"
#include "tmini/tmini_sectors.h"

#define SECTORS 8

static tmini_info_t info;
static tmini_health_t health;
static uint16_t frequency_chz;
static tmini_sectors_t sectors;
static tmini_sector_t held[SECTORS];

static void waiting_commands(void)
{
    (void)tmini_blocking_read_info(&lidar, &info, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_blocking_read_health(&lidar, &health, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_blocking_read_frequency(&lidar, &frequency_chz, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_blocking_set_frequency(&lidar, 1000, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_blocking_start(&lidar, TMINI_BLOCKING_TIMEOUT_MS);
    (void)tmini_blocking_stop(&lidar, TMINI_BLOCKING_TIMEOUT_MS);
}

static void look_around(void)
{
    (void)tmini_sectors_init(&sectors, held, SECTORS, TMINI_FILTER_NONE);
    tmini_sectors_add_scan(&sectors, tmini_scan(&lidar));
    (void)tmini_sectors_add_packet(&sectors, tmini_packet(&lidar));
    sink = held[tmini_sectors_at(&sectors, 0)].nearest_mm;
}

void bench_main(void)
{
    full_driver();
    waiting_commands();
    look_around();
}
