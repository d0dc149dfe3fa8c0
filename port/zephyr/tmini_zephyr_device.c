/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define DT_DRV_COMPAT ydlidar_t_mini_plus

#include "tmini_zephyr_device.h"

#include <errno.h>

typedef struct {
    const struct device *uart;
    k_thread_stack_t *stack;
    uint8_t *rx;
    tmini_point_t *points; /* Two buffers, each of CONFIG_TMINI_POINTS. */
    uint16_t frequency_chz;
} device_config_t;

typedef struct {
    tmini_zephyr_t port;
    tmini_t lidar;
    struct k_mutex lock; /* Held while the library is called or the callback is changed. */
    struct k_thread thread;
    tmini_zephyr_callback_t callback;
    void *user_data;
} device_data_t;

/* Returns for how long the thread may sleep, in milliseconds. */
static uint32_t poll_once(const struct device *device)
{
    device_data_t *const data = device->data;
    uint32_t due_ms = 0;
    (void)k_mutex_lock(&data->lock, K_FOREVER);
    const tmini_event_t event = tmini_poll(&data->lidar);
    if (event == TMINI_EVENT_NONE) {
        due_ms = tmini_next_poll_ms(&data->lidar);
    } else if (data->callback != NULL) {
        data->callback(device, event, data->user_data);
    }
    (void)k_mutex_unlock(&data->lock);
    return due_ms;
}

static void run(void *argument, void *unused_1, void *unused_2)
{
    const struct device *const device = argument;
    device_data_t *const data = device->data;
    (void)unused_1;
    (void)unused_2;
    for (;;) {
        tmini_zephyr_sleep(&data->port, poll_once(device));
    }
}

static int init_lidar(const struct device *device)
{
    const device_config_t *const config = device->config;
    device_data_t *const data = device->data;
    const tmini_config_t lidar_config = {
        .port = &tmini_zephyr_port,
        .port_context = &data->port,
        .rx_buffer = config->rx,
        .rx_size = CONFIG_TMINI_RX_BUFFER,
        .points = config->points,
        .spare_points = &config->points[CONFIG_TMINI_POINTS],
        .max_points = CONFIG_TMINI_POINTS,
        .frequency_chz = config->frequency_chz,
    };
    return tmini_init(&data->lidar, &lidar_config) == TMINI_OK ? 0 : -EINVAL;
}

/* If the UART cannot be used, the device is not ready (device_is_ready()). */
static int init(const struct device *device)
{
    const device_config_t *const config = device->config;
    device_data_t *const data = device->data;
    (void)k_mutex_init(&data->lock);
    int error = tmini_zephyr_init(&data->port, config->uart);
    if (error == 0) {
        error = init_lidar(device);
    }
    if (error == 0) {
        error = tmini_zephyr_start(&data->port, &data->lidar);
    }
    if (error == 0) {
        (void)k_thread_create(&data->thread, config->stack, CONFIG_TMINI_THREAD_STACK, run,
                              (void *)device, NULL, NULL, CONFIG_TMINI_THREAD_PRIORITY, 0,
                              K_NO_WAIT);
        (void)k_thread_name_set(&data->thread, "tmini");
    }
    return error;
}

/* ------------------------------------------------------------------------------ from any thread */

tmini_t *tmini_zephyr_device_lidar(const struct device *device)
{
    device_data_t *const data = device->data;
    return &data->lidar;
}

tmini_t *tmini_zephyr_device_lock(const struct device *device)
{
    device_data_t *const data = device->data;
    (void)k_mutex_lock(&data->lock, K_FOREVER);
    return &data->lidar;
}

void tmini_zephyr_device_unlock(const struct device *device)
{
    device_data_t *const data = device->data;
    (void)k_mutex_unlock(&data->lock);
    k_sem_give(&data->port.received); /* The thread polls: a wish may have changed what is due. */
}

void tmini_zephyr_device_callback_set(const struct device *device, tmini_zephyr_callback_t callback,
                                      void *user_data)
{
    device_data_t *const data = device->data;
    (void)tmini_zephyr_device_lock(device);
    data->callback = callback;
    data->user_data = user_data;
    tmini_zephyr_device_unlock(device);
}

int tmini_zephyr_device_start(const struct device *device)
{
    const tmini_status_t status = tmini_start(tmini_zephyr_device_lock(device));
    tmini_zephyr_device_unlock(device);
    return status == TMINI_OK ? 0 : -EIO;
}

int tmini_zephyr_device_stop(const struct device *device)
{
    const tmini_status_t status = tmini_stop(tmini_zephyr_device_lock(device));
    tmini_zephyr_device_unlock(device);
    return status == TMINI_OK ? 0 : -EIO;
}

void tmini_zephyr_device_counters(const struct device *device, tmini_zephyr_counters_t *counters)
{
    const device_data_t *const data = device->data;
    tmini_zephyr_counters(&data->port, counters);
}

/* -------------------------------------------------------------------------- one for each node */

#define DEFINE_DEVICE(instance)                                                                    \
    static K_THREAD_STACK_DEFINE(stack_##instance, CONFIG_TMINI_THREAD_STACK);                     \
    static uint8_t rx_##instance[CONFIG_TMINI_RX_BUFFER];                                          \
    static tmini_point_t points_##instance[2 * CONFIG_TMINI_POINTS];                               \
    static device_data_t data_##instance;                                                          \
    static const device_config_t config_##instance = {                                             \
        .uart = DEVICE_DT_GET(DT_INST_BUS(instance)),                                              \
        .stack = stack_##instance,                                                                 \
        .rx = rx_##instance,                                                                       \
        .points = points_##instance,                                                               \
        .frequency_chz = 100 * DT_INST_PROP_OR(instance, frequency_hz, 0),                         \
    };                                                                                             \
    DEVICE_DT_INST_DEFINE(instance, init, NULL, &data_##instance, &config_##instance, POST_KERNEL, \
                          CONFIG_TMINI_INIT_PRIORITY, NULL);

DT_INST_FOREACH_STATUS_OKAY(DEFINE_DEVICE)
