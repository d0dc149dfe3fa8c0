/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "png.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "deflate.h"

enum { FILTER_UP = 2, COLOUR_RGB = 2 };

static uint32_t crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
        }
    }
    return crc;
}

static void put_u32(uint8_t *out, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        out[i] = (uint8_t)(value >> (24 - 8 * i));
    }
}

/* Length, type, data, and a CRC-32 over type and data. */
static void write_chunk(FILE *file, const char *type, const uint8_t *data, size_t size)
{
    uint8_t head[8];
    uint8_t tail[4];
    put_u32(head, (uint32_t)size);
    memcpy(head + 4, type, 4);
    put_u32(tail, ~crc32(crc32(0xFFFFFFFFu, head + 4, 4), data, size));
    (void)fwrite(head, 1, sizeof head, file);
    (void)fwrite(data, 1, size, file);
    (void)fwrite(tail, 1, sizeof tail, file);
}

/* Each row as its difference from the row above, behind a byte that says so: mostly zeros. */
static uint8_t *filter_rows(const canvas_t *canvas, size_t *size)
{
    const size_t row_size = 3 * (size_t)canvas->width;
    *size = (row_size + 1) * canvas->height;
    uint8_t *const rows = malloc(*size);
    uint8_t *out = rows;
    for (size_t y = 0; rows != NULL && y < canvas->height; y++) {
        const uint8_t *const row = canvas->pixels + y * row_size;
        *out++ = FILTER_UP;
        for (size_t i = 0; i < row_size; i++) {
            *out++ = (uint8_t)(row[i] - (y > 0 ? row[i - row_size] : 0));
        }
    }
    return rows;
}

static void write_file(FILE *file, const canvas_t *canvas, const uint8_t *data, size_t size)
{
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    uint8_t header[13] = {[8] = 8 /* bits a colour */, [9] = COLOUR_RGB};
    put_u32(header, canvas->width);
    put_u32(header + 4, canvas->height);
    (void)fwrite(signature, 1, sizeof signature, file);
    write_chunk(file, "IHDR", header, sizeof header);
    write_chunk(file, "IDAT", data, size);
    write_chunk(file, "IEND", header, 0);
}

static bool write_png(const canvas_t *canvas, const char *path, const uint8_t *data, size_t size)
{
    FILE *const file = fopen(path, "wb");
    if (file == NULL) {
        return false;
    }
    write_file(file, canvas, data, size);
    const bool failed = ferror(file) != 0;
    return fclose(file) == 0 && !failed;
}

bool png_save(const canvas_t *canvas, const char *path)
{
    size_t row_size = 0;
    uint8_t *const rows = filter_rows(canvas, &row_size);
    size_t size = 0;
    uint8_t *const data = rows != NULL ? deflate_zlib(rows, row_size, &size) : NULL;
    const bool saved = data != NULL && write_png(canvas, path, data, size);
    free(data);
    free(rows);
    return saved;
}
