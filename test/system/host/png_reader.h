/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Reads PNG files as strictly as their specification says, and as narrowly as these tests need: eight
 * bits of red, green and blue, deflate blocks with fixed codes. Shares nothing with the writer. */

#ifndef PNG_READER_H
#define PNG_READER_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint32_t width;
    uint32_t height;
    const uint8_t *pixels; /* Red, green, blue, row by row; valid until the next call. */
} png_t;

/* Returns NULL, or what is wrong with the file. */
const char *png_read(const uint8_t *file, size_t size, png_t *png);

#endif
