/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What unit tests need from an ATmega2560: a way to print and a way to end. */

#ifndef AVR_BOARD_H
#define AVR_BOARD_H

/* Prepares the UART, and fills some bytes after the static data with a guard pattern. */
void avr_board_start(void);

/* Sends a character through UART 0. The simulator prints it. */
void avr_board_put(char character);

/* Reports a stack that has overwritten the guard pattern, then ends the simulation. Does not
 * return. */
void avr_board_stop(void);

#endif
