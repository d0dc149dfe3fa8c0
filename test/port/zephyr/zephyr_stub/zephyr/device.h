/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: devices. */

#ifndef ZEPHYR_DEVICE_H
#define ZEPHYR_DEVICE_H

#include <stdbool.h>
#include <zephyr/devicetree.h>

struct device {
    const char *name;
};
extern const struct device zephyr_model_uart;

#define DEVICE_DT_GET(node) (&node)

bool device_is_ready(const struct device *device);

#endif
