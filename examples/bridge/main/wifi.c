/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "wifi.h"

#include <string.h>

#include "esp_event.h"
#include "esp_log.h"
#include "esp_netif.h"
#include "esp_wifi.h"
#include "nvs_flash.h"
#include "sdkconfig.h"

static const char *const TAG = "wifi";

static void on_wifi(void *argument, esp_event_base_t base, int32_t event, void *data)
{
    (void)argument, (void)base, (void)data;
    if (event == WIFI_EVENT_STA_START || event == WIFI_EVENT_STA_DISCONNECTED) {
        (void)esp_wifi_connect(); /* If it fails, another event follows. */
    }
}

static void on_address(void *argument, esp_event_base_t base, int32_t event, void *data)
{
    const ip_event_got_ip_t *const got = data;
    (void)argument, (void)base, (void)event;
    ESP_LOGI(TAG, "http://" IPSTR "  tcp:" IPSTR ":%d", IP2STR(&got->ip_info.ip),
             IP2STR(&got->ip_info.ip), CONFIG_BRIDGE_TCP_PORT);
}

/* The Wi-Fi driver keeps calibration data there. */
static void open_storage(void)
{
    const esp_err_t error = nvs_flash_init();
    if (error == ESP_ERR_NVS_NO_FREE_PAGES || error == ESP_ERR_NVS_NEW_VERSION_FOUND) {
        ESP_ERROR_CHECK(nvs_flash_erase());
        ESP_ERROR_CHECK(nvs_flash_init());
    } else {
        ESP_ERROR_CHECK(error);
    }
}

void wifi_begin(void)
{
    const wifi_init_config_t defaults = WIFI_INIT_CONFIG_DEFAULT();
    wifi_config_t config = {0};
    memcpy(config.sta.ssid, CONFIG_BRIDGE_WIFI_SSID,
           strnlen(CONFIG_BRIDGE_WIFI_SSID, sizeof config.sta.ssid));
    memcpy(config.sta.password, CONFIG_BRIDGE_WIFI_PASSWORD,
           strnlen(CONFIG_BRIDGE_WIFI_PASSWORD, sizeof config.sta.password));
    open_storage();
    ESP_ERROR_CHECK(esp_netif_init());
    ESP_ERROR_CHECK(esp_event_loop_create_default());
    ESP_ERROR_CHECK(
        esp_netif_set_hostname(esp_netif_create_default_wifi_sta(), CONFIG_BRIDGE_HOSTNAME));
    ESP_ERROR_CHECK(esp_wifi_init(&defaults));
    ESP_ERROR_CHECK(esp_event_handler_register(WIFI_EVENT, ESP_EVENT_ANY_ID, on_wifi, NULL));
    ESP_ERROR_CHECK(esp_event_handler_register(IP_EVENT, IP_EVENT_STA_GOT_IP, on_address, NULL));
    ESP_ERROR_CHECK(esp_wifi_set_mode(WIFI_MODE_STA));
    ESP_ERROR_CHECK(esp_wifi_set_config(WIFI_IF_STA, &config));
    ESP_ERROR_CHECK(esp_wifi_set_ps(WIFI_PS_NONE)); /* Saving power delays bytes. */
    ESP_ERROR_CHECK(esp_wifi_start());
}
