/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The lidar on a UART of an ESP32 (any chip of the family, ESP-IDF 5.0 and newer).
 *
 * Over ESP-IDF's own UART driver: its interrupt takes the bytes out of the UART's 128-byte FIFO
 * into its ring buffer and posts events to a queue; a receiving task, or the caller's own loop,
 * hands them on to the lidar. Everything else happens in tmini_poll(), as on every platform.
 *
 *     static tmini_t lidar;
 *     static tmini_esp32_t board;
 *
 *     config.port = &tmini_esp32_port;
 *     config.port_context = &board;
 *     tmini_init(&lidar, &config);                                  first the lidar,
 *     const tmini_esp32_config_t wiring = TMINI_ESP32_CONFIG_DEFAULT;
 *     ESP_ERROR_CHECK(tmini_esp32_open(&board, &wiring, &lidar));   then bytes for it
 *
 * With a task (the default), that task feeds and the one that polls is another, on the same core or
 * not: the lidar's ring is made for that. Without (`with_task` false), one task calls both
 * tmini_esp32_receive(), which sleeps until bytes come, and tmini_poll(). */

#ifndef TMINI_ESP32_H
#define TMINI_ESP32_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "driver/uart.h"
#include "esp_err.h"
#include "freertos/FreeRTOS.h"
#include "freertos/queue.h"
#include "sdkconfig.h"

#include "tmini/tmini.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The task may run on any core. */
#define TMINI_ESP32_ANY_CORE (-1)

typedef struct {
    int uart;             /* 1 for UART1, and so on. UART0 is the console unless moved. */
    int tx_pin;           /* The GPIO wired to the lidar's RX. */
    int rx_pin;           /* The GPIO wired to the lidar's TX. */
    int buffer_size;      /* Of the UART driver's ring buffer: more than the FIFO's 128 bytes. */
    int queue_length;     /* Of the UART driver's event queue. */
    int fifo_threshold;   /* Bytes in the FIFO that raise the interrupt: 1 to 126. */
    int timeout_symbols;  /* Or so many byte times of silence behind the last byte: 1 to 100. */
    bool with_task;       /* Start a receiving task; else the caller calls tmini_esp32_receive(). */
    int task_stack_bytes; /* The rest is for that task alone. */
    int task_priority;    /* Above the task that polls. */
    int task_core;        /* 0, 1 or TMINI_ESP32_ANY_CORE. */
} tmini_esp32_config_t;

/* Wiring and sizes as chosen in menuconfig, "T-mini lidar". Kconfig says what each is good for. */
#define TMINI_ESP32_CONFIG_DEFAULT                                                          \
    {                                                                                       \
        .uart = CONFIG_TMINI_ESP32_UART, .tx_pin = CONFIG_TMINI_ESP32_TX_PIN,               \
        .rx_pin = CONFIG_TMINI_ESP32_RX_PIN, .buffer_size = CONFIG_TMINI_ESP32_BUFFER_SIZE, \
        .queue_length = CONFIG_TMINI_ESP32_QUEUE_LENGTH,                                    \
        .fifo_threshold = CONFIG_TMINI_ESP32_FIFO_THRESHOLD,                                \
        .timeout_symbols = CONFIG_TMINI_ESP32_TIMEOUT_SYMBOLS, .with_task = true,           \
        .task_stack_bytes = CONFIG_TMINI_ESP32_TASK_STACK,                                  \
        .task_priority = CONFIG_TMINI_ESP32_TASK_PRIORITY,                                  \
        .task_core = CONFIG_TMINI_ESP32_TASK_CORE,                                          \
    }

/* What became of the received bytes before the lidar saw them. Running totals, modulo 2^32. What the
 * parser then makes of them is in tmini_counters(). */
typedef struct {
    uint32_t bytes;          /* Handed to the lidar. */
    uint32_t fifo_overflows; /* The interrupt came too late; the FIFO's 128 bytes were lost. */
    uint32_t buffers_full;   /* The task came too late; bytes waited, and may then overflow. */
    uint32_t queues_full;    /* Events may have been lost, but no bytes. */
    uint32_t breaks;         /* The line was low for longer than a byte: unplugged? */
    uint32_t frame_errors;   /* A stop bit was missing: wrong baud rate, noise? */
    uint32_t parity_errors;  /* Cannot happen without a parity bit; counted all the same. */
} tmini_esp32_counters_t;

/* One UART with a lidar. All zero: closed. Treat the members as private. */
typedef struct {
    tmini_t *lidar;
    QueueHandle_t events;
    uart_port_t uart;
    bool is_open;
    bool with_task;
    bool stopping;                   /* Written by tmini_esp32_close(), read by the task. */
    bool receiving;                  /* Written by the task: cleared by its last breath. */
    tmini_esp32_counters_t counters; /* Written by the receiving context alone. */
    uint8_t chunk[128];
} tmini_esp32_t;

/* The lidar's port. Its context is the tmini_esp32_t, which need not be open for tmini_init(). */
extern const tmini_port_t tmini_esp32_port;

/* Installs the UART driver, sets it up for the lidar and starts the receiving task. The UART's
 * interrupt is served by the core that makes this call. `lidar` has been through tmini_init(); both
 * it and `board` stay the caller's and must last until tmini_esp32_close().
 *
 * Context: a task. Waits only for memory. Returns ESP_OK, or with nothing left behind
 *   ESP_ERR_INVALID_ARG    null pointer, or a value outside its documented range
 *   ESP_ERR_INVALID_STATE  already open
 *   ESP_ERR_NO_MEM         no memory for the task
 *   another                as the UART driver gave it; ESP_FAIL if the UART is taken */
esp_err_t tmini_esp32_open(tmini_esp32_t *board, const tmini_esp32_config_t *config,
                           tmini_t *lidar);

/* Ends the receiving task and removes the UART driver; also while bytes come in. Stop the lidar
 * before, or it goes on scanning. `board` may be opened again; the counters start anew.
 *
 * Context: the task that polls. Waits up to about 30 ms for the receiving task to end. Returns
 * ESP_OK, ESP_ERR_INVALID_STATE when not open, or what the UART driver gave. */
esp_err_t tmini_esp32_close(tmini_esp32_t *board);

/* Waits up to `ticks` for bytes, and hands all that have come to the lidar. Returns how many. For use
 * without a receiving task only; with one, or when closed, it returns 0 at once.
 *
 * Context: the task that polls. */
size_t tmini_esp32_receive(tmini_esp32_t *board, TickType_t ticks);

/* Copies the counters; any task. */
void tmini_esp32_counters(const tmini_esp32_t *board, tmini_esp32_counters_t *counters);

#ifdef __cplusplus
}
#endif

#endif
