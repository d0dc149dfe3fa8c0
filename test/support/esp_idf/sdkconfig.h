/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What menuconfig would write, with the defaults of Kconfig for an ESP32-C3. */

#ifndef SDKCONFIG_H
#define SDKCONFIG_H

#define CONFIG_TMINI_ESP32_UART 1
#define CONFIG_TMINI_ESP32_TX_PIN 5
#define CONFIG_TMINI_ESP32_RX_PIN 4
#define CONFIG_TMINI_ESP32_BUFFER_SIZE 2048
#define CONFIG_TMINI_ESP32_QUEUE_LENGTH 32
#define CONFIG_TMINI_ESP32_FIFO_THRESHOLD 64
#define CONFIG_TMINI_ESP32_TIMEOUT_SYMBOLS 4
#define CONFIG_TMINI_ESP32_TASK_STACK 3072
#define CONFIG_TMINI_ESP32_TASK_PRIORITY 12
#define CONFIG_TMINI_ESP32_TASK_CORE -1

/* Of examples/esp32_idf. */
#define CONFIG_EXAMPLE_STOP_GPIO 10

#endif
