/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The terminal, for a picture that fills it: taken over, asked for keys and size, given back. */

#ifndef TERMINAL_H
#define TERMINAL_H

#include <stdbool.h>
#include <stddef.h>

/* Takes the terminal over: another screen, no echo, no cursor. Returns false if standard output is not
 * a terminal. It is given back by terminal_restore(), or else when the program exits. */
bool terminal_take(void);
void terminal_restore(void);

/* The size now, in characters; false if it is not known. */
bool terminal_size(unsigned *columns, unsigned *rows);

/* The key that was pressed, or 0. Does not wait. */
char terminal_key(void);

/* Writes to the terminal. */
void terminal_write(const char *text, size_t size);

#endif
