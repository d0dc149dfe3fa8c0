/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: a devicetree with the lidar on the only UART. */

#ifndef ZEPHYR_DEVICETREE_H
#define ZEPHYR_DEVICETREE_H

#include "../autoconf.h"

#define DT_NODELABEL(label) DT_NODE_##label
#define DT_BUS(node) BUS_OF(node)
#define BUS_OF(node) BUS_OF_##node
#define BUS_OF_DT_NODE_lidar zephyr_model_uart

#endif
