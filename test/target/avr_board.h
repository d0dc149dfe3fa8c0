/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The little that unit tests need from an ATmega2560: a place to print, and an end. */

#ifndef AVR_BOARD_H
#define AVR_BOARD_H

/* Prepares the UART and marks the end of the static data. */
void avr_board_start(void);

/* Sends a character through UART 0, which the simulator shows. */
void avr_board_put(char character);

/* Says so if the stack has run into the static data; then ends the simulation. Does not return. */
void avr_board_stop(void);

#endif
