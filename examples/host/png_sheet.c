/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A sheet that becomes a PNG file: everything is drawn on a canvas at once. */

#include <stdlib.h>

#include "canvas.h"
#include "glyphs.h"
#include "png.h"
#include "sheet.h"

/* Pixels have no groups. */
static void begin(void *self, const char *name)
{
    (void)self;
    (void)name;
}

static void end(void *self)
{
    (void)self;
}

static void box(void *self, spot_t corner, spot_t size, paint_t paint)
{
    canvas_box(self, corner, size, paint);
}

static void line(void *self, spot_t from, spot_t to, const pen_t *pen)
{
    canvas_line(self, from, to, pen);
}

static void ring(void *self, spot_t centre, double radius, const pen_t *pen)
{
    canvas_ring(self, centre, radius, pen);
}

static void disc(void *self, spot_t centre, double radius, paint_t paint)
{
    canvas_disc(self, centre, radius, paint);
}

static void text(void *self, spot_t at, const char *words, const font_t *font)
{
    glyphs_draw(self, at, words, font);
}

static bool save(void *self, const char *path)
{
    return png_save(self, path);
}

static void release(void *self)
{
    if (self != NULL) {
        canvas_free(self);
        free(self);
    }
}

sheet_t png_sheet(unsigned width, unsigned height)
{
    canvas_t *canvas = malloc(sizeof *canvas);
    if (canvas != NULL && !canvas_init(canvas, width, height)) {
        free(canvas);
        canvas = NULL;
    }
    return (sheet_t){canvas, begin, end, box, line, ring, disc, text, save, release};
}
