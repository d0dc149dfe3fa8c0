/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on a Zephyr board: asks for the lidar's information, scans, and writes a line per
 * second to the console: whether a robot may move. */

#include <stdbool.h>

#include <zephyr/device.h>
#include <zephyr/devicetree.h>
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#include "lidar_log.h"
#include "obstacle.h"
#include "tmini_zephyr_device.h"

#define LOOK_MS 10

static const struct device *const device = DEVICE_DT_GET(DT_NODELABEL(lidar));
static obstacle_t obstacle;

static void print(const char *text)
{
    printk("%s", text);
}

static lidar_log_t console = {.print = print};

/* Runs in the device's thread. */
static void on_event(const struct device *lidar, tmini_event_t event, void *user_data)
{
    (void)user_data;
    lidar_log_event(&console, event);
    if (event == TMINI_EVENT_SCAN) {
        obstacle_see(&obstacle, tmini_scan(tmini_zephyr_device_lidar(lidar)));
    }
}

/* Without a scanning lidar, or with a faulty one, the way ahead is unknown. */
static bool must_stop(const tmini_t *lidar)
{
    if (tmini_state(lidar) != TMINI_STATE_SCANNING || tmini_faults(lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, k_uptime_get_32());
}

static void report_each_second(const tmini_t *lidar)
{
    tmini_zephyr_counters_t uart;
    const bool stop = must_stop(lidar);
    if (lidar_log_is_due(&console, k_uptime_get_32())) {
        tmini_zephyr_device_counters(device, &uart);
        lidar_log_status(&console, obstacle.sectors[0].nearest_mm, stop, uart.bytes, uart.overruns);
    }
}

static void start_lidar(void)
{
    tmini_t *const lidar = tmini_zephyr_device_lock(device);
    console.lidar = lidar;
    (void)tmini_request_info(lidar);
    (void)tmini_start(lidar); /* Begins after the answer, and holds. */
    tmini_zephyr_device_unlock(device);
}

int main(void)
{
    if (!device_is_ready(device)) {
        printk("the lidar cannot be started: is its UART ready?\n");
        return 0;
    }
    tmini_zephyr_device_callback_set(device, on_event, NULL);
    start_lidar();
    for (;;) {
        report_each_second(tmini_zephyr_device_lock(device));
        tmini_zephyr_device_unlock(device);
        (void)k_sleep(K_MSEC(LOOK_MS));
    }
    return 0;
}
