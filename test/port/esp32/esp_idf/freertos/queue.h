/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* FreeRTOS: queues. */

#ifndef QUEUE_H
#define QUEUE_H

/* As in FreeRTOS. */
#ifndef INC_FREERTOS_H
#error "include FreeRTOS.h must appear in source files before include queue.h"
#endif

typedef struct QueueDefinition *QueueHandle_t;

BaseType_t xQueueReceive(QueueHandle_t queue, void *buffer, TickType_t ticks);
UBaseType_t uxQueueSpacesAvailable(const QueueHandle_t queue);

#endif
