/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on a Zephyr board: asks the lidar who it is, scans, and writes a line a second to
 * the console that says whether a robot may move. */

#include <stdbool.h>

#include <zephyr/device.h>
#include <zephyr/devicetree.h>
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#include "obstacle.h"
#include "tmini/tmini_names.h"
#include "tmini_zephyr.h"

#define LIDAR_UART DEVICE_DT_GET(DT_BUS(DT_NODELABEL(lidar)))
#define REPORT_MS 1000u

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_zephyr_t board;
static obstacle_t obstacle;
static uint32_t gaps;

/* Without a scanning lidar, or with a faulty one, nothing can be known of what is in front. */
static bool must_stop(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, k_uptime_get_32());
}

static void tell_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    printk("model %u, firmware %u.%u, hardware %u, serial %s\n", info->model, info->firmware_major,
           info->firmware_minor, info->hardware, serial);
}

static void tell_faults(uint8_t faults)
{
    char text[TMINI_FAULTS_TEXT_SIZE];
    printk("faults: %s\n", tmini_faults_text(faults, text, sizeof text));
}

static void see(const tmini_scan_t *scan)
{
    obstacle_see(&obstacle, scan, k_uptime_get_32());
    gaps += scan->gaps;
}

/* Information, then scanning; from the beginning when something fails. */
static void handle(tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_INFO:
        tell_info(tmini_info(&lidar));
        (void)tmini_start(&lidar);
        break;
    case TMINI_EVENT_SCAN:
        see(tmini_scan(&lidar));
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        tell_faults(tmini_faults(&lidar));
        break;
    case TMINI_EVENT_LOST:
        printk("lost; trying to get it back\n");
        break;
    case TMINI_EVENT_RECOVERED:
        printk("back again\n");
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        printk("no answer: %s. Wiring, 5 V?\n", tmini_status_name(tmini_command_error(&lidar)));
        (void)tmini_request_info(&lidar);
        break;
    default:
        break;
    }
}

static void report_each_second(void)
{
    static uint32_t reported_ms;
    tmini_counters_t counters;
    tmini_zephyr_counters_t uart;
    if (k_uptime_get_32() - reported_ms < REPORT_MS) {
        return;
    }
    reported_ms += REPORT_MS;
    tmini_counters(&lidar, &counters);
    tmini_zephyr_counters(&board, &uart);
    printk(
        "%u scans, nearest in front %u mm, %s; bytes %u, lost: %u checksums, %u bytes, %u gaps\n",
        (unsigned)counters.scans, obstacle.sectors[0].nearest_mm, must_stop() ? "STOP" : "go",
        (unsigned)uart.bytes, (unsigned)counters.checksum_errors,
        (unsigned)(counters.bytes_overrun + uart.overruns), (unsigned)gaps);
}

static bool start_lidar(void)
{
    const tmini_config_t config = {
        .port = &tmini_zephyr_port,
        .port_context = &board,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
    };
    return tmini_zephyr_init(&board, LIDAR_UART) == 0 && tmini_init(&lidar, &config) == TMINI_OK &&
           tmini_zephyr_start(&board, &lidar) == 0 && tmini_request_info(&lidar) == TMINI_OK;
}

int main(void)
{
    if (!start_lidar()) {
        printk("the lidar cannot be started: is its UART ready?\n");
        return 0;
    }
    for (;;) {
        const tmini_event_t event = tmini_poll(&lidar);
        handle(event);
        if (event == TMINI_EVENT_NONE) {
            report_each_second();
            tmini_zephyr_wait(&board, K_MSEC(10));
        }
    }
    return 0;
}
