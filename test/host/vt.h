/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The screen of a terminal, as far as the tool uses it: coloured characters in rows and columns. */

#ifndef VT_H
#define VT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define VT_COLUMNS_MAX 200u
#define VT_ROWS_MAX 100u

typedef struct {
    uint32_t cells[VT_ROWS_MAX][VT_COLUMNS_MAX];
    uint8_t colours[VT_ROWS_MAX][VT_COLUMNS_MAX];
    uint8_t colour; /* Of the next character. */
    unsigned columns, rows;
    unsigned column, row; /* The cursor. */
    bool is_other_screen; /* The alternate screen: the user typed the command on the other. */
    bool is_cursor_hidden;
    unsigned taken;         /* How often the other screen has been used. */
    unsigned escapes;       /* Escape sequences so far. */
    unsigned coloured;      /* Changes of colour so far. */
    unsigned misunderstood; /* Unknown escape sequences, and characters beyond the edge. */
    char sequence[32];      /* The current escape sequence. */
    unsigned sequence_length;
    bool is_in_sequence;
    uint32_t character; /* Of the current UTF-8 sequence. */
    unsigned missing;   /* Bytes of that sequence still to come. */
} vt_t;

void vt_init(vt_t *vt, unsigned columns, unsigned rows);
void vt_feed(vt_t *vt, const char *bytes, size_t count);

/* The screen as UTF-8 lines without trailing spaces; valid until the next call. */
const char *vt_text(const vt_t *vt);

#endif
