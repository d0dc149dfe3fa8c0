/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of a Zephyr board as the port sees it: the test's thread and one that the port creates,
 * one UART with its interrupt line (irq_lines.h), and the simulated lidar. Time passes only while
 * all threads sleep, or when the test lets it pass.
 *
 * The UART has a FIFO of 1 to 64 bytes. Its driver may or may not report errors by
 * uart_err_check(). As in some drivers, reading data clears the errors. */

#ifndef ZEPHYR_MODEL_H
#define ZEPHYR_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include <zephyr/drivers/uart.h>

#include "machine.h"

typedef struct {
    /* What the driver's functions return: -ENOSYS: it does not have this function, or this API;
     * -ENOTSUP: the API is off. */
    int error_check;
    int configure;
    int interrupts;
    int async;
    int async_enable;
    bool ready;
    bool lidar_ready;
    uint32_t baud_rate;
    int errors;               /* Since they were last taken. */
    bool lose_while_reading;  /* During the next reading of the full FIFO, a byte is lost. */
    bool clearing_reads_data; /* As on USARTs with SR and DR: clearing errors loses a byte. */
    bool receiving;           /* By the interrupt-driven API. */
    bool async_is_on;
    bool late; /* An interrupt that was already pending when it was switched off. */
    uart_irq_callback_user_data_t callback;
    void *user_data;
    unsigned waits; /* How often a thread has waited for a semaphore. */
    unsigned wakes; /* How often the semaphore, not the timeout, has woken the polling thread. */
} zephyr_board_t;

extern zephyr_board_t board;

/* Resets the board. `observer` watches the lidar; the FIFO has 16 bytes; errors are reported. */
void zephyr_model_begin(const sim_observer_t *observer);

/* Initialises the lidar's device; DEVICE_DT_INST_DEFINE() defines this function. */
int zephyr_model_init_lidar(void);
static inline void zephyr_model_boot(void)
{
    board.lidar_ready = zephyr_model_init_lidar() == 0;
}

/* Private to the model: its kernel and the UART's async API; the UART's interrupt while that is in
 * use; the line's errors since the last call. */
void zephyr_kernel_begin(void);
void zephyr_async_begin(void);
bool zephyr_async_is_up(void);
void zephyr_async_serve(void);
int zephyr_board_take_errors(void);

#endif
