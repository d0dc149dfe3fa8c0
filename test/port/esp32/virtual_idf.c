/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "virtual_idf.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "console.h"
#include "driver/gpio.h"
#include "driver/uart.h"
#include "esp_log.h"
#include "esp_pm.h"
#include "esp_timer.h"
#include "freertos/FreeRTOS.h"
#include "freertos/task.h"

#define STEP_US 500u
#define TICK_US (1000000u / CONFIG_FREERTOS_HZ)
#define FIFO_SIZE 128u
#define BUFFER_MAX 16384u
#define QUEUE_MAX 128u
#define PINS 64
#define WAITERS 8u

typedef struct {
    bool used;
    bool released;
    bool for_event; /* False: it only waits for the time. */
    uint64_t until_us;
} waiter_t;

typedef struct {
    bool is_gpio; /* False: it belongs to another function, such as JTAG. */
    bool is_output;
    int level;
    bool has_been_low;
} virtual_pin_t;

static struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    uint64_t held_until_us;
    unsigned waiting;
    waiter_t waiters[WAITERS];

    virtual_idf_state_t state;
    uint8_t fifo[FIFO_SIZE];
    size_t fifo_count;
    size_t fifo_threshold;
    bool fifo_overflowed;
    bool line_pauses;
    bool is_routed;
    bool has_interrupts;
    uint8_t buffer[BUFFER_MAX];
    size_t buffer_size;
    size_t buffer_count;
    /* FIFO bytes that did not fit into the buffer. Until they are read, the FIFO keeps its
     * bytes. */
    uint8_t stash[FIFO_SIZE];
    size_t stash_count;
    uart_event_t queue[QUEUE_MAX];
    size_t queue_size;
    size_t queue_count;

    virtual_pin_t pins[PINS];
    char log[16384];
    size_t log_length;
} world = {.lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

void virtual_idf_lock(void)
{
    pthread_mutex_lock(&world.lock);
}

void virtual_idf_unlock(void)
{
    pthread_mutex_unlock(&world.lock);
}

/* ------------------------------------------------------------------------- the UART's interrupt */

/* If the queue is full, the event is lost, as in ESP-IDF. */
static void post(uart_event_type_t type, size_t size)
{
    if (world.queue_count < world.queue_size) {
        world.queue[world.queue_count++] = (uart_event_t){.type = type, .size = size};
    }
}

static void fill_fifo(void)
{
    uint8_t bytes[256];
    const size_t count = sim_transmit(&machine.lidar, machine.now_us, bytes, sizeof bytes);
    machine.line_bytes += (uint32_t)count;
    world.line_pauses = count == 0; /* A time step is longer than the UART's receive timeout. */
    for (size_t i = 0; i < count; i++) {
        if (!world.is_routed) {
            continue;
        }
        if (world.fifo_count < FIFO_SIZE) {
            world.fifo[world.fifo_count++] = bytes[i];
        } else {
            world.fifo_overflowed = true;
        }
    }
}

static bool keep(const uint8_t *bytes, size_t count)
{
    if (world.buffer_size - world.buffer_count < count) {
        return false;
    }
    memcpy(&world.buffer[world.buffer_count], bytes, count);
    world.buffer_count += count;
    return true;
}

static bool has_cause_to_read(void)
{
    return world.fifo_count >= world.fifo_threshold || (world.fifo_count > 0 && world.line_pauses);
}

static void empty_fifo(void)
{
    if (keep(world.fifo, world.fifo_count)) {
        post(UART_DATA, world.fifo_count);
    } else {
        memcpy(world.stash, world.fifo, world.fifo_count);
        world.stash_count = world.fifo_count;
        post(UART_BUFFER_FULL, world.fifo_count);
    }
    world.fifo_count = 0;
}

/* ESP-IDF's interrupt handler moves the FIFO's bytes to its buffer. If they do not fit, it stashes
 * them, reports this once, and leaves the FIFO alone until the stash is read. After that it checks
 * for an overflow and resets the FIFO: bytes moved or stashed before are safe, the others are
 * lost. */
static void serve_interrupt(void)
{
    if (!world.state.installed || !world.has_interrupts || machine.now_us < world.held_until_us) {
        return;
    }
    if (has_cause_to_read() && world.stash_count == 0) {
        empty_fifo();
    }
    if (world.fifo_overflowed) {
        world.fifo_overflowed = false;
        world.fifo_count = 0;
        post(UART_FIFO_OVF, 0);
    }
}

/* ------------------------------------------------------------------------------- time and tasks */

static bool is_over(const waiter_t *waiter)
{
    return machine.now_us >= waiter->until_us || (waiter->for_event && world.queue_count > 0);
}

static void release_waiters(void)
{
    for (unsigned i = 0; i < WAITERS; i++) {
        waiter_t *const waiter = &world.waiters[i];
        if (waiter->used && !waiter->released && is_over(waiter)) {
            waiter->released = true;
            world.waiting--;
        }
    }
    pthread_cond_broadcast(&world.changed);
}

static void let_time_pass(void)
{
    while (world.state.tasks > 0 && world.waiting == world.state.tasks) {
        machine.now_us += STEP_US;
        fill_fifo();
        serve_interrupt();
        release_waiters();
    }
}

static void wait_until(uint64_t until_us, bool for_event)
{
    waiter_t *waiter = world.waiters;
    while (waiter->used) {
        waiter++;
    }
    *waiter = (waiter_t){.used = true, .for_event = for_event, .until_us = until_us};
    world.waiting++;
    release_waiters();
    let_time_pass();
    while (!waiter->released) {
        pthread_cond_wait(&world.changed, &world.lock);
    }
    waiter->used = false;
}

typedef struct {
    TaskFunction_t function;
    void *argument;
} start_t;

static void *run_task(void *argument)
{
    const start_t start = *(start_t *)argument;
    free(argument);
    start.function(start.argument);
    return NULL;
}

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t function, const char *name, uint32_t stack_depth,
                                   void *argument, UBaseType_t priority, TaskHandle_t *task,
                                   BaseType_t core)
{
    pthread_t thread;
    start_t *const start = malloc(sizeof *start);
    (void)name, (void)stack_depth, (void)priority, (void)task, (void)core;
    if (start == NULL) {
        return pdFAIL;
    }
    *start = (start_t){.function = function, .argument = argument};
    virtual_idf_lock();
    world.state.tasks++;
    virtual_idf_unlock();
    if (pthread_create(&thread, NULL, run_task, start) != 0) {
        abort();
    }
    pthread_detach(thread);
    return pdPASS;
}

void vTaskDelete(TaskHandle_t task)
{
    (void)task; /* Always the calling task. */
    virtual_idf_lock();
    world.state.tasks--;
    let_time_pass();
    virtual_idf_unlock();
    pthread_exit(NULL);
}

void vTaskDelay(TickType_t ticks)
{
    virtual_idf_lock();
    wait_until(machine.now_us + (uint64_t)ticks * TICK_US, false);
    virtual_idf_unlock();
}

int64_t esp_timer_get_time(void)
{
    virtual_idf_lock();
    const int64_t now_us = (int64_t)machine.now_us;
    virtual_idf_unlock();
    return now_us;
}

BaseType_t xQueueReceive(QueueHandle_t queue, void *buffer, TickType_t ticks)
{
    (void)queue;
    virtual_idf_lock();
    if (world.queue_count == 0 && ticks > 0) {
        wait_until(machine.now_us + (uint64_t)ticks * TICK_US, true);
    }
    const bool received = world.queue_count > 0;
    if (received) {
        memcpy(buffer, &world.queue[0], sizeof world.queue[0]);
        world.queue_count--;
        memmove(&world.queue[0], &world.queue[1], world.queue_count * sizeof world.queue[0]);
    }
    virtual_idf_unlock();
    return received ? pdTRUE : pdFALSE;
}

UBaseType_t uxQueueSpacesAvailable(const QueueHandle_t queue)
{
    (void)queue;
    virtual_idf_lock();
    const UBaseType_t spaces = (UBaseType_t)(world.queue_size - world.queue_count);
    virtual_idf_unlock();
    return spaces;
}

/* ---------------------------------------------------------------------------------- UART driver */

/* Returns true, with the lock held, if the driver is installed. */
static bool enter_driver(void)
{
    virtual_idf_lock();
    if (!world.state.installed) {
        world.state.stray_calls++;
        virtual_idf_unlock();
    }
    return world.state.installed;
}

/* A function that does this. */
#define LOCKED(function, parameters, ...) \
    esp_err_t function parameters         \
    {                                     \
        virtual_idf_lock();               \
        (void)(__VA_ARGS__);              \
        virtual_idf_unlock();             \
        return ESP_OK;                    \
    }

/* A function of the driver that does this, and fails without a driver. */
#define WITH_DRIVER(function, parameters, ...) \
    esp_err_t function parameters              \
    {                                          \
        (void)uart;                            \
        if (!enter_driver()) {                 \
            return ESP_FAIL;                   \
        }                                      \
        (void)(__VA_ARGS__);                   \
        virtual_idf_unlock();                  \
        return ESP_OK;                         \
    }

esp_err_t uart_driver_install(uart_port_t uart, int rx_buffer_size, int tx_buffer_size,
                              int queue_size, QueueHandle_t *queue, int intr_alloc_flags)
{
    (void)uart, (void)tx_buffer_size, (void)intr_alloc_flags;
    virtual_idf_lock();
    const bool was_installed = world.state.installed;
    if (!was_installed) {
        world.state.installed = true;
        world.has_interrupts = true;
        world.buffer_size = (size_t)rx_buffer_size;
        world.buffer_count = 0;
        world.queue_size = (size_t)queue_size;
        world.queue_count = 0;
        world.stash_count = 0;
        world.fifo_count = 0;
        world.fifo_threshold = 120; /* ESP-IDF's default. */
        world.fifo_overflowed = false;
    }
    *queue = (QueueHandle_t)(void *)&world.queue;
    virtual_idf_unlock();
    return was_installed ? ESP_FAIL : ESP_OK;
}

WITH_DRIVER(uart_driver_delete, (uart_port_t uart), world.state.installed = false)

esp_err_t uart_param_config(uart_port_t uart, const uart_config_t *config)
{
    (void)uart;
    return config->baud_rate == 230400 ? ESP_OK : ESP_FAIL;
}

esp_err_t uart_set_pin(uart_port_t uart, int tx, int rx, int rts, int cts)
{
    (void)uart, (void)rts, (void)cts;
    virtual_idf_lock();
    world.is_routed = tx != rx;
    virtual_idf_unlock();
    return tx != rx ? ESP_OK : ESP_FAIL;
}

WITH_DRIVER(uart_set_rx_full_threshold, (uart_port_t uart, int threshold),
            world.fifo_threshold = (size_t)threshold)
WITH_DRIVER(uart_set_rx_timeout, (uart_port_t uart, const uint8_t symbols), (void)symbols)
WITH_DRIVER(uart_enable_intr_mask, (uart_port_t uart, uint32_t mask), (void)mask)
WITH_DRIVER(uart_enable_rx_intr, (uart_port_t uart), world.has_interrupts = true)
WITH_DRIVER(uart_flush_input, (uart_port_t uart), world.fifo_count = 0, world.stash_count = 0,
            world.buffer_count = 0)
WITH_DRIVER(uart_get_buffered_data_len, (uart_port_t uart, size_t *size),
            *size = world.buffer_count)

void virtual_idf_break_reception(void)
{
    virtual_idf_lock();
    world.has_interrupts = false;
    world.is_routed = false;
    virtual_idf_unlock();
}

static size_t take_from_buffer(uint8_t *bytes, size_t length)
{
    const size_t count = world.buffer_count < length ? world.buffer_count : length;
    memcpy(bytes, world.buffer, count);
    world.buffer_count -= count;
    memmove(world.buffer, &world.buffer[count], world.buffer_count);
    return count;
}

static bool put_stash_back(void)
{
    if (world.stash_count == 0 || !keep(world.stash, world.stash_count)) {
        return false;
    }
    world.stash_count = 0;
    return true;
}

/* As soon as the buffer has room, the stashed bytes follow, also within one call. */
int uart_read_bytes(uart_port_t uart, void *buffer, uint32_t length, TickType_t ticks)
{
    uint8_t *const bytes = buffer;
    (void)uart, (void)ticks;
    if (!enter_driver()) {
        return -1;
    }
    size_t count = take_from_buffer(bytes, length);
    if (put_stash_back()) {
        count += take_from_buffer(&bytes[count], length - count);
    }
    virtual_idf_unlock();
    return (int)count;
}

int uart_tx_chars(uart_port_t uart, const char *buffer, uint32_t length)
{
    (void)uart;
    if (!enter_driver()) {
        return -1;
    }
    sim_receive(&machine.lidar, (const uint8_t *)buffer, length, machine.now_us);
    virtual_idf_unlock();
    return (int)length;
}

/* ------------------------------------------------------------------------------------- the rest */

esp_err_t gpio_pullup_en(gpio_num_t pin)
{
    (void)pin;
    return ESP_OK;
}

esp_err_t esp_pm_lock_create(esp_pm_lock_type_t type, int arg, const char *name,
                             esp_pm_lock_handle_t *created)
{
    (void)type, (void)arg, (void)name;
    *created = (esp_pm_lock_handle_t)(void *)&world.state.locks_held;
    return ESP_OK;
}

LOCKED(esp_pm_lock_acquire, (esp_pm_lock_handle_t held), (void)held, world.state.locks_held++)
LOCKED(esp_pm_lock_release, (esp_pm_lock_handle_t held), (void)held, world.state.locks_held--)

esp_err_t esp_pm_lock_delete(esp_pm_lock_handle_t held)
{
    (void)held;
    return ESP_OK;
}

/* A pin drives the line as soon as it is an output, with the current level of its register. A pin
 * of another function (JTAG) becomes a GPIO only after it has been reset. */
static void drive(virtual_pin_t *pin)
{
    pin->has_been_low = pin->has_been_low || (pin->is_gpio && pin->is_output && pin->level == 0);
}

LOCKED(gpio_reset_pin, (gpio_num_t pin), world.pins[pin].is_gpio = true,
       world.pins[pin].is_output = false)
LOCKED(gpio_set_direction, (gpio_num_t pin, gpio_mode_t mode),
       world.pins[pin].is_output = mode == GPIO_MODE_OUTPUT, drive(&world.pins[pin]))
LOCKED(gpio_set_level, (gpio_num_t pin, uint32_t level), world.pins[pin].level = (int)level,
       drive(&world.pins[pin]))

/* Bytes that ESP-IDF adds to a log line: colours, and the time in brackets. */
#define LOG_EXTRA 24u

void esp_log_line(char level, const char *tag, const char *format, ...)
{
    va_list arguments;
    char *const end = world.log + sizeof world.log;
    virtual_idf_lock();
    char *at = world.log + world.log_length;
    at += snprintf(at, (size_t)(end - at), "%c %s: ", level, tag);
    va_start(arguments, format);
    at += vsnprintf(at, (size_t)(end - at), format, arguments);
    va_end(arguments);
    at += snprintf(at, (size_t)(end - at), "\n");
    console_note(machine.now_us, (size_t)(at - world.log) - world.log_length + LOG_EXTRA);
    world.log_length = (size_t)(at - world.log);
    if (world.log_length > sizeof world.log - 1024u) {
        abort(); /* No test logs this much. */
    }
    virtual_idf_unlock();
}

void esp_stop(esp_err_t error)
{
    fprintf(stderr, "ESP_ERROR_CHECK: 0x%x\n", (unsigned)error);
    abort();
}

void virtual_idf_begin(const sim_observer_t *observer)
{
    static const machine_uart_t none;
    virtual_idf_lock();
    machine_begin(observer, &none);
    world.held_until_us = 0;
    world.state = (virtual_idf_state_t){.tasks = 1};
    world.waiting = 0;
    memset(world.waiters, 0, sizeof world.waiters);
    world.log_length = 0;
    world.log[0] = '\0';
    for (unsigned i = 0; i < PINS; i++) {
        world.pins[i] = (virtual_pin_t){.is_gpio = i != VIRTUAL_IDF_JTAG_PIN};
    }
    virtual_idf_unlock();
}

void virtual_idf_hold_interrupts(uint32_t duration_us)
{
    virtual_idf_lock();
    world.held_until_us = machine.now_us + duration_us;
    virtual_idf_unlock();
}

const char *virtual_idf_log(void)
{
    return world.log; /* No lock: it changes only while the caller waits. */
}

int virtual_idf_pin(int pin)
{
    virtual_idf_lock();
    const virtual_pin_t state = world.pins[pin];
    virtual_idf_unlock();
    return state.is_gpio && state.is_output ? state.level : -1;
}

bool virtual_idf_pin_has_been_low(int pin)
{
    virtual_idf_lock();
    const bool has_been_low = world.pins[pin].has_been_low;
    virtual_idf_unlock();
    return has_been_low;
}

virtual_idf_state_t virtual_idf_state(void)
{
    virtual_idf_lock();
    const virtual_idf_state_t state = world.state;
    virtual_idf_unlock();
    return state;
}
