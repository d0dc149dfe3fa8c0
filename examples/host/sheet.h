/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Something to draw on: what a picture is made of, whether it becomes an SVG or a PNG file. */

#ifndef SHEET_H
#define SHEET_H

#include <stdbool.h>
#include <stdint.h>

/* A place or a size in pixels; y points down. */
typedef struct {
    double x;
    double y;
} spot_t;

typedef struct {
    uint8_t red, green, blue;
    double alpha; /* 0 transparent to 1 opaque. */
} paint_t;

typedef struct {
    paint_t paint;
    double width;
    bool dotted;
} pen_t;

typedef enum { ALIGN_LEFT, ALIGN_CENTRE, ALIGN_RIGHT } align_t;

typedef struct {
    paint_t paint;
    double size; /* Of the em, in pixels. */
    align_t align;
    bool bold;
} font_t;

/* Draws with the functions below; `self` is the implementation's own. */
typedef struct sheet sheet_t;
struct sheet {
    void *self;
    void (*begin)(void *self,
                  const char *name); /* What follows, until end(), is one named group. */
    void (*end)(void *self);
    void (*box)(void *self, spot_t corner, spot_t size, paint_t paint);
    void (*line)(void *self, spot_t from, spot_t to, const pen_t *pen);
    void (*ring)(void *self, spot_t centre, double radius, const pen_t *pen);
    void (*disc)(void *self, spot_t centre, double radius, paint_t paint);
    /* `at` is on the base line. UTF-8; the PNG has glyphs for ASCII, the degree sign and the middle
     * dot. */
    void (*text)(void *self, spot_t at, const char *text, const font_t *font);
    /* Writes the file. Returns false, with errno set, if that fails. */
    bool (*save)(void *self, const char *path);
    void (*free)(void *self);
};

/* An empty sheet of that many pixels; `self` is NULL if memory is short. */
sheet_t svg_sheet(unsigned width, unsigned height);
sheet_t png_sheet(unsigned width, unsigned height);

#endif
