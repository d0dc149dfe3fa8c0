/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The LM3S6965 evaluation board, which QEMU emulates: UART0 is the console, UART1 the lidar's. */

#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Clock, pins and UARTs; the lidar's at 230400 baud, its interrupt still off. */
void board_start(void);

/* The lidar's UART, as `write` of tmini_port_t. */
int board_lidar_write(void *uart, const uint8_t *bytes, size_t count);

/* Its receive interrupt, which calls UART1_Handler(). */
void board_enable_lidar_interrupt(void);

/* In that interrupt: takes up to `max` bytes out of the FIFO; *overrun becomes true if bytes were
 * lost before or among them. */
size_t board_lidar_read(uint8_t *bytes, size_t max, int *overrun);

/* The console; waits while the transmitter is busy. */
void board_print(const char *text);

/* Sleeps until the next interrupt. */
void board_sleep(void);

/* Defined by the program. */
void UART1_Handler(void);

#endif
