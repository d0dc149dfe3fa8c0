/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* FreeRTOS: queues. */

#ifndef QUEUE_H
#define QUEUE_H

#include "freertos/FreeRTOS.h"

typedef struct QueueDefinition *QueueHandle_t;

BaseType_t xQueueReceive(QueueHandle_t queue, void *buffer, TickType_t ticks);
UBaseType_t uxQueueSpacesAvailable(const QueueHandle_t queue);

#endif
