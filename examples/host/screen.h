/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A screenful of characters, each in a colour, some of them made of dots: Unicode's braille
 * characters have two columns and four rows of dots, which makes a terminal of 80 x 24 a picture of
 * 160 x 96. */

#ifndef SCREEN_H
#define SCREEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Colours of the 256 that terminals have. */
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

typedef struct {
    unsigned columns;
    unsigned rows;
    cell_t *cells;
    char *output;
    bool has_colours;
    bool has_unicode; /* Otherwise a cell of dots is one character of ASCII. */
    bool has_cursor;  /* Otherwise the rows are printed one below the other. */
} screen_t;

/* Makes the screen that large, and empty. Returns false if memory is short. */
bool screen_resize(screen_t *screen, unsigned columns, unsigned rows);
void screen_free(screen_t *screen);
void screen_clear(screen_t *screen);

/* Puts a character, or ASCII text; `plain` takes the character's place where there is no Unicode.
 * What is outside of the screen is left out. */
void screen_put(screen_t *screen, int column, int row, uint16_t character, char plain,
                uint8_t colour);
void screen_text(screen_t *screen, int column, int row, const char *text, uint8_t colour);

/* Puts a dot; (0, 0) is the upper left one. */
void screen_dot(screen_t *screen, int x, int y, layer_t layer, uint8_t colour);

/* The text that shows the screen on a terminal. Returns its length; valid until the next call. */
size_t screen_render(screen_t *screen, const char **text);

#endif
