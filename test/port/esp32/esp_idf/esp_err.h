/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* ESP-IDF: error codes. */

#ifndef ESP_ERR_H
#define ESP_ERR_H

typedef int esp_err_t;

#define ESP_OK 0
#define ESP_FAIL (-1)
#define ESP_ERR_NO_MEM 0x101
#define ESP_ERR_INVALID_ARG 0x102
#define ESP_ERR_INVALID_STATE 0x103
#define ESP_ERR_NOT_FOUND 0x105
#define ESP_ERR_NOT_SUPPORTED 0x106

/* The real macro prints the source line and restarts the chip. */
void esp_stop(esp_err_t error);
#define ESP_ERROR_CHECK(call)         \
    do {                              \
        const esp_err_t error = call; \
        if (error != ESP_OK) {        \
            esp_stop(error);          \
        }                             \
    } while (0)

#endif
