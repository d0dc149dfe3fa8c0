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
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

/* Resets the board. `observer` watches the lidar; the FIFO has 16 bytes; errors are reported. */
void zephyr_model_begin(const sim_observer_t *observer);

void zephyr_model_set_fifo(unsigned size);

/* -ENOSYS: the driver has no uart_err_check() or uart_configure(); 0: it has this function. */
void zephyr_model_set_error_check(int result);
void zephyr_model_set_configure(int result);

/* 0: the driver has the interrupt-driven API; -ENOSYS: it has not; -ENOTSUP: the API is off. */
void zephyr_model_set_interrupts(int result);

/* As above for the async API; and the result of its uart_rx_enable(). */
void zephyr_model_set_async(int result);
void zephyr_model_set_async_enable(int result);

void zephyr_model_set_ready(bool ready);

/* Initialises the lidar's device; DEVICE_DT_INST_DEFINE() defines this function. */
int zephyr_model_init_lidar(void);
void zephyr_model_set_lidar_ready(bool ready);
static inline void zephyr_model_boot(void)
{
    zephyr_model_set_lidar_ready(zephyr_model_init_lidar() == 0);
}

sim_t *zephyr_model_lidar(void);

uint64_t zephyr_model_now_us(void);

/* Time passes: bytes arrive. Interrupts are served meanwhile, or (held up) only afterwards. */
void zephyr_model_pass(uint32_t us);
void zephyr_model_pass_held_up(uint32_t us);

/* Bytes arrive now. The interrupt comes when the FIFO is full, and at the end. */
void zephyr_model_receive(const uint8_t *bytes, size_t count);

/* Reception was left on before the start; an interrupt comes although it was switched off. */
void zephyr_model_leave_receiving(void);
void zephyr_model_interrupt_late(void);

/* The next byte arrives with these errors. */
void zephyr_model_damage(int errors);

/* Clearing errors reads the data register, as on USARTs with SR and DR: its byte is lost. */
void zephyr_model_set_clearing_reads_data(void);

/* During the next reading of the full FIFO, a byte is lost. */
void zephyr_model_lose_while_reading(void);

uint32_t zephyr_model_line_bytes(void);

uint32_t zephyr_model_baud_rate(void);
bool zephyr_model_is_receiving(void); /* With either API. */

/* How often the semaphore, not the timeout, has woken the polling thread. */
unsigned zephyr_model_wakes(void);

/* Called whenever the test's thread sleeps; may leave by longjmp(), or be NULL. */
void zephyr_model_on_sleep(void (*callback)(void));

#endif
