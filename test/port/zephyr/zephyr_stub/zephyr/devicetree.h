/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: a devicetree with the lidar on the only UART, at 10 Hz. */

#ifndef ZEPHYR_DEVICETREE_H
#define ZEPHYR_DEVICETREE_H

#include "../autoconf.h"

#define DT_NODELABEL(label) DT_NODE_##label
#define DT_BUS(node) BUS_OF(node)
#define BUS_OF(node) BUS_OF_##node
#define BUS_OF_DT_NODE_lidar DT_NODE_uart

#define DT_INST_BUS(instance) DT_NODE_uart
#define DT_INST_PROP_OR(instance, property, otherwise) (DT_PROPERTY_##property)
#define DT_PROPERTY_frequency_hz 10
#define DT_INST_FOREACH_STATUS_OKAY(function) function(0)

#endif
