/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "idf.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "console.h"
#include "driver/gpio.h"
#include "esp_log.h"
#include "esp_pm.h"
#include "esp_timer.h"
#include "interrupting_atomic.h"

#define FIFO_SIZE 128u
#define TIMEOUT_US 174u /* Four symbols at 230400 baud. */

idf_t idf;

/* Records a call; returns its result. */
static esp_err_t call(const char *format, ...)
{
    char text[64];
    va_list arguments;
    if (!idf.records) {
        return ESP_OK;
    }
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    (void)strcat(strcat(idf.calls, text), " ");
    return idf.failing != NULL && strncmp(text, idf.failing, strlen(idf.failing)) == 0 ? idf.failure
                                                                                       : ESP_OK;
}

/* A function that is recorded, and does this if it does not fail. */
#define CALL(function, parameters, check, record, ...)          \
    esp_err_t function parameters                               \
    {                                                           \
        const esp_err_t error = check ? call record : ESP_FAIL; \
        if (error == ESP_OK) {                                  \
            (void)(__VA_ARGS__);                                \
        }                                                       \
        return error;                                           \
    }
#define RECORDED(function, parameters, ...) CALL(function, parameters, true, __VA_ARGS__)
#define OF_DRIVER(function, parameters, ...) CALL(function, parameters, has_driver(), __VA_ARGS__)

/* Without a driver, its functions fail. */
static bool has_driver(void)
{
    idf.stray_calls += !idf.installed;
    return idf.installed;
}

/* ------------------------------------------------------------------------- the UART's interrupt */

void idf_post(uart_event_type_t type, size_t size)
{
    if (idf.queue_count < idf.queue_size) {
        idf.queue[idf.queue_count++] = (uart_event_t){.type = type, .size = size};
    }
}

static void arrive(uint32_t flags, uint8_t byte)
{
    (void)flags;
    idf.fifo_overflowed = (idf.is_routed && !machine_put(byte)) || idf.fifo_overflowed;
}

static bool has_cause_to_read(void)
{
    return machine_must_read(idf.fifo_threshold, TIMEOUT_US);
}

/* What is announced when the buffer is full, the test of the calls plays. */
static void empty_fifo(void)
{
    uint8_t *const end = &idf.buffer[idf.buffer_count];
    const size_t count = machine_read(end, FIFO_SIZE);
    idf.buffer_count += count;
    TEST_ASSERT_LESS_OR_EQUAL_MESSAGE(idf.buffer_size, idf.buffer_count, "the buffer is full");
    idf_post(UART_DATA, count);
}

static bool is_up(void)
{
    return idf.installed && idf.has_interrupts && (has_cause_to_read() || idf.fifo_overflowed);
}

/* ESP-IDF's interrupt handler moves the FIFO's bytes to its buffer. After that it checks for an
 * overflow and resets the FIFO: bytes moved before are safe, the others are lost. */
static void serve(void)
{
    if (has_cause_to_read()) {
        empty_fifo();
    }
    if (idf.fifo_overflowed) {
        idf.fifo_overflowed = false;
        machine.count = 0;
        idf_post(UART_FIFO_OVF, 0);
    }
}

void idf_begin(const sim_observer_t *observer)
{
    const machine_uart_t uart = {
        .fifo_size = FIFO_SIZE, .arrive = arrive, .is_up = is_up, .serve = serve};
    machine_begin(observer, &uart);
    memset(&idf, 0, sizeof idf);
    for (int i = 0; i < 64; i++) {
        idf.pins[i].is_gpio = i != IDF_JTAG_PIN;
    }
}

void idf_break_reception(void)
{
    idf.has_interrupts = false;
    idf.is_routed = false;
}

/* ---------------------------------------------------------------------------------- UART driver */

esp_err_t uart_driver_install(uart_port_t uart, int rx_buffer_size, int tx_buffer_size,
                              int queue_size, QueueHandle_t *queue, int intr_alloc_flags)
{
    const esp_err_t error = idf.installed ? ESP_FAIL
                                          : call("install(%d,%d,%d,%d,%d)", uart, rx_buffer_size,
                                                 tx_buffer_size, queue_size, intr_alloc_flags);
    if (error == ESP_OK) {
        idf.installed = true;
        idf.has_interrupts = true;
        idf.buffer_size = (size_t)rx_buffer_size;
        idf.buffer_count = 0;
        idf.queue_size = (size_t)queue_size;
        idf.queue_count = 0;
        machine.count = 0;
        idf.fifo_threshold = 120; /* ESP-IDF's default. */
        idf.fifo_overflowed = false;
    }
    *queue = (QueueHandle_t)(void *)&idf.queue;
    return error;
}

esp_err_t uart_param_config(uart_port_t uart, const uart_config_t *config)
{
    TEST_ASSERT_EQUAL(230400, config->baud_rate);
    TEST_ASSERT_EQUAL(UART_DATA_8_BITS, config->data_bits);
    TEST_ASSERT_EQUAL(UART_PARITY_DISABLE, config->parity);
    TEST_ASSERT_EQUAL(UART_STOP_BITS_1, config->stop_bits);
    TEST_ASSERT_EQUAL(UART_HW_FLOWCTRL_DISABLE, config->flow_ctrl);
    TEST_ASSERT_EQUAL(STEADY_CLOCK, config->source_clk);
    return call("line(%d,%d)", uart, config->baud_rate);
}

esp_err_t uart_set_pin(uart_port_t uart, int tx, int rx, int rts, int cts)
{
    TEST_ASSERT_NOT_EQUAL(tx, rx);
    TEST_ASSERT_EQUAL(UART_PIN_NO_CHANGE, rts);
    TEST_ASSERT_EQUAL(UART_PIN_NO_CHANGE, cts);
    const esp_err_t error = call("pins(%d,%d,%d)", uart, tx, rx);
    idf.is_routed = error == ESP_OK;
    return error;
}

OF_DRIVER(uart_driver_delete, (uart_port_t uart), ("remove(%d)", uart), idf.installed = false)
OF_DRIVER(uart_set_rx_full_threshold, (uart_port_t uart, int threshold),
          ("threshold(%d,%d)", uart, threshold), idf.fifo_threshold = (size_t)threshold)
OF_DRIVER(uart_set_rx_timeout, (uart_port_t uart, const uint8_t symbols),
          ("timeout(%d,%d)", uart, symbols), 0)
OF_DRIVER(uart_enable_intr_mask, (uart_port_t uart, uint32_t mask),
          ("interrupts(%d,%d)", uart, (int)mask), 0)
OF_DRIVER(uart_enable_rx_intr, (uart_port_t uart), ("receive(%d)", uart), idf.has_interrupts = true)
OF_DRIVER(uart_flush_input, (uart_port_t uart), ("flush(%d)", uart), machine.count = 0,
          idf.buffer_count = 0)

esp_err_t uart_get_buffered_data_len(uart_port_t uart, size_t *size)
{
    TEST_ASSERT_EQUAL(UART_NUM_1, uart);
    interrupt();
    *size = idf.buffer_count;
    return has_driver() ? ESP_OK : ESP_FAIL;
}

static size_t take_from_buffer(uint8_t *bytes, size_t length)
{
    const size_t count = idf.buffer_count < length ? idf.buffer_count : length;
    memcpy(bytes, idf.buffer, count);
    idf.buffer_count -= count;
    memmove(idf.buffer, &idf.buffer[count], idf.buffer_count);
    return count;
}

int uart_read_bytes(uart_port_t uart, void *buffer, uint32_t length, TickType_t ticks)
{
    TEST_ASSERT_EQUAL(UART_NUM_1, uart);
    TEST_ASSERT_EQUAL_UINT32(0, ticks);
    TEST_ASSERT_NOT_EQUAL_UINT32(0, length);
    interrupt();
    const bool fails = !has_driver() || (idf.failing != NULL && strcmp(idf.failing, "read") == 0);
    return fails ? -1 : (int)take_from_buffer(buffer, length);
}

/* A failing call sends `idf.failure` bytes. */
int uart_tx_chars(uart_port_t uart, const char *buffer, uint32_t length)
{
    TEST_ASSERT_EQUAL_UINT32(2, length);
    const esp_err_t error =
        !has_driver() ? -1
                      : call("send(%d,%02X,%02X)", uart, (uint8_t)buffer[0], (uint8_t)buffer[1]);
    if (error == ESP_OK) {
        sim_receive(&machine.lidar, (const uint8_t *)buffer, length, machine.now_us);
    }
    return error == ESP_OK ? 2 : error;
}

/* ----------------------------------------------------------------------- tasks, queues and time */

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t function, const char *name, uint32_t stack_depth,
                                   void *argument, UBaseType_t priority, TaskHandle_t *handle,
                                   BaseType_t core)
{
    TEST_ASSERT_NULL(handle);
    idf_begin_task(function, argument);
    return call("task(%s,%d,%d,%d)", name, (int)stack_depth, (int)priority,
                core == tskNO_AFFINITY ? -1 : (int)core) == ESP_OK
               ? pdPASS
               : pdFAIL;
}

void vTaskDelete(TaskHandle_t handle)
{
    TEST_ASSERT_NULL(handle);
    (void)call("end");
    idf_end_task();
}

void vTaskDelay(TickType_t ticks)
{
    (void)call("delay(%d)", (int)ticks);
    idf_wait(ticks, false);
}

int64_t esp_timer_get_time(void)
{
    return (int64_t)machine.now_us;
}

UBaseType_t uxQueueSpacesAvailable(const QueueHandle_t queue)
{
    TEST_ASSERT_EQUAL_PTR(idf.queue, queue);
    interrupt();
    return (UBaseType_t)(idf.queue_size - idf.queue_count);
}

BaseType_t xQueueReceive(QueueHandle_t queue, void *buffer, TickType_t ticks)
{
    TEST_ASSERT_EQUAL_PTR(idf.queue, queue);
    interrupt();
    if (ticks > 0) {
        (void)call("%d", (int)ticks);
        idf_wait(ticks, true);
    }
    const bool received = idf.queue_count > 0;
    memset(buffer, 0, sizeof idf.queue[0]);
    if (received) {
        memcpy(buffer, &idf.queue[0], sizeof idf.queue[0]);
        idf.queue_count--;
        memmove(&idf.queue[0], &idf.queue[1], idf.queue_count * sizeof idf.queue[0]);
    }
    return received ? pdTRUE : pdFALSE;
}

/* ------------------------------------------------------------------------------------- the rest */

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

static void check_lock(const void *lock)
{
    TEST_ASSERT_EQUAL_PTR(idf.calls, lock);
}

RECORDED(esp_pm_lock_acquire, (esp_pm_lock_handle_t lock), ("acquire"), check_lock(lock),
         idf.locks_held++)
RECORDED(esp_pm_lock_release, (esp_pm_lock_handle_t lock), ("release"), check_lock(lock),
         idf.locks_held--)
RECORDED(esp_pm_lock_delete, (esp_pm_lock_handle_t lock), ("forget"), check_lock(lock), 0)

/* A pin drives the line as soon as it is an output, with the current level of its register. A pin
 * of another function (JTAG) becomes a GPIO only after it has been reset. */
static void drive(idf_pin_t *pin)
{
    pin->has_been_low = pin->has_been_low || (pin->is_gpio && pin->is_output && pin->level == 0);
}

RECORDED(gpio_reset_pin, (gpio_num_t pin), ("reset(%d)", pin), idf.pins[pin].is_gpio = true,
         idf.pins[pin].is_output = false)
RECORDED(gpio_pullup_en, (gpio_num_t pin), ("pull-up(%d)", pin), 0)
RECORDED(gpio_set_direction, (gpio_num_t pin, gpio_mode_t mode), ("direction(%d)", pin),
         idf.pins[pin].is_output = mode == GPIO_MODE_OUTPUT, drive(&idf.pins[pin]))
RECORDED(gpio_set_level, (gpio_num_t pin, uint32_t level), ("level(%d)", pin),
         idf.pins[pin].level = (int)level, drive(&idf.pins[pin]))

int idf_pin(int pin)
{
    const idf_pin_t *const state = &idf.pins[pin];
    return state->is_gpio && state->is_output ? state->level : -1;
}

/* Bytes that ESP-IDF adds to a log line: colours, and the time in brackets. */
#define LOG_EXTRA 24u

void esp_log_line(char level, const char *tag, const char *format, ...)
{
    va_list arguments;
    (void)machine_printf("%c %s: ", level, tag);
    va_start(arguments, format);
    (void)console_print(machine.now_us, format, arguments);
    va_end(arguments);
    (void)machine_printf("\n");
    console_note(machine.now_us, LOG_EXTRA);
}

void esp_stop(esp_err_t error)
{
    fprintf(stderr, "ESP_ERROR_CHECK: 0x%x\n", (unsigned)error);
    abort();
}
