/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "glyphs.h"

#include <stddef.h>

/* An em has 20 units. A glyph is its width, then strokes: M x y begins one at a place, L x y goes on
 * straight, Q u v x y in a curve that is drawn towards (u, v). A number is one character, 0 to 9 and
 * a (10) to k (20). Upwards, 0 is the descent, 4 the base line, e the height of small letters and i
 * that of capitals. */
static const char *const ascii[95] = {
    "2",                                                       /* space */
    "0M0iL09M04L04",                                           /* ! */
    "4M0iL0eM4iL4e",                                           /* " */
    "9M24L4iM64L8iM0eL9eM08L98",                               /* # */
    "9M8gQ7i4iQ0i0eQ0c4bQ9a97Q9444Q1406M4kL42",                /* $ */
    "bM14LaiM3iQ0i0fQ0c3cQ6c6fQ6i3iM8aQ5a57Q5484Qb4b7Qba8a",   /* % */
    "aMa4L2eQ0i4iQ8i6dL2aQ0807Q0444Q84ab",                     /* & */
    "0M0iL0e",                                                 /* ' */
    "3M3kQ0g0bQ0632",                                          /* ( */
    "3M0kQ3g3bQ3602",                                          /* ) */
    "6M3iL3aM0gL6cM6gL0c",                                     /* * */
    "8M4fL47M0bL8b",                                           /* + */
    "1M15L02",                                                 /* , */
    "6M0aL6a",                                                 /* - */
    "0M04L04",                                                 /* . */
    "6M02L6k",                                                 /* / */
    "8M4iQ0i0bQ0444Q848bQ8i4i",                                /* 0 */
    "8M1fL5iL54",                                              /* 1 */
    "8M0fQ0i4iQ8i8eQ8b04L84",                                  /* 2 */
    "8M0gQ1i4iQ7i7eQ7b3bQ8b87Q8444Q1406",                      /* 3 */
    "8M64L6iL08L88",                                           /* 4 */
    "8M7iL1iL0bQ1d4dQ8d88Q8444Q1406",                          /* 5 */
    "8M7hQ6i5iQ0i08Q0444Q8488Q8c4cQ0c08",                      /* 6 */
    "8M0iL8iL34",                                              /* 7 */
    "8M4iQ0i0fQ0b4bQ8b8fQ8i4iM4bQ0b07Q0444Q8487Q8b4b",         /* 8 */
    "8M15Q2434Q848eQ8i4iQ0i0eQ0a4aQ8a8e",                      /* 9 */
    "0M04L04M0cL0c",                                           /* : */
    "1M1cL1cM15L02",                                           /* ; */
    "8M8fL0bL87",                                              /* < */
    "8M0dL8dM09L89",                                           /* = */
    "8M0fL8bL07",                                              /* > */
    "7M0fQ0i3iQ7i7fQ7c3aL39M34L34",                            /* ? */
    "cM8eL87Qc6cbQci6iQ0i0bQ0464Qa4b5M8aQ8e6eQ4e4aQ4767Q878a", /* @ */
    "aM04L5iLa4M29L89",                                        /* A */
    "9M0bL5bQ9b97Q9454L04L0iL4iQ8i8eQ8b4b",                    /* B */
    "aMagQ8i5iQ0i0bQ0454Q84a6",                                /* C */
    "aM04L0iL4iQaiabQa444L04",                                 /* D */
    "8M8iL0iL04L84M0bL7b",                                     /* E */
    "8M8iL0iL04M0bL7b",                                        /* F */
    "aMagQ8i5iQ0i0bQ0454Qa4a9LabL6b",                          /* G */
    "aM04L0iMa4LaiM0bLab",                                     /* H */
    "0M04L0i",                                                 /* I */
    "6M6iL68Q6434Q0407",                                       /* J */
    "9M04L0iM9iL0aM3dL94",                                     /* K */
    "8M0iL04L84",                                              /* L */
    "cM04L0iL69LciLc4",                                        /* M */
    "aM04L0iLa4Lai",                                           /* N */
    "cM6iQ0i0bQ0464Qc4cbQci6i",                                /* O */
    "9M04L0iL5iQ9i9eQ9a5aL0a",                                 /* P */
    "cM6iQ0i0bQ0464Qc4cbQci6iM88Lc3",                          /* Q */
    "9M04L0iL5iQ9i9eQ9a5aL0aM5aL94",                           /* R */
    "9M8gQ7i4iQ0i0eQ0c4bQ9a97Q9444Q1406",                      /* S */
    "aM0iLaiM5iL54",                                           /* T */
    "aM0iL09Q0454Qa4a9Lai",                                    /* U */
    "aM0iL54Lai",                                              /* V */
    "eM0iL44L7gLa4Lei",                                        /* W */
    "aM04LaiM0iLa4",                                           /* X */
    "aM0iL5bLaiM5bL54",                                        /* Y */
    "9M0iL9iL04L94",                                           /* Z */
    "3M3kL0kL02L32",                                           /* [ */
    "6M0kL62",                                                 /* \ */
    "3M0kL3kL32L02",                                           /* ] */
    "6M0eL3iL6e",                                              /* ^ */
    "8M02L82",                                                 /* _ */
    "2M0iL2g",                                                 /* ` */
    "8M8eL84M4eQ0e09Q0444Q8489Q8e4e",                          /* a */
    "8M0iL04M4eQ0e09Q0444Q8489Q8e4e",                          /* b */
    "8M8cQ7e4eQ0e09Q0444Q7486",                                /* c */
    "8M8iL84M4eQ0e09Q0444Q8489Q8e4e",                          /* d */
    "8M09L89Q8e4eQ0e09Q0444Q7486",                             /* e */
    "5M5iQ2i2fL24M0eL5e",                                      /* f */
    "8M8eL84Q8040Q1011M4eQ0e09Q0444Q8489Q8e4e",                /* g */
    "8M0iL04M09Q0e4eQ8e89L84",                                 /* h */
    "0M0eL04M0iL0i",                                           /* i */
    "3M3eL33Q3000M3iL3i",                                      /* j */
    "7M0iL04M7eL08M39L74",                                     /* k */
    "2M0iL06Q0424",                                            /* l */
    "cM0eL04M09Q0e3eQ6e69L64M69Q6e9eQcec9Lc4",                 /* m */
    "8M0eL04M09Q0e4eQ8e89L84",                                 /* n */
    "8M4eQ0e09Q0444Q8489Q8e4e",                                /* o */
    "8M0eL00M4eQ0e09Q0444Q8489Q8e4e",                          /* p */
    "8M8eL80M4eQ0e09Q0444Q8489Q8e4e",                          /* q */
    "5M0eL04M09Q0e5e",                                         /* r */
    "7M6cQ5e3eQ0e0cQ0a39Q7877Q7434Q1406",                      /* s */
    "5M2hL27Q2454M0eL5e",                                      /* t */
    "8M0eL09Q0444Q8489M8eL84",                                 /* u */
    "8M0eL44L8e",                                              /* v */
    "cM0eL34L6dL94Lce",                                        /* w */
    "8M0eL84M8eL04",                                           /* x */
    "8M0eL44M8eL42Q3010",                                      /* y */
    "7M0eL7eL04L74",                                           /* z */
    "4M4kQ2k2gQ2b0bQ2b26Q2242",                                /* { */
    "0M0kL02",                                                 /* | */
    "4M0kQ2k2gQ2b4bQ2b26Q2202",                                /* } */
    "8M0aQ2d4bQ698c",                                          /* ~ */
};
static const char *const degree_sign = "4M2iQ0i0gQ0e2eQ4e4gQ4i2i";
static const char *const middle_dot = "0M0bL0b";

#define EM 20.0
#define BASE_LINE 4
#define SPACING 4
#define CURVE_PIECES 6

static int number(char character)
{
    return character >= 'a' ? character - 'a' + 10 : character - '0';
}

/* The glyph of the next character of a text, which is stepped over. */
static const char *next_glyph(const char **text)
{
    const unsigned char first = (unsigned char)*(*text)++;
    if (first >= ' ' && first < 127) {
        return ascii[first - ' '];
    }
    const unsigned char second = (unsigned char)**text;
    while (((unsigned char)**text & 0xC0u) == 0x80u) {
        (*text)++; /* The rest of a character of several bytes. */
    }
    if (first == 0xC2 && second == 0xB0) {
        return degree_sign;
    }
    return first == 0xC2 && second == 0xB7 ? middle_dot : ascii['?' - ' '];
}

static double width_of(const char *text, double size)
{
    int units = -SPACING;
    while (*text != '\0') {
        units += number(next_glyph(&text)[0]) + SPACING;
    }
    return units * size / EM;
}

static spot_t place(spot_t origin, double unit, const char *coordinates)
{
    return (spot_t){origin.x + unit * number(coordinates[0]),
                    origin.y - unit * (number(coordinates[1]) - BASE_LINE)};
}

static spot_t between(spot_t from, spot_t to, double share)
{
    return (spot_t){from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
}

/* A quadratic Bézier curve, in straight pieces. */
static void draw_curve(canvas_t *canvas, spot_t from, spot_t towards, spot_t to, const pen_t *pen)
{
    spot_t here = from;
    for (int i = 1; i <= CURVE_PIECES; i++) {
        const double share = (double)i / CURVE_PIECES;
        const spot_t next =
            between(between(from, towards, share), between(towards, to, share), share);
        canvas_line(canvas, here, next, pen);
        here = next;
    }
}

static void draw_glyph(canvas_t *canvas, spot_t origin, double unit, const char *stroke,
                       const pen_t *pen)
{
    spot_t here = origin;
    while (*stroke != '\0') {
        const char kind = *stroke++;
        if (kind == 'Q') {
            const spot_t towards = place(origin, unit, stroke);
            const spot_t to = place(origin, unit, stroke + 2);
            draw_curve(canvas, here, towards, to, pen);
            here = to;
            stroke += 4;
        } else {
            const spot_t to = place(origin, unit, stroke);
            if (kind == 'L') {
                canvas_line(canvas, here, to, pen);
            }
            here = to;
            stroke += 2;
        }
    }
}

void glyphs_draw(canvas_t *canvas, spot_t at, const char *text, const font_t *font)
{
    const double unit = font->size / EM;
    const pen_t pen = {font->paint, unit * (font->bold ? 2.6 : 1.7), false};
    if (font->align != ALIGN_LEFT) {
        at.x -= width_of(text, font->size) / (font->align == ALIGN_CENTRE ? 2 : 1);
    }
    while (*text != '\0') {
        const char *const glyph = next_glyph(&text);
        draw_glyph(canvas, at, unit, glyph + 1, &pen);
        at.x += unit * (number(glyph[0]) + SPACING);
    }
}
