/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What menuconfig would write with Kconfig's defaults: for an ESP32-C6 (one core, a
 * low-power UART, 100 ticks per second), or with MODEL_ESP32 for an ESP32 (two cores, UARTs clocked
 * by the APB, slower ticks). */

#ifndef SDKCONFIG_H
#define SDKCONFIG_H

#ifdef MODEL_ESP32
#define CONFIG_IDF_TARGET_ESP32 1
#define CONFIG_FREERTOS_HZ 40
#define CONFIG_TMINI_ESP32_TX_PIN 27
#define CONFIG_TMINI_ESP32_RX_PIN 26
#else
#define CONFIG_IDF_TARGET_ESP32C6 1
#define CONFIG_FREERTOS_UNICORE 1
#define CONFIG_FREERTOS_HZ 100
#define CONFIG_TMINI_ESP32_TX_PIN 19
#define CONFIG_TMINI_ESP32_RX_PIN 18
#endif

#define CONFIG_TMINI_ESP32_UART 1
#define CONFIG_TMINI_ESP32_BUFFER_SIZE 2048
#define CONFIG_TMINI_ESP32_QUEUE_LENGTH 64
#define CONFIG_TMINI_ESP32_FIFO_THRESHOLD 64
#define CONFIG_TMINI_ESP32_TIMEOUT_SYMBOLS 4
#define CONFIG_TMINI_ESP32_TASK_STACK 3072
#define CONFIG_TMINI_ESP32_TASK_PRIORITY 12
#define CONFIG_TMINI_ESP32_TASK_CORE -1

/* Options of examples/bridge. */
#define CONFIG_BRIDGE_HOSTNAME "lidar"
#define CONFIG_BRIDGE_TCP_PORT 8090
#define CONFIG_BRIDGE_FREQUENCY_CHZ 1000

/* Option of examples/esp32_idf. */
#define CONFIG_EXAMPLE_STOP_GPIO 10

#endif
