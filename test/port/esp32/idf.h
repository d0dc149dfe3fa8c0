/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of ESP-IDF that the ESP32 port needs. It can record each call, and fails in the call
 * that a test chooses. Its UART's driver takes what the machine's line brings (machine.h), or what
 * a test puts into its buffer.
 *
 * With idf_tasks.c tasks run as on two cores, and time passes while all of them wait, or one works.
 * Without it a test plays tasks and time. */

#ifndef IDF_H
#define IDF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "driver/uart.h"
#include "freertos/task.h"
#include "machine.h"

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

/* This pin belongs to JTAG at first, and is a GPIO only after gpio_reset_pin(). */
#define IDF_JTAG_PIN 10

typedef struct {
    bool is_gpio; /* False: it belongs to another function, such as JTAG. */
    bool is_output;
    int level;
    bool has_been_low; /* While it was an output. */
} idf_pin_t;

typedef struct {
    bool records;
    char calls[1024];    /* All calls so far, in order. */
    const char *failing; /* Calls whose record begins with this text fail; NULL: none. */
    esp_err_t failure;   /* The result of a call that fails. */
    idf_pin_t pins[64];
    unsigned locks_held; /* Of the power management. */

    bool installed;       /* The UART's driver. */
    unsigned stray_calls; /* Calls for a UART without a driver; should be 0. */
    size_t fifo_threshold;
    bool fifo_overflowed;
    bool is_routed;      /* The receive pin. */
    bool has_interrupts; /* The UART; other code could switch them off. */
    uint8_t buffer[16384];
    size_t buffer_size;
    size_t buffer_count;
    uart_event_t queue[256];
    size_t queue_size;
    size_t queue_count;
} idf_t;

extern idf_t idf;

/* Resets the model. `observer` watches the lidar. */
void idf_begin(const sim_observer_t *observer);

/* The level of a pin; -1 if it is no output. */
int idf_pin(int pin);

/* Switches the UART's interrupts off and disconnects its receive pin, as other code could do. */
void idf_break_reception(void);

/* Puts an event into the queue. If it is full, the event is lost, as in ESP-IDF. */
void idf_post(uart_event_type_t type, size_t size);

/* Tasks and time; the test of the calls plays them. */
void idf_wait(TickType_t ticks, bool for_event);
void idf_begin_task(TaskFunction_t function, void *argument);
void idf_end_task(void);

/* idf_tasks.c: forgets all tasks but the caller. */
void idf_begin_tasks(void);

#endif
