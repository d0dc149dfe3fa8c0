/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Uses every command and every result of tmini.h. */

#ifndef FULL_DRIVER_H
#define FULL_DRIVER_H

#include "board.h"

static uint8_t rx[512];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_counters_t counters;
static tmini_ct_info_t turn;
static volatile uint32_t sink;

static void commands(void)
{
    (void)tmini_request_info(&lidar);
    (void)tmini_request_health(&lidar);
    (void)tmini_request_frequency(&lidar);
    (void)tmini_set_frequency(&lidar, 1000);
    (void)tmini_start(&lidar);
    (void)tmini_stop(&lidar);
    (void)tmini_reboot(&lidar);
}

static void results(void)
{
    sink = tmini_scan(&lidar)->count;
    sink = tmini_info(&lidar)->model;
    sink = tmini_health(&lidar)->faults;
    sink = tmini_frequency_chz(&lidar);
    sink = tmini_faults(&lidar);
    sink = (uint32_t)tmini_command_error(&lidar);
    sink = (uint32_t)tmini_state(&lidar);
    tmini_counters(&lidar, &counters);
    tmini_ct_info(&lidar, &turn);
}

static void full_driver(void)
{
    const tmini_config_t config = {.port = &board,
                                   .rx_buffer = rx,
                                   .rx_size = sizeof rx,
                                   .points = points,
                                   .max_points = TMINI_SCAN_POINTS_TYPICAL};
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        return;
    }
    commands();
    while (tmini_poll(&lidar) != TMINI_EVENT_COMMAND_FAILED) {
        results();
    }
}

#endif
