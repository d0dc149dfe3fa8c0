/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* FreeRTOS as in ESP-IDF: types and the length of a tick. */

#ifndef FREERTOS_H
#define FREERTOS_H

#include <stdint.h>

typedef int BaseType_t;
typedef unsigned int UBaseType_t;
typedef uint32_t TickType_t;

#define pdFALSE 0
#define pdTRUE 1
#define pdPASS 1
#define pdFAIL 0

/* ESP-IDF's default: 100 ticks a second. */
#define pdMS_TO_TICKS(ms) ((TickType_t)((ms) / 10))

#endif
