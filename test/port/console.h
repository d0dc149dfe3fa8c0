/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What an example prints, on a model whose console takes no time; and how long that would take on a
 * real one: a UART of 115200 baud, whose functions wait until the last byte has left. Meanwhile the
 * example's loop does not poll. */

#ifndef CONSOLE_H
#define CONSOLE_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* Another program begins. */
void console_begin(void);

/* A model's console prints. */
void console_write(uint64_t now_us, const char *text);
int console_print(uint64_t now_us, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

/* The same, where the model keeps the text. */
void console_note(uint64_t now_us, size_t bytes);

/* All that has been printed has this text somewhere; and its last line with a comma, which an
 * example writes each second. */
void assert_said(const char *text);
void assert_last_said(const char *text);

/* Printing took half of the time at most; and at once no longer than receiving `held` bytes takes,
 * at 23,000 bytes per second. */
void assert_console_leaves_time(uint32_t held);

#endif
