/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The kernel's stream buffers. */

#ifndef STREAM_BUFFER_H
#define STREAM_BUFFER_H

#ifndef INC_FREERTOS_H
#error "include FreeRTOS.h must appear in source files before include stream_buffer.h"
#endif

typedef struct freertos_stream *StreamBufferHandle_t;
StreamBufferHandle_t xStreamBufferCreateStatic(size_t size, size_t trigger, uint8_t *storage,
                                               StaticStreamBuffer_t *memory);
size_t xStreamBufferSendFromISR(StreamBufferHandle_t stream, const void *bytes, size_t count,
                                BaseType_t *woken);
size_t xStreamBufferReceive(StreamBufferHandle_t stream, void *bytes, size_t size,
                            TickType_t ticks);
BaseType_t xStreamBufferIsEmpty(StreamBufferHandle_t stream);
size_t xStreamBufferBytesAvailable(StreamBufferHandle_t stream);
BaseType_t xStreamBufferReset(StreamBufferHandle_t stream);

#endif
