/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A sheet that becomes an SVG file: the text of its elements, gathered in memory. */

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sheet.h"

typedef struct {
    unsigned width;
    unsigned height;
    char *text;
    size_t length;
    size_t room;
    bool short_of_memory;
} svg_t;

static bool make_room(svg_t *svg, size_t more)
{
    if (svg->length + more < svg->room) {
        return true;
    }
    const size_t room = 2 * (svg->room + more) + 4096;
    char *const text = realloc(svg->text, room);
    if (text == NULL) {
        svg->short_of_memory = true;
        return false;
    }
    svg->text = text;
    svg->room = room;
    return true;
}

/* Appends up to 511 characters. */
static void append(svg_t *svg, const char *format, ...)
{
    if (!make_room(svg, 512)) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(svg->text + svg->length, 512, format, arguments);
    va_end(arguments);
    svg->length += length < 512 ? (size_t)length : 511;
}

/* Text of any length, with the characters that mean something in XML written as entities, and
 * control characters, which XML has none of, as question marks. */
static void append_escaped(svg_t *svg, const char *text)
{
    for (; *text != '\0'; text++) {
        switch (*text) {
        case '&':
            append(svg, "&amp;");
            break;
        case '<':
            append(svg, "&lt;");
            break;
        case '>':
            append(svg, "&gt;");
            break;
        default:
            append(svg, "%c", (unsigned char)*text < ' ' ? '?' : *text);
            break;
        }
    }
}

static void append_paint(svg_t *svg, const char *attribute, paint_t paint)
{
    append(svg, " %s=\"#%02x%02x%02x\"", attribute, paint.red, paint.green, paint.blue);
    if (paint.alpha < 1) {
        append(svg, " %s-opacity=\"%.3g\"", attribute, paint.alpha);
    }
}

static void append_pen(svg_t *svg, const pen_t *pen)
{
    append_paint(svg, "stroke", pen->paint);
    append(svg, " stroke-width=\"%.4g\"", pen->width);
    if (pen->dotted) {
        append(svg, " stroke-dasharray=\"0 %.4g\" stroke-linecap=\"round\"", 4 * pen->width);
    }
}

static void begin(void *self, const char *name)
{
    append(self, "<g id=\"%s\">\n", name);
}

static void end(void *self)
{
    append(self, "</g>\n");
}

static void box(void *self, spot_t corner, spot_t size, paint_t paint)
{
    append(self, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"", corner.x, corner.y,
           size.x, size.y);
    append_paint(self, "fill", paint);
    append(self, "/>\n");
}

static void line(void *self, spot_t from, spot_t to, const pen_t *pen)
{
    append(self, "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\"", from.x, from.y, to.x,
           to.y);
    append_pen(self, pen);
    append(self, "/>\n");
}

static void ring(void *self, spot_t centre, double radius, const pen_t *pen)
{
    append(self, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"none\"", centre.x, centre.y,
           radius);
    append_pen(self, pen);
    append(self, "/>\n");
}

static void disc(void *self, spot_t centre, double radius, paint_t paint)
{
    append(self, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"", centre.x, centre.y, radius);
    append_paint(self, "fill", paint);
    append(self, "/>\n");
}

static void text(void *self, spot_t at, const char *words, const font_t *font)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    append(self, "<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.4g\" text-anchor=\"%s\"", at.x, at.y,
           font->size, anchors[font->align]);
    append_paint(self, "fill", font->paint);
    append(self, "%s>", font->bold ? " font-weight=\"bold\"" : "");
    append_escaped(self, words);
    append(self, "</text>\n");
}

static bool save(void *self, const char *path)
{
    const svg_t *const svg = self;
    FILE *const file = fopen(path, "w");
    if (file == NULL) {
        return false;
    }
    (void)fprintf(file,
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%u\" "
                  "viewBox=\"0 0 %u %u\" font-family=\"Inter, Helvetica, Arial, sans-serif\">\n",
                  svg->width, svg->height, svg->width, svg->height);
    (void)fwrite(svg->text, 1, svg->length, file);
    (void)fputs("</svg>\n", file);
    const bool failed = ferror(file) != 0;
    return fclose(file) == 0 && !failed && !svg->short_of_memory;
}

static void release(void *self)
{
    svg_t *const svg = self;
    if (svg != NULL) {
        free(svg->text);
        free(svg);
    }
}

sheet_t svg_sheet(unsigned width, unsigned height)
{
    svg_t *const svg = calloc(1, sizeof *svg);
    if (svg != NULL) {
        svg->width = width;
        svg->height = height;
    }
    return (sheet_t){svg, begin, end, box, line, ring, disc, text, save, release};
}
