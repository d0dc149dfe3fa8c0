/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on a Raspberry Pi Pico: asks the lidar who it is, scans, raises a pin while the
 * robot must not move, and writes a line a second to the console. */

#include <stdio.h>

#include "hardware/gpio.h"
#include "pico/stdlib.h"

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
static tmini_pico_t board;
static obstacle_t obstacle;
static uint32_t gaps;

static uint32_t now_ms(void)
{
    return to_ms_since_boot(get_absolute_time());
}

/* Without a scanning lidar, or with a faulty one, nothing can be known of what is in front. */
static bool must_stop(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, now_ms());
}

static void tell_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    printf("model %u, firmware %u.%u, hardware %u, serial %s\n", info->model, info->firmware_major,
           info->firmware_minor, info->hardware, serial);
}

static void tell_faults(uint8_t faults)
{
    char text[TMINI_FAULTS_TEXT_SIZE];
    printf("faults: %s\n", tmini_faults_text(faults, text, sizeof text));
}

static void see(const tmini_scan_t *scan)
{
    obstacle_see(&obstacle, scan, now_ms());
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
        printf("lost; trying to get it back\n");
        break;
    case TMINI_EVENT_RECOVERED:
        printf("back again\n");
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        printf("no answer: %s. Wiring, 5 V?\n", tmini_status_name(tmini_command_error(&lidar)));
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
    tmini_pico_counters_t uart;
    if (now_ms() - reported_ms < REPORT_MS) {
        return;
    }
    reported_ms += REPORT_MS;
    tmini_counters(&lidar, &counters);
    tmini_pico_counters(&board, &uart);
    const uint32_t lost = counters.bytes_overrun + uart.bytes_lost + uart.overruns;
    printf("%lu scans, nearest in front %u mm, %s; bytes %lu, lost: %lu checksums, %lu bytes, "
           "%lu gaps\n",
           (unsigned long)counters.scans, obstacle.sectors[0].nearest_mm,
           must_stop() ? "STOP" : "go", (unsigned long)uart.bytes,
           (unsigned long)counters.checksum_errors, (unsigned long)lost, (unsigned long)gaps);
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
        .port_context = &board,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
    };
    tmini_status_t status = tmini_pico_init(&board, &wiring);
    if (status == TMINI_OK) {
        status = tmini_init(&lidar, &config);
    }
    if (status == TMINI_OK) {
        status = tmini_pico_start(&board, &lidar);
    }
    if (status == TMINI_OK) {
        status = tmini_request_info(&lidar);
    }
    return status;
}

int main(void)
{
    stdio_init_all();
    gpio_init(STOP_PIN);
    gpio_put(STOP_PIN, true); /* Before it is an output: low means go. */
    gpio_set_dir(STOP_PIN, GPIO_OUT);
    const tmini_status_t status = start_lidar();
    for (;;) {
        if (status != TMINI_OK) {
            printf("the lidar cannot be started: %s\n", tmini_status_name(status));
            sleep_ms(REPORT_MS);
            continue;
        }
        (void)tmini_pico_receive(&board);
        for (tmini_event_t event; (event = tmini_poll(&lidar)) != TMINI_EVENT_NONE;) {
            handle(event);
        }
        gpio_put(STOP_PIN, must_stop());
        report_each_second();
        sleep_ms(1);
    }
}
