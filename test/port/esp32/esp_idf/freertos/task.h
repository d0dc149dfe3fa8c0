/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* FreeRTOS: tasks. */

#ifndef TASK_H
#define TASK_H

/* As in FreeRTOS. */
#ifndef INC_FREERTOS_H
#error "include FreeRTOS.h must appear in source files before include task.h"
#endif

typedef void (*TaskFunction_t)(void *);
typedef struct tskTaskControlBlock *TaskHandle_t;

#define tskNO_AFFINITY ((BaseType_t)0x7FFFFFFF)

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t function, const char *name, uint32_t stack_depth,
                                   void *argument, UBaseType_t priority, TaskHandle_t *task,
                                   BaseType_t core);
void vTaskDelete(TaskHandle_t task);
void vTaskDelay(TickType_t ticks);

#endif
