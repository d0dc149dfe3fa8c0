/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* An ESP32-C3 without an operating system: a clock, and UART0 for the lidar, with reception by
 * interrupt. */

#ifndef BOARD_H
#define BOARD_H

#include "tmini/tmini.h"

typedef struct {
    uint32_t interrupts;
    uint32_t most_bytes; /* Received in one interrupt. */
    uint32_t overflows;  /* Of the UART's receive FIFO. */
} board_statistics_t;

extern const tmini_port_t board_port;

/* Sets up clock, UART and interrupt. After that, received bytes go to `lidar`. */
void board_open(tmini_t *lidar);

/* Sleeps until the next interrupt. */
void board_sleep(void);

board_statistics_t board_statistics(void);

/* The largest number of stack bytes in use so far. */
uint32_t board_stack_used(void);

#endif
