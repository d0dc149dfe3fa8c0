/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on a Raspberry Pi Pico: asks for the lidar's information, scans, raises a pin while
 * the robot must not move, and writes a line per second to the console. */

#include <stdio.h>

#include "hardware/gpio.h"
#include "pico/stdlib.h"

#include "lidar_log.h"
#include "obstacle.h"
#include "tmini/tmini_names.h"
#include "tmini_pico.h"

#define LIDAR_UART uart1
#define LIDAR_TX_PIN 4 /* To the lidar's RX. */
#define LIDAR_RX_PIN 5 /* To the lidar's TX. */
#define STOP_PIN 15
#define REPORT_MS 1000u

#if LIDAR_BY_INTERRUPT
#define RING NULL
#define RING_SIZE 0
#else
TMINI_PICO_RING(ring, 1024);
#define RING ring
#define RING_SIZE sizeof ring
#endif

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_pico_t port;
static obstacle_t obstacle;

static void print(const char *text)
{
    printf("%s", text);
}

static lidar_log_t console = {.lidar = &lidar, .print = print};

static uint32_t now_ms(void)
{
    return tmini_pico_port.now_ms(&port);
}

/* Without a scanning lidar, or with a faulty one, the way ahead is unknown. */
static bool must_stop(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, now_ms());
}

static void report_each_second(void)
{
    tmini_pico_counters_t uart;
    if (lidar_log_is_due(&console, now_ms())) {
        tmini_pico_counters(&port, &uart);
        lidar_log_status(&console, obstacle.sectors[0].nearest_mm, must_stop(), uart.bytes,
                         uart.bytes_lost + uart.overruns);
    }
}

static tmini_status_t start_lidar(void)
{
    const tmini_pico_wiring_t wiring = {
        .uart = LIDAR_UART,
        .tx_pin = LIDAR_TX_PIN,
        .rx_pin = LIDAR_RX_PIN,
        .ring = RING,
        .ring_size = RING_SIZE,
    };
    const tmini_config_t config = {
        .port = &tmini_pico_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
    };
    tmini_status_t status = tmini_pico_init(&port, &wiring);
    if (status == TMINI_OK) {
        status = tmini_init(&lidar, &config);
    }
    if (status == TMINI_OK) {
        status = tmini_pico_start(&port, &lidar);
    }
    if (status == TMINI_OK) {
        (void)tmini_request_info(&lidar);
        (void)tmini_start(&lidar); /* Begins after the answer, and holds. */
    }
    return status;
}

int main(void)
{
    stdio_init_all();
    gpio_init(STOP_PIN);
    gpio_put(STOP_PIN, true); /* Set before the pin is an output, because low means go. */
    gpio_set_dir(STOP_PIN, GPIO_OUT);
    const tmini_status_t status = start_lidar();
    for (;;) {
        if (status != TMINI_OK) {
            printf("the lidar cannot be started: %s\n", tmini_status_name(status));
            sleep_ms(REPORT_MS);
            continue;
        }
        (void)tmini_pico_wait(&port, 1);
        for (tmini_event_t event; (event = tmini_poll(&lidar)) != TMINI_EVENT_NONE;) {
            lidar_log_event(&console, event);
            if (event == TMINI_EVENT_SCAN) {
                obstacle_see(&obstacle, tmini_scan(&lidar));
            }
        }
        gpio_put(STOP_PIN, must_stop());
        report_each_second();
    }
}
