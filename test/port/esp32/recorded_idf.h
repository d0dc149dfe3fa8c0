/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* An ESP-IDF that records each call, and fails in the call that a test chooses. */

#ifndef RECORDED_IDF_H
#define RECORDED_IDF_H

#include <stddef.h>
#include <stdint.h>

#include "driver/uart.h"
#include "esp_err.h"
#include "freertos/task.h"
#include "tmini_esp32.h"

/* sdkconfig.h chooses one of two chips, which differ in these ways. */
#ifdef CONFIG_IDF_TARGET_ESP32
#define CORES 2
#define STEADY_CLOCK UART_SCLK_APB
#define STEADY_LOCK ESP_PM_APB_FREQ_MAX
#else
#define CORES 1
#define STEADY_CLOCK UART_SCLK_XTAL
#define STEADY_LOCK ESP_PM_NO_LIGHT_SLEEP
#endif

typedef struct {
    char calls[1024];    /* All calls so far, in order. */
    const char *failing; /* Calls whose record begins with this text fail; NULL: none. */
    esp_err_t failure;   /* The result of a call that fails. */
    char logged[128];    /* The last log line. */
    int64_t now_us;
    uint8_t held[4096]; /* Bytes in the UART driver. */
    size_t held_count;
    uart_event_t events[8];
    size_t event_count;
    size_t queue_length;
    TaskFunction_t task;
    void *task_argument;
    void (*on_wait)(void);  /* Called at each wait for an event; may be NULL. */
    void (*on_delay)(void); /* Called while a task sleeps; may be NULL. */
} recorded_idf_t;

extern recorded_idf_t idf;

void recorded_idf_begin(void);

#endif
