/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A board under Zephyr as far as the port sees it: the test's thread and one that the port makes,
 * one UART with its interrupt line (irq_lines.h), and the simulated lidar. Time goes on only while
 * all threads sleep or the test makes it.
 *
 * The UART is one of two kinds that Zephyr's drivers have: with a FIFO of 1 to 64 bytes; with
 * errors reported by uart_err_check(), or not. As with some drivers, reading data clears the
 * errors. */

#ifndef ZEPHYR_MODEL_H
#define ZEPHYR_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "simulator.h"

/* A fresh board with a lidar at rest, which `observer` watches; a FIFO of 16, errors reported. */
void zephyr_model_begin(const sim_observer_t *observer);

void zephyr_model_set_fifo(unsigned size);

/* -ENOSYS for a driver without uart_err_check() or uart_configure(); 0: it has them. */
void zephyr_model_set_error_check(int result);
void zephyr_model_set_configure(int result);

/* -ENOSYS for a driver without the interrupt-driven API, -ENOTSUP if it is off; 0: it has it. */
void zephyr_model_set_interrupts(int result);

/* The same of the async API; and of its uart_rx_enable(). */
void zephyr_model_set_async(int result);
void zephyr_model_set_async_enable(int result);

void zephyr_model_set_ready(bool ready);

/* The lidar's device is initialised: DEVICE_DT_INST_DEFINE() makes the function. */
int zephyr_model_init_lidar(void);
void zephyr_model_set_lidar_ready(bool ready);
static inline void zephyr_model_boot(void)
{
    zephyr_model_set_lidar_ready(zephyr_model_init_lidar() == 0);
}

/* The lidar; see simulator.h. */
sim_t *zephyr_model_lidar(void);

uint64_t zephyr_model_now_us(void);

/* Time passes: bytes come and interrupts are served; or, held up, not served until it is over. */
void zephyr_model_pass(uint32_t us);
void zephyr_model_pass_held_up(uint32_t us);

/* Bytes as if the lidar had sent them now; the interrupt comes when the FIFO is full, and at the
 * end. */
void zephyr_model_receive(const uint8_t *bytes, size_t count);

/* Reception was left on before; and an interrupt that was under way while it was switched
 * off. */
void zephyr_model_leave_receiving(void);
void zephyr_model_interrupt_late(void);

/* The error that comes with the next byte. */
void zephyr_model_damage(int errors);

/* Clearing errors reads the data register, as on USARTs with SR and DR: what it held is gone. */
void zephyr_model_set_clearing_reads_data(void);

/* The next reading of the FIFO finds it full, and one byte is lost while it is being read. */
void zephyr_model_lose_while_reading(void);

/* Bytes that have come on the line so far. */
uint32_t zephyr_model_line_bytes(void);

uint32_t zephyr_model_baud_rate(void);
bool zephyr_model_is_receiving(void); /* By whichever API. */

/* How often the polling thread has been woken by the semaphore, and not by its time-out. */
unsigned zephyr_model_wakes(void);

/* Called whenever the thread sleeps; may leave by longjmp(). NULL: nothing. */
void zephyr_model_on_sleep(void (*callback)(void));

#endif
