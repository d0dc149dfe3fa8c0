/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The LM3S6965 evaluation board, which QEMU emulates: UART0 is the console; the lidar is on
 * UART1. */

#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Sets up clock, pins and UARTs. The lidar's UART has 230400 baud; its interrupt is still off. */
void board_start(void);

/* Sends on the lidar's UART, as `write` of tmini_port_t. */
int board_lidar_write(void *uart, const uint8_t *bytes, size_t count);

/* Enables the receive interrupt of the lidar's UART, which calls UART1_Handler(). */
void board_enable_lidar_interrupt(void);

/* Call it in that interrupt: takes up to `max` bytes out of the FIFO; *overrun becomes true if
 * bytes were lost before or among them. */
size_t board_lidar_read(uint8_t *bytes, size_t max, int *overrun);

/* Prints on the console; waits while the transmitter is busy. */
void board_print(const char *text);

void board_sleep(void);

/* Defined by the program. */
void UART1_Handler(void);

#endif
