/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Collects an example's output on a model, and calculates the time that printing would take on a
 * real console: a UART with 115200 baud, whose functions wait for the last byte. Meanwhile the
 * example does not poll. */

#ifndef CONSOLE_H
#define CONSOLE_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* Forgets the output of the program before. */
void console_begin(void);

/* A model calls these when the example prints. */
void console_write(uint64_t now_us, const char *text);
int console_print(uint64_t now_us, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

/* Bytes that are no text. */
void console_note(uint64_t now_us, size_t bytes);

/* The whole output. */
const char *console_text(void);

/* Search for the text in the whole output, or in the last line with a comma, which examples print
 * each second. */
void assert_said(const char *text);
void assert_last_said(const char *text);

/* Fails if printing takes more than half of the time, or in one turn of the loop longer than
 * receiving `held` bytes at 23,000 bytes per second. */
void assert_console_leaves_time(uint32_t held);

#endif
