/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The terminal, for a picture that fills it: taken over, asked for keys and size, given back. */

#ifndef TERMINAL_H
#define TERMINAL_H

#include <stdbool.h>
#include <stddef.h>

/* Keys that are no characters. */
enum {
    KEY_NONE = 0,
    KEY_SUSPEND = 0x1A, /* Ctrl-Z */
    KEY_ESCAPE = 0x1B,
    KEY_LEFT = 0x100,
    KEY_RIGHT,
};

/* What it can do, by TERM, NO_COLOR and the locale's variables. */
bool terminal_has_cursor(void);
bool terminal_has_colours(void);
bool terminal_has_unicode(void);

/* Takes the terminal over: another screen, no echo, no cursor. The keys are the terminal's even
 * when standard input is not. Returns false if standard output is no terminal. It is given back by
 * terminal_restore(), or else when the program exits. */
bool terminal_take(void);
void terminal_restore(void);

/* Gives it back and stops this program and those that it is in a pipe with; on going on, takes it
 * over again. */
void terminal_suspend(void);

/* The size now, in characters; false if it is not known. */
bool terminal_size(unsigned *columns, unsigned *rows);

/* The key that was pressed, or KEY_NONE. Does not wait, but to tell Esc from the arrows. */
int terminal_key(void);

/* Writes to the terminal. */
void terminal_write(const char *text, size_t size);

#endif
