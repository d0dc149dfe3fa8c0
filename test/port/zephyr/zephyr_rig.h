/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The Zephyr port and a lidar on the model, for the tests of both UART APIs. */

#ifndef ZEPHYR_RIG_H
#define ZEPHYR_RIG_H

#include "tmini_zephyr.h"

extern tmini_zephyr_t port;

void zephyr_rig_begin(void);
void zephyr_rig_end(void);

/* Starts the port; returns the result of tmini_zephyr_start(). */
int zephyr_rig_start_port(void);

/* Starts the port and the lidar. */
void zephyr_rig_start(void);

tmini_zephyr_counters_t zephyr_rig_counters(void);

#endif
