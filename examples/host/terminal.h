/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Takes over the terminal, draws on it, reads keys, and restores it. Unicode's braille characters
 * have two columns and four rows of dots, so a terminal of 80 x 24 can show 160 x 96 dots. */

#ifndef TERMINAL_H
#define TERMINAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Colours from the terminal's palette of 256. */
enum {
    COLOUR_PLAIN = 252,
    COLOUR_DIM = 242,
    COLOUR_GRID = 238,
    COLOUR_AMBER = 214,
    COLOUR_ALARM = 203,
};

/* Dots of a higher layer hide those of lower ones in the same character. */
typedef enum { LAYER_NONE, LAYER_GRID, LAYER_POINTS, LAYER_TEXT } layer_t;

typedef struct {
    uint16_t character; /* Unicode */
    uint8_t colour;
    uint8_t layer;
} cell_t;

/* What is to be shown. `columns`, `rows` and `has_cursor` may be read. */
typedef struct {
    unsigned columns;
    unsigned rows;
    bool has_cursor;  /* According to TERM; otherwise the rows are printed one below the other. */
    bool has_colours; /* According to NO_COLOR. */
    bool has_unicode; /* According to the locale; otherwise a cell of dots is an ASCII character. */
    cell_t *cells;
    char *output;
} screen_t;

/* Keys that are no characters. */
enum {
    KEY_NONE = 0,
    KEY_SUSPEND = 0x1A, /* Ctrl-Z */
    KEY_ESCAPE = 0x1B,
    KEY_LEFT = 0x100,
    KEY_RIGHT,
};

/* Takes over the terminal: alternate screen, no echo, no cursor. Keys come from the terminal even
 * if standard input does not. Returns false if standard output is no terminal. terminal_restore(),
 * or the program's exit, restores it. */
bool terminal_take(void);
void terminal_restore(void);

/* Restores the terminal and stops this program and the others in its pipe; when it is continued,
 * takes over the terminal again. */
void terminal_suspend(void);

/* The key that was pressed, or KEY_NONE. It waits only to distinguish Esc from the arrow keys. */
int terminal_key(void);

/* A screen without a size yet; finds out what the terminal can do. */
screen_t screen_begin(void);

/* Adapts to the terminal's size: true if it has changed; then the screen is empty. If there is no
 * memory, the screen has no rows. */
bool screen_fit(screen_t *screen);
void screen_free(screen_t *screen);
void screen_clear(screen_t *screen);

/* Puts a character, or ASCII text; `plain` takes the character's place where there is no Unicode.
 * Characters outside the screen are left out. */
void screen_put(screen_t *screen, int column, int row, uint16_t character, char plain,
                uint8_t colour);
void screen_text(screen_t *screen, int column, int row, const char *text, uint8_t colour);

/* Puts a dot; (0, 0) is the upper left one. */
void screen_dot(screen_t *screen, int x, int y, layer_t layer, uint8_t colour);

void screen_show(screen_t *screen);

#endif
