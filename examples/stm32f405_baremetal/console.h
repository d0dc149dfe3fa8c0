/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The console: writes text through a buffer that is emptied whenever there is time, and reads keys.
 * Never waits; if the buffer is full, text is lost. */

#ifndef CONSOLE_H
#define CONSOLE_H

#include <stdbool.h>
#include <stdint.h>

void console_text(const char *text);

/* "name 123", with a blank before it. */
void console_value(const char *name, uint32_t value);

/* "name 12.34", with a blank before it, from hundredths. */
void console_hundredths(const char *name, uint32_t hundredths);

/* "name 1.2", with a blank before it. */
void console_version(const char *name, uint32_t major, uint32_t minor);

/* "name 0123abcd", with a blank before it. */
void console_hex(const char *name, uint32_t value);

void console_line_end(void);

/* Sends what the transmitter takes. Returns true when nothing is left. */
bool console_work(void);

/* The key that was pressed, or 0. */
char console_key(void);

#endif
