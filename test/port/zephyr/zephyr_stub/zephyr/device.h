/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Zephyr: devices. zephyr_model_boot() initialises the lidar's device. */

#ifndef ZEPHYR_DEVICE_H
#define ZEPHYR_DEVICE_H

#include <stdbool.h>
#include <string.h>
#include <zephyr/devicetree.h>

struct device {
    const char *name;
    const void *config;
    void *data;
};
extern const struct device zephyr_model_uart;
extern const struct device zephyr_model_lidar_device;

#define DEVICE_DT_GET(node) DEVICE_OF(node)
#define DEVICE_OF(node) DEVICE_OF_##node
#define DEVICE_OF_DT_NODE_uart (&zephyr_model_uart)
#define DEVICE_OF_DT_NODE_lidar (&zephyr_model_lidar_device)

#define DEVICE_DT_INST_DEFINE(instance, init_function, pm, data_pointer, config_pointer, level, \
                              priority, api)                                                    \
    const struct device zephyr_model_lidar_device = {                                           \
        .name = "lidar", .config = (config_pointer), .data = (data_pointer)};                   \
    int zephyr_model_init_lidar(void);                                                          \
    int zephyr_model_init_lidar(void)                                                           \
    {                                                                                           \
        memset((data_pointer), 0, sizeof *(data_pointer));                                      \
        return init_function(&zephyr_model_lidar_device);                                       \
    }                                                                                           \
    struct device /* The macro's user writes the semicolon. */

bool device_is_ready(const struct device *device);

#endif
