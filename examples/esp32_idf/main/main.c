/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on an ESP32: asks the lidar who and how it is, scans, raises a pin while something in
 * front is too near, and writes a line a second to the console. */

#include <inttypes.h>

#include "driver/gpio.h"
#include "esp_log.h"
#include "freertos/FreeRTOS.h"
#include "freertos/task.h"

#include "tmini_esp32.h"

#define FRONT_Q6 1920u /* 30 degrees to either side of 0, in 1/64 degree. */
#define BLIND_MS 500u  /* Without a scan for so long, stop. */
#define REPORT_MS 1000u

static const char *const TAG = "lidar";

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_esp32_t board;

static uint16_t nearest_mm; /* In front, in the last scan; 0: nothing. */
static uint32_t seen_ms;    /* When that was. */
static bool seen;
static uint32_t scans; /* Since the last line on the console. */

static uint32_t now_ms(void)
{
    return tmini_esp32_port.now_ms(&board);
}

/* ---------------------------------------------------------------------------------- obstacle stop */

static bool is_in_front(const tmini_point_t *point)
{
    return point->angle_q6 <= FRONT_Q6 || point->angle_q6 >= TMINI_TURN_Q6 - FRONT_Q6;
}

static uint16_t nearest_in_front(const tmini_scan_t *scan)
{
    uint16_t nearest = 0;
    for (unsigned i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        if (point->distance_mm != 0 && is_in_front(point) &&
            (nearest == 0 || point->distance_mm < nearest)) {
            nearest = point->distance_mm;
        }
    }
    return nearest;
}

/* A robot that sees nothing must not move either. */
static bool must_stop(void)
{
    const bool blind = !seen || now_ms() - seen_ms > BLIND_MS || tmini_faults(&lidar) != 0;
    return blind || (nearest_mm != 0 && nearest_mm < CONFIG_EXAMPLE_STOP_MM);
}

static void open_stop_pin(void)
{
    if (CONFIG_EXAMPLE_STOP_GPIO >= 0) {
        ESP_ERROR_CHECK(gpio_set_direction(CONFIG_EXAMPLE_STOP_GPIO, GPIO_MODE_OUTPUT));
    }
}

static void set_stop_pin(bool stop)
{
    if (CONFIG_EXAMPLE_STOP_GPIO >= 0) {
        (void)gpio_set_level(CONFIG_EXAMPLE_STOP_GPIO, stop ? 1 : 0);
    }
}

/* ----------------------------------------------------------------------------------------- events */

static void see(const tmini_scan_t *scan)
{
    nearest_mm = nearest_in_front(scan);
    seen_ms = now_ms();
    seen = true;
    scans++;
}

static void tell_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    ESP_LOGI(TAG, "model %u, firmware %u.%u, hardware %u, serial %s", info->model,
             info->firmware_major, info->firmware_minor, info->hardware, serial);
}

/* Information, then health, then scanning; from the beginning when something fails. */
static void handle(tmini_event_t event)
{
    switch (event) {
    case TMINI_EVENT_INFO:
        tell_info(tmini_info(&lidar));
        (void)tmini_request_health(&lidar);
        break;
    case TMINI_EVENT_HEALTH:
        ESP_LOGI(TAG, "health: faults 0x%02x", tmini_health(&lidar)->faults);
        (void)tmini_start(&lidar);
        break;
    case TMINI_EVENT_SCAN:
        see(tmini_scan(&lidar));
        break;
    case TMINI_EVENT_FAULT:
        ESP_LOGW(TAG, "faults 0x%02x", tmini_faults(&lidar));
        break;
    case TMINI_EVENT_LOST:
        ESP_LOGW(TAG, "lost; trying to get it back");
        break;
    case TMINI_EVENT_RECOVERED:
        ESP_LOGI(TAG, "back again");
        break;
    case TMINI_EVENT_FAILED:
        ESP_LOGE(TAG, "no answer: %s. Wiring, 5 V?", tmini_status_name(tmini_failure(&lidar)));
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
    tmini_esp32_counters_t uart;
    if (now_ms() - reported_ms < REPORT_MS) {
        return;
    }
    reported_ms = now_ms();
    tmini_counters(&lidar, &counters);
    tmini_esp32_counters(&board, &uart);
    ESP_LOGI(TAG,
             "%" PRIu32 " scans, nearest in front %u mm, %s; lost: %" PRIu32 " checksums, %" PRIu32
             " bytes, %" PRIu32 " overflows",
             scans, nearest_mm, must_stop() ? "STOP" : "go", counters.parser.checksum_errors,
             counters.parser.bytes_overrun, uart.fifo_overflows);
    scans = 0;
}

static void set_up(void)
{
    const tmini_config_t config = {
        .port = &tmini_esp32_port,
        .port_context = &board,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
    };
    const tmini_esp32_config_t wiring = TMINI_ESP32_CONFIG_DEFAULT;
    open_stop_pin();
    set_stop_pin(true);
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        ESP_LOGE(TAG, "the configuration is wrong");
        return;
    }
    ESP_ERROR_CHECK(tmini_esp32_open(&board, &wiring, &lidar));
    (void)tmini_request_info(&lidar);
}

void app_main(void)
{
    set_up();
    for (;;) {
        const tmini_event_t event = tmini_poll(&lidar);
        handle(event);
        if (event == TMINI_EVENT_NONE) {
            set_stop_pin(must_stop());
            report_each_second();
            vTaskDelay(1);
        }
    }
}
