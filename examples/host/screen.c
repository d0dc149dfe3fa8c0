/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "screen.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BRAILLE 0x2800u

/* A cell takes a change of colour and a character of three bytes at most; a row's end a little
 * more. */
#define CELL_SIZE 16u
#define ROW_SIZE 32u

bool screen_resize(screen_t *screen, unsigned columns, unsigned rows)
{
    free(screen->cells);
    free(screen->output);
    screen->columns = columns;
    screen->rows = rows;
    screen->cells = calloc((size_t)columns * rows, sizeof *screen->cells);
    screen->output = malloc((size_t)rows * ((size_t)columns * CELL_SIZE + ROW_SIZE) + ROW_SIZE);
    if (screen->cells == NULL || screen->output == NULL) {
        screen_free(screen);
        return false;
    }
    screen_clear(screen);
    return true;
}

void screen_free(screen_t *screen)
{
    free(screen->cells);
    free(screen->output);
    *screen = (screen_t){0};
}

void screen_clear(screen_t *screen)
{
    for (size_t i = 0; i < (size_t)screen->columns * screen->rows; i++) {
        screen->cells[i] = (cell_t){' ', COLOUR_PLAIN, LAYER_NONE};
    }
}

static cell_t *cell_at(const screen_t *screen, int column, int row)
{
    if (column < 0 || row < 0 || (unsigned)column >= screen->columns ||
        (unsigned)row >= screen->rows) {
        return NULL;
    }
    return &screen->cells[(size_t)row * screen->columns + (size_t)column];
}

void screen_put(screen_t *screen, int column, int row, uint16_t character, char plain,
                uint8_t colour)
{
    cell_t *const cell = cell_at(screen, column, row);
    if (cell != NULL) {
        const uint16_t put = screen->has_unicode ? character : (unsigned char)plain;
        *cell = (cell_t){put, colour, LAYER_TEXT};
    }
}

void screen_text(screen_t *screen, int column, int row, const char *text, uint8_t colour)
{
    for (; *text != '\0'; text++) {
        const unsigned char character = (unsigned char)*text;
        const char put = character >= ' ' && character < 127 ? *text : '?';
        screen_put(screen, column++, row, (uint16_t)put, put, colour);
    }
}

/* Which bit of a braille character is which dot (the lowest row of dots came later). */
static uint16_t braille_bit(int x, int y)
{
    static const uint8_t bits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    return bits[y][x];
}

void screen_dot(screen_t *screen, int x, int y, layer_t layer, uint8_t colour)
{
    cell_t *const cell = x >= 0 && y >= 0 ? cell_at(screen, x / 2, y / 4) : NULL;
    if (cell == NULL || cell->layer > layer) {
        return;
    }
    if (cell->layer < layer) {
        *cell = (cell_t){BRAILLE, colour, (uint8_t)layer};
    }
    if (screen->has_unicode) {
        cell->character |= braille_bit(x % 2, y % 4);
    } else {
        cell->character = layer == LAYER_GRID ? '.' : '*';
    }
    cell->colour = colour;
}

static char *put_utf8(char *out, unsigned character)
{
    if (character < 0x80) {
        *out++ = (char)character;
    } else if (character < 0x800) {
        *out++ = (char)(0xC0u | character >> 6);
        *out++ = (char)(0x80u | (character & 0x3Fu));
    } else {
        *out++ = (char)(0xE0u | character >> 12);
        *out++ = (char)(0x80u | (character >> 6 & 0x3Fu));
        *out++ = (char)(0x80u | (character & 0x3Fu));
    }
    return out;
}

/* A row without a cursor ends with its last character. */
static unsigned width_of(const screen_t *screen, unsigned row)
{
    unsigned width = screen->columns;
    while (!screen->has_cursor && width > 0 &&
           cell_at(screen, (int)width - 1, (int)row)->character == ' ') {
        width--;
    }
    return width;
}

size_t screen_render(screen_t *screen, const char **text)
{
    char *out = screen->output;
    int colour = -1;
    for (unsigned row = 0; row < screen->rows; row++) {
        out += screen->has_cursor ? sprintf(out, "\033[%u;1H", row + 1) : 0;
        const unsigned width = width_of(screen, row);
        for (unsigned column = 0; column < width; column++) {
            const cell_t *const cell = cell_at(screen, (int)column, (int)row);
            if (screen->has_colours && cell->character != ' ' && cell->colour != colour) {
                colour = cell->colour;
                out += sprintf(out, "\033[38;5;%dm", colour);
            }
            out = put_utf8(out, cell->character);
        }
        out += screen->has_cursor ? 0 : sprintf(out, "\n");
    }
    *text = screen->output;
    return (size_t)(out - screen->output);
}
