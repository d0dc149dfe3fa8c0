/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* FreeRTOS as in ESP-IDF: types and the length of a tick. */

#ifndef INC_FREERTOS_H
#define INC_FREERTOS_H

#include <stdint.h>

#include "sdkconfig.h"

typedef int BaseType_t;
typedef unsigned int UBaseType_t;
typedef uint32_t TickType_t;

#define pdFALSE 0
#define pdTRUE 1
#define pdPASS 1
#define pdFAIL 0

#define configMAX_PRIORITIES (25)

/* Rounds down. */
#define pdMS_TO_TICKS(ms) ((TickType_t)((ms)*CONFIG_FREERTOS_HZ / 1000))

#endif
