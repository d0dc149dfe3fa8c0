/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* An ESP-IDF that records each call, and fails where the test wants it. */

#ifndef RECORDED_IDF_H
#define RECORDED_IDF_H

#include <stddef.h>
#include <stdint.h>

#include "driver/uart.h"
#include "esp_err.h"
#include "freertos/task.h"
#include "tmini_esp32.h"

/* Two chips that differ in what a port must know of: sdkconfig.h. */
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
    char calls[1024];    /* What has been called, in order. */
    const char *failing; /* The call that fails: how it begins; NULL: none; */
    esp_err_t failure;   /* and with what. */
    char logged[128];    /* The last line. */
    int64_t now_us;
    uint8_t held[4096]; /* What the UART driver holds. */
    size_t held_count;
    uart_event_t events[8];
    size_t event_count;
    size_t queue_length;
    TaskFunction_t task;
    void *task_argument;
    void (*on_wait)(void);  /* At each wait for an event; NULL: nothing happens. */
    void (*on_delay)(void); /* While a task sleeps. */
} recorded_idf_t;

extern recorded_idf_t idf;

void recorded_idf_begin(void);

#endif
