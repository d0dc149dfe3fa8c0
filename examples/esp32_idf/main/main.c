/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacle stop on an ESP32: asks for the lidar's information and health, scans, raises a pin while
 * the robot must not move, and writes a line per second to the console. */

#include <inttypes.h>

#include "driver/gpio.h"
#include "esp_log.h"

#include "obstacle.h"
#include "tmini/tmini_names.h"
#include "tmini_esp32.h"

#define REPORT_MS 1000u

static const char *const TAG = "lidar";

static uint8_t rx[1024];
static tmini_point_t points[TMINI_SCAN_POINTS_TYPICAL];
static tmini_t lidar;
static tmini_esp32_t port;

static obstacle_t obstacle;
static uint32_t scans; /* Since the last line on the console. */

static uint32_t now_ms(void)
{
    return tmini_esp32_port.now_ms(&port);
}

/* -------------------------------------------------------------------------------- obstacle stop */

/* Without a scanning lidar, or with a faulty one, the way ahead is unknown. */
static bool must_stop(void)
{
    if (tmini_state(&lidar) != TMINI_STATE_SCANNING || tmini_faults(&lidar) != 0) {
        obstacle_blind(&obstacle);
    }
    return !obstacle_may_move(&obstacle, now_ms());
}

static void set_stop_pin(bool stop)
{
    if (CONFIG_EXAMPLE_STOP_GPIO >= 0) {
        (void)gpio_set_level(CONFIG_EXAMPLE_STOP_GPIO, stop ? 1 : 0);
    }
}

/* Resets the pin, because some pins belong to JTAG at first. Sets the level before the direction,
 * because even a short low level would mean "go". */
static void open_stop_pin(void)
{
    if (CONFIG_EXAMPLE_STOP_GPIO >= 0) {
        ESP_ERROR_CHECK(gpio_reset_pin(CONFIG_EXAMPLE_STOP_GPIO));
        set_stop_pin(true);
        ESP_ERROR_CHECK(gpio_set_direction(CONFIG_EXAMPLE_STOP_GPIO, GPIO_MODE_OUTPUT));
    }
}

/* --------------------------------------------------------------------------------------- events */

static void see(const tmini_scan_t *scan)
{
    obstacle_see(&obstacle, scan);
    scans++;
}

static void tell_info(const tmini_info_t *info)
{
    char serial[TMINI_SERIAL_DIGITS + 1];
    tmini_serial_text(info, serial);
    ESP_LOGI(TAG, "model %u, firmware %u.%u, hardware %u, serial %s", info->model,
             info->firmware_major, info->firmware_minor, info->hardware, serial);
}

/* Asks for information, then for health; then starts scanning, also without an answer. */
static void handle(tmini_event_t event)
{
    char faults[TMINI_FAULTS_TEXT_SIZE];
    switch (event) {
    case TMINI_EVENT_INFO:
        tell_info(tmini_info(&lidar));
        (void)tmini_request_health(&lidar);
        break;
    case TMINI_EVENT_HEALTH:
        ESP_LOGI(TAG, "health: faults: %s",
                 tmini_faults_text(tmini_health(&lidar)->faults, faults, sizeof faults));
        (void)tmini_start(&lidar);
        break;
    case TMINI_EVENT_SCAN:
        see(tmini_scan(&lidar));
        break;
    case TMINI_EVENT_FAULTS_CHANGED:
        ESP_LOGW(TAG, "faults: %s", tmini_faults_text(tmini_faults(&lidar), faults, sizeof faults));
        break;
    case TMINI_EVENT_PAUSED:
        ESP_LOGW(TAG, "paused, to set the frequency");
        break;
    case TMINI_EVENT_LOST:
        ESP_LOGW(TAG, "lost; trying to get it back");
        break;
    case TMINI_EVENT_RECOVERED:
        ESP_LOGI(TAG, "back again");
        break;
    case TMINI_EVENT_COMMAND_FAILED:
        ESP_LOGE(TAG, "no answer: %s. Wiring, 5 V?",
                 tmini_status_name(tmini_command_error(&lidar)));
        (void)tmini_start(&lidar);
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
    tmini_esp32_counters(&port, &uart);
    ESP_LOGI(TAG,
             "%" PRIu32 " scans, nearest in front %u mm, %s; lost: %" PRIu32 " checksums, %" PRIu32
             " bytes, %" PRIu32 " overflows",
             scans, obstacle.sectors[0].nearest_mm, must_stop() ? "STOP" : "go",
             counters.checksum_errors, counters.bytes_overrun, uart.overruns);
    scans = 0;
}

static void set_up(void)
{
    const tmini_config_t config = {
        .port = &tmini_esp32_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .points = points,
        .max_points = TMINI_SCAN_POINTS_TYPICAL,
        .frequency_chz = 1000, /* 10 Hz, also after a power failure. */
    };
    const tmini_esp32_wiring_t wiring = TMINI_ESP32_WIRING_DEFAULT;
    open_stop_pin();
    ESP_ERROR_CHECK(tmini_esp32_init(&port, &wiring));
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        ESP_LOGE(TAG, "the configuration is wrong");
        return;
    }
    ESP_ERROR_CHECK(tmini_esp32_start(&port, &lidar));
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
            (void)tmini_esp32_wait(&port, pdMS_TO_TICKS(10));
        }
    }
}
