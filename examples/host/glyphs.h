/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Letters as strokes, so that they are smooth at any size and a picture needs no font file. */

#ifndef GLYPHS_H
#define GLYPHS_H

#include "canvas.h"

/* Draws UTF-8 text; `at` is on the base line. Characters without a glyph show as "?". */
void glyphs_draw(canvas_t *canvas, spot_t at, const char *text, const font_t *font);

#endif
