/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A terminal's screen, as far as the tool uses one: characters at places, in colours. */

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
    uint8_t colour; /* Of what comes next. */
    unsigned columns, rows;
    unsigned column, row; /* The cursor. */
    bool is_other_screen; /* Not the one on which the user typed the command. */
    bool is_cursor_hidden;
    unsigned taken;         /* How often the other screen has been taken. */
    unsigned escapes;       /* Sequences so far, */
    unsigned coloured;      /* and changes of colour among them. */
    unsigned misunderstood; /* Sequences that it does not know; characters beyond the edge. */
    char sequence[32];      /* Of the escape sequence under way. */
    unsigned sequence_length;
    bool is_in_sequence;
    uint32_t character; /* Of the UTF-8 sequence under way, */
    unsigned missing;   /* and how many bytes of it are still to come. */
} vt_t;

void vt_init(vt_t *vt, unsigned columns, unsigned rows);
void vt_feed(vt_t *vt, const char *bytes, size_t count);

/* The screen as UTF-8 lines without trailing spaces; valid until the next call. */
const char *vt_text(const vt_t *vt);

#endif
