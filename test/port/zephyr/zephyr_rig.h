/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The Zephyr port and a lidar on the model, for the tests of both of Zephyr's APIs. */

#ifndef ZEPHYR_RIG_H
#define ZEPHYR_RIG_H

#include "tmini_zephyr.h"

extern tmini_zephyr_t port;

void zephyr_rig_begin(void);
void zephyr_rig_end(void);

/* What tmini_zephyr_start() returns. */
int zephyr_rig_start_port(void);

/* The lidar is to scan as well. */
void zephyr_rig_start(void);

tmini_zephyr_counters_t zephyr_rig_counters(void);

#endif
