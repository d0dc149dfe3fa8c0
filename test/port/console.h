/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What an example prints, on a model whose console takes no time, as it would be on a real one: a
 * UART of 115200 baud, whose functions wait until the last byte has left. Meanwhile the example's
 * loop does not poll. */

#ifndef CONSOLE_H
#define CONSOLE_H

#include <stddef.h>
#include <stdint.h>

/* Another program begins. */
void console_begin(void);

/* By a model's console, for each text. */
void console_note(uint64_t now_us, size_t bytes);

/* What is printed at once takes no longer than `held` bytes, which are received meanwhile, last at
 * 23,000 bytes per second; and all that has been printed, half of the time. */
void assert_console_leaves_time(uint32_t held);

#endif
