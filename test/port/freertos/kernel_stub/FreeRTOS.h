/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of FreeRTOS that the port and its example use, implemented by ../freertos_model.h.
 * Written for the tests from the kernel's public API documentation. As in FreeRTOS, this header
 * must be included before the others. */

#ifndef INC_FREERTOS_H
#define INC_FREERTOS_H

#include <stddef.h>
#include <stdint.h>

#define configSUPPORT_STATIC_ALLOCATION 1
#define configTASK_NOTIFICATION_ARRAY_ENTRIES 1
#define configMAX_PRIORITIES 4

/* Some tests define other values. */
#ifndef configTICK_RATE_HZ
#define configTICK_RATE_HZ 1000u
#endif
#ifndef TICK_TYPE
#define TICK_TYPE uint32_t
#endif

typedef TICK_TYPE TickType_t;
typedef long BaseType_t;
typedef unsigned long UBaseType_t;
typedef uint32_t StackType_t;

#define pdFALSE ((BaseType_t)0)
#define pdTRUE ((BaseType_t)1)
#define pdPASS pdTRUE
#define pdFAIL pdFALSE
#define portMAX_DELAY ((TickType_t)-1)
#define pdMS_TO_TICKS(ms) ((TickType_t)((uint64_t)(ms)*configTICK_RATE_HZ / 1000u))
#define portYIELD_FROM_ISR(woken) ((void)(woken))

void freertos_model_assert(const char *condition);
#define configASSERT(condition) ((condition) ? (void)0 : freertos_model_assert(#condition))

typedef struct {
    void *kept;
} StaticTask_t;
typedef struct task *TaskHandle_t;
typedef struct freertos_stream {
    uint8_t *memory;
    size_t size;
    size_t count;
} StaticStreamBuffer_t;

#endif
