/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The bridge on an ESP32: the lidar on a UART, listeners in the Wi-Fi. One task receives, runs the
 * driver and feeds the network, which never makes it wait. */

#include "bridge.h"
#include "esp_log.h"
#include "esp_timer.h"
#include "sdkconfig.h"
#include "tcp.h"
#include "tmini/tmini_names.h"
#include "tmini_esp32.h"
#include "web.h"
#include "wifi.h"

static const char *const TAG = "bridge";

static uint8_t rx[1024];
static tmini_t lidar;
static tmini_esp32_t port;
static bridge_t bridge;
static tcp_server_t tcp;

static uint64_t now_us(void)
{
    return (uint64_t)esp_timer_get_time();
}

static void pass(void *context, const uint8_t *bytes, size_t count)
{
    bridge_pass(context, now_us(), bytes, count);
}

static void report(tmini_event_t event)
{
    if (event == TMINI_EVENT_COMMAND_FAILED) {
        ESP_LOGE(TAG, "no answer: %s. Wiring, 5 V?",
                 tmini_status_name(tmini_command_error(&lidar)));
    } else if (event != TMINI_EVENT_PACKET && event != TMINI_EVENT_MORE) {
        ESP_LOGI(TAG, "%s", tmini_event_name(event));
    }
}

static bool set_up(void)
{
    tmini_esp32_wiring_t wiring = TMINI_ESP32_WIRING_DEFAULT;
    const tmini_config_t config = {
        .port = &tmini_esp32_port,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
        .frequency_chz = CONFIG_BRIDGE_FREQUENCY_CHZ,
    };
    wiring.with_task = false; /* So that the tap is called by this task. */
    ESP_ERROR_CHECK(tmini_esp32_init(&port, &wiring));
    tmini_esp32_tap(&port, pass, &bridge);
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        ESP_LOGE(TAG, "the frequency is wrong");
        return false;
    }
    ESP_ERROR_CHECK(tmini_esp32_start(&port, &lidar));
    return true;
}

static void open_network(void)
{
    wifi_begin();
    ESP_ERROR_CHECK(web_begin());
    tcp_server_init(&tcp, &bridge);
    if (tcp_server_listen(&tcp, CONFIG_BRIDGE_TCP_PORT, true) == 0) {
        ESP_LOGE(TAG, "no socket for TCP");
    }
}

static void follow_wish(void)
{
    static bool is_wanted;
    if (bridge_is_wanted(&bridge, now_us()) != is_wanted) {
        is_wanted = !is_wanted;
        (void)(is_wanted ? tmini_start : tmini_stop)(&lidar);
    }
}

void app_main(void)
{
    open_network();
    if (!set_up()) {
        return;
    }
    (void)tmini_stop(&lidar); /* It may have been left scanning. */
    for (;;) {
        for (tmini_event_t event; (event = tmini_poll(&lidar)) != TMINI_EVENT_NONE;) {
            report(event);
        }
        tcp_server_serve(&tcp, now_us());
        web_serve(&bridge, now_us());
        follow_wish();
        (void)tmini_esp32_wait(&port, pdMS_TO_TICKS(5));
    }
}
