/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The board: clocks, pins, time, the drive's enable output.
 *
 *   PA9, PA10   USART1, to the lidar's RX and TX, 230400 baud
 *   PA2, PA3    USART2, the console, 115200 baud
 *   PB0         drive enable: high while the robot may move */

#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* 0: the internal 16 MHz oscillator, which is exact to 1 % only near room temperature. With a
 * crystal: its frequency, a multiple of 1 MHz. */
#ifndef BOARD_CRYSTAL_HZ
#define BOARD_CRYSTAL_HZ 0u
#endif

#define BOARD_CLOCK_HZ 168000000u
#define BOARD_USART1_CLOCK_HZ 84000000u /* Bus APB2. */
#define BOARD_USART2_CLOCK_HZ 42000000u /* Bus APB1. */

extern volatile uint32_t board_time_ms;

/* Sets everything up; the drive is off, the lidar's interrupt not yet enabled. */
void board_start(void);

/* Waits a limited time until the register's masked bits have this value; the firmware continues
 * even without it. */
void board_wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t bits);

void board_enable_lidar_interrupt(void);

void board_enable_drive(bool enable);

/* Sleeps until the next interrupt, at most a millisecond. */
void board_sleep(void);

/* Processor cycles, modulo one millisecond, to measure shorter times. */
uint32_t board_cycles_since(uint32_t start);
uint32_t board_cycle(void);

/* The most stack that was ever in use, in bytes. */
uint32_t board_stack_used(void);

#endif
