/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The Zephyr port and a lidar on the model, for the tests of both UART APIs. */

#ifndef ZEPHYR_RIG_H
#define ZEPHYR_RIG_H

#include "every_port.h"
#include "tmini_zephyr.h"
#include "zephyr_model.h"

extern tmini_zephyr_t port;

tmini_zephyr_counters_t counted(void);

#endif
