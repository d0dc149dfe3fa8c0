/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "recorded_idf.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "driver/gpio.h"
#include "esp_log.h"
#include "esp_timer.h"

recorded_idf_t idf;

void recorded_idf_begin(void)
{
    memset(&idf, 0, sizeof idf);
    idf.queue_length = 64;
}

static esp_err_t call(const char *format, ...)
{
    char text[64];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)strcat(strcat(idf.calls, text), " ");
    return idf.failing != NULL && strncmp(text, idf.failing, strlen(idf.failing)) == 0 ? idf.failure
                                                                                       : ESP_OK;
}

/* A function of ESP-IDF that does nothing else. */
#define RECORD(function, parameters, ...) \
    esp_err_t function parameters         \
    {                                     \
        return call(__VA_ARGS__);         \
    }

void esp_log_line(char level, const char *tag, const char *format, ...)
{
    char text[96];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)snprintf(idf.logged, sizeof idf.logged, "%c %s: %s", level, tag, text);
}

int64_t esp_timer_get_time(void)
{
    return idf.now_us;
}

esp_err_t esp_pm_lock_create(esp_pm_lock_type_t type, int arg, const char *name,
                             esp_pm_lock_handle_t *lock)
{
    TEST_ASSERT_EQUAL(STEADY_LOCK, type);
    TEST_ASSERT_EQUAL(0, arg);
    TEST_ASSERT_EQUAL_STRING("tmini", name);
    const esp_err_t error = call("create");
    *lock = error == ESP_OK ? (esp_pm_lock_handle_t)(void *)idf.calls : NULL;
    return error;
}

esp_err_t esp_pm_lock_acquire(esp_pm_lock_handle_t lock)
{
    TEST_ASSERT_EQUAL_PTR(idf.calls, lock);
    return call("acquire");
}

esp_err_t esp_pm_lock_release(esp_pm_lock_handle_t lock)
{
    TEST_ASSERT_EQUAL_PTR(idf.calls, lock);
    return call("release");
}

esp_err_t esp_pm_lock_delete(esp_pm_lock_handle_t lock)
{
    TEST_ASSERT_EQUAL_PTR(idf.calls, lock);
    return call("forget");
}

esp_err_t uart_driver_install(uart_port_t uart, int rx_buffer_size, int tx_buffer_size,
                              int queue_size, QueueHandle_t *queue, int intr_alloc_flags)
{
    *queue = (QueueHandle_t)(void *)idf.events;
    return call("install(%d,%d,%d,%d,%d)", uart, rx_buffer_size, tx_buffer_size, queue_size,
                intr_alloc_flags);
}

RECORD(uart_driver_delete, (uart_port_t uart), "remove(%d)", uart)

esp_err_t uart_param_config(uart_port_t uart, const uart_config_t *config)
{
    TEST_ASSERT_EQUAL(UART_DATA_8_BITS, config->data_bits);
    TEST_ASSERT_EQUAL(UART_PARITY_DISABLE, config->parity);
    TEST_ASSERT_EQUAL(UART_STOP_BITS_1, config->stop_bits);
    TEST_ASSERT_EQUAL(UART_HW_FLOWCTRL_DISABLE, config->flow_ctrl);
    TEST_ASSERT_EQUAL(STEADY_CLOCK, config->source_clk);
    return call("line(%d,%d)", uart, config->baud_rate);
}

esp_err_t uart_set_pin(uart_port_t uart, int tx, int rx, int rts, int cts)
{
    TEST_ASSERT_EQUAL(UART_PIN_NO_CHANGE, rts);
    TEST_ASSERT_EQUAL(UART_PIN_NO_CHANGE, cts);
    return call("pins(%d,%d,%d)", uart, tx, rx);
}

RECORD(gpio_reset_pin, (gpio_num_t pin), "reset(%d)", pin)
RECORD(gpio_pullup_en, (gpio_num_t pin), "pull-up(%d)", pin)
RECORD(uart_set_rx_full_threshold, (uart_port_t uart, int threshold), "threshold(%d,%d)", uart,
       threshold)
RECORD(uart_set_rx_timeout, (uart_port_t uart, const uint8_t symbols), "timeout(%d,%d)", uart,
       symbols)
RECORD(uart_enable_intr_mask, (uart_port_t uart, uint32_t mask), "interrupts(%d,%d)", uart,
       (int)mask)
RECORD(uart_enable_rx_intr, (uart_port_t uart), "receive(%d)", uart)

esp_err_t uart_flush_input(uart_port_t uart)
{
    idf.held_count = 0;
    return call("flush(%d)", uart);
}

esp_err_t uart_get_buffered_data_len(uart_port_t uart, size_t *size)
{
    TEST_ASSERT_EQUAL(UART_NUM_1, uart);
    *size = idf.held_count;
    return ESP_OK;
}

/* Returns the driver's bytes, as ESP-IDF does for a wait of 0 ticks. */
int uart_read_bytes(uart_port_t uart, void *buffer, uint32_t length, TickType_t ticks)
{
    TEST_ASSERT_EQUAL(UART_NUM_1, uart);
    TEST_ASSERT_EQUAL_UINT32(0, ticks);
    TEST_ASSERT_NOT_EQUAL_UINT32(0, length);
    if (idf.failing != NULL && strcmp(idf.failing, "read") == 0) {
        return -1;
    }
    const size_t count = idf.held_count < length ? idf.held_count : length;
    memcpy(buffer, idf.held, count);
    idf.held_count -= count;
    memmove(idf.held, &idf.held[count], idf.held_count);
    return (int)count;
}

/* A failing call sends `idf.failure` bytes. */
int uart_tx_chars(uart_port_t uart, const char *buffer, uint32_t length)
{
    const esp_err_t error =
        call("send(%d,%02X,%02X)", uart, (uint8_t)buffer[0], (uint8_t)buffer[1]);
    TEST_ASSERT_EQUAL_UINT32(2, length);
    return error == ESP_OK ? 2 : error;
}

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t function, const char *name, uint32_t stack_depth,
                                   void *argument, UBaseType_t priority, TaskHandle_t *handle,
                                   BaseType_t core)
{
    TEST_ASSERT_NULL(handle);
    idf.task = function;
    idf.task_argument = argument;
    return call("task(%s,%d,%d,%d)", name, (int)stack_depth, (int)priority,
                core == tskNO_AFFINITY ? -1 : (int)core) == ESP_OK
               ? pdPASS
               : pdFAIL;
}

void vTaskDelete(TaskHandle_t handle)
{
    TEST_ASSERT_NULL(handle);
    (void)call("end");
}

void vTaskDelay(TickType_t ticks)
{
    (void)call("delay(%d)", (int)ticks);
    if (idf.on_delay != NULL) {
        idf.on_delay();
    }
}

UBaseType_t uxQueueSpacesAvailable(const QueueHandle_t queue)
{
    TEST_ASSERT_EQUAL_PTR(idf.events, queue);
    return (UBaseType_t)(idf.queue_length - idf.event_count);
}

BaseType_t xQueueReceive(QueueHandle_t queue, void *buffer, TickType_t ticks)
{
    TEST_ASSERT_EQUAL_PTR(idf.events, queue);
    if (ticks > 0) {
        (void)call("%d", (int)ticks);
    }
    if (ticks > 0 && idf.on_wait != NULL) {
        idf.on_wait();
    }
    if (idf.event_count == 0) {
        memset(buffer, 0, sizeof idf.events[0]);
        return pdFALSE;
    }
    memcpy(buffer, &idf.events[0], sizeof idf.events[0]);
    idf.event_count--;
    memmove(&idf.events[0], &idf.events[1], idf.event_count * sizeof idf.events[0]);
    return pdTRUE;
}
