/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "vt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void clear(vt_t *vt)
{
    for (unsigned row = 0; row < VT_ROWS_MAX; row++) {
        for (unsigned column = 0; column < VT_COLUMNS_MAX; column++) {
            vt->cells[row][column] = ' ';
        }
    }
}

void vt_init(vt_t *vt, unsigned columns, unsigned rows)
{
    memset(vt, 0, sizeof *vt);
    vt->columns = columns;
    vt->rows = rows;
    clear(vt);
}

/* Text may continue in the next line; a picture must not. */
static void wrap(vt_t *vt)
{
    if (vt->column >= vt->columns) {
        vt->misunderstood += vt->is_other_screen ? 1 : 0;
        vt->column = 0;
        vt->row++;
    }
}

/* Only text scrolls, not a picture on the other screen. */
static void scroll(vt_t *vt)
{
    if (vt->row >= vt->rows && !vt->is_other_screen) {
        memmove(vt->cells[0], vt->cells[1], sizeof vt->cells - sizeof vt->cells[0]);
        vt->row--;
    }
}

static void put(vt_t *vt, uint32_t character)
{
    if (character == '\r') {
        vt->column = 0;
    } else if (character == '\n') {
        vt->row++;
        scroll(vt);
    } else {
        wrap(vt);
        scroll(vt);
        if (vt->row < vt->rows) {
            vt->colours[vt->row][vt->column] = vt->colour;
            vt->cells[vt->row][vt->column++] = character;
        }
    }
}

/* Executes a sequence, from the bracket to the last letter. */
static void obey(vt_t *vt)
{
    const char *const sequence = vt->sequence;
    unsigned row = 0;
    unsigned column = 0;
    char letter = 0;
    vt->escapes++;
    if (strcmp(sequence, "[?1049h") == 0 || strcmp(sequence, "[?1049l") == 0) {
        vt->is_other_screen = sequence[6] == 'h';
        vt->taken += vt->is_other_screen ? 1 : 0;
        vt->row = vt->column = 0; /* The user typed the command here. */
        clear(vt);
    } else if (strcmp(sequence, "[?25h") == 0 || strcmp(sequence, "[?25l") == 0) {
        vt->is_cursor_hidden = sequence[4] == 'l';
    } else if (strcmp(sequence, "[2J") == 0) {
        clear(vt);
    } else if (sscanf(sequence, "[%u;%u%c", &row, &column, &letter) == 3 && letter == 'H') {
        vt->row = row - 1;
        vt->column = column - 1;
    } else if (sequence[strlen(sequence) - 1] == 'm') {
        vt->coloured += strncmp(sequence, "[38;5;", 6) == 0 ? 1 : 0;
        vt->colour = (uint8_t)(strncmp(sequence, "[38;5;", 6) == 0 ? atoi(sequence + 6) : 0);
    } else {
        vt->misunderstood++;
    }
}

static void take_sequence(vt_t *vt, char byte)
{
    vt->sequence[vt->sequence_length++] = byte;
    vt->sequence[vt->sequence_length] = '\0';
    const bool is_last = vt->sequence_length > 1 && byte >= '@';
    if (is_last || vt->sequence_length == sizeof vt->sequence - 1) {
        vt->is_in_sequence = false;
        obey(vt);
    }
}

static void take(vt_t *vt, char signed_byte)
{
    const unsigned byte = (unsigned char)signed_byte;
    if (vt->is_in_sequence) {
        take_sequence(vt, signed_byte);
    } else if (byte == 0x1B) {
        vt->is_in_sequence = true;
        vt->sequence_length = 0;
    } else if (byte < 0x80) {
        put(vt, byte);
    } else if (byte >= 0xC0) {
        vt->missing = byte >= 0xE0 ? 2 : 1;
        vt->character = byte & (byte >= 0xE0 ? 0x0Fu : 0x1Fu);
    } else {
        vt->character = vt->character << 6 | (byte & 0x3Fu);
        if (--vt->missing == 0) {
            put(vt, vt->character);
        }
    }
}

void vt_feed(vt_t *vt, const char *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        take(vt, bytes[i]);
    }
}

static char *add_utf8(char *out, uint32_t character)
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

const char *vt_text(const vt_t *vt)
{
    static char text[VT_ROWS_MAX * (3 * VT_COLUMNS_MAX + 1) + 1];
    char *out = text;
    for (unsigned row = 0; row < vt->rows; row++) {
        char *end = out;
        for (unsigned column = 0; column < vt->columns; column++) {
            out = add_utf8(out, vt->cells[row][column]);
            end = vt->cells[row][column] == ' ' ? end : out;
        }
        out = end;
        *out++ = '\n';
    }
    *out = '\0';
    return text;
}
