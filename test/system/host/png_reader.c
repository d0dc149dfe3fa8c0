/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "png_reader.h"

#include <stdbool.h>
#include <string.h>

#define ROWS_MAX 8000000u

typedef struct {
    const uint8_t *bytes;
    size_t size;
    size_t at; /* In bits. */
    bool ran_out;
} bits_t;

static uint8_t rows[ROWS_MAX];
static uint8_t image[ROWS_MAX];

static uint32_t u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static uint32_t crc_of(const uint8_t *bytes, size_t size)
{
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < 8 * size; i++) {
        const uint32_t bit = (bytes[i / 8] >> i % 8 & 1u) ^ (crc & 1u);
        crc = crc >> 1 ^ (bit != 0 ? 0xEDB88320u : 0);
    }
    return ~crc;
}

static uint32_t adler_of(const uint8_t *bytes, size_t size)
{
    uint64_t a = 1;
    uint64_t b = 0;
    for (size_t i = 0; i < size; i++) {
        a = (a + bytes[i]) % 65521;
        b = (b + a) % 65521;
    }
    return (uint32_t)(b << 16 | a);
}

static unsigned bit(bits_t *bits)
{
    if (bits->at >= 8 * bits->size) {
        bits->ran_out = true;
        return 0;
    }
    const unsigned value = bits->bytes[bits->at / 8] >> bits->at % 8 & 1u;
    bits->at++;
    return value;
}

static unsigned number(bits_t *bits, unsigned count)
{
    unsigned value = 0;
    for (unsigned i = 0; i < count; i++) {
        value |= bit(bits) << i;
    }
    return value;
}

static unsigned code(bits_t *bits, unsigned start, unsigned count)
{
    unsigned value = start;
    for (unsigned i = 0; i < count; i++) {
        value = value << 1 | bit(bits);
    }
    return value;
}

/* RFC 1951, 3.2.6: by the first seven bits it is clear how many there are. */
static unsigned symbol(bits_t *bits)
{
    const unsigned seven = code(bits, 0, 7);
    if (seven < 0x18) {
        return 256 + seven;
    }
    const unsigned eight = code(bits, seven, 1);
    if (eight < 0xC0) {
        return eight - 0x30;
    }
    return eight < 0xC8 ? 280 + eight - 0xC0 : 144 + code(bits, eight, 1) - 0x190;
}

/* RFC 1951, 3.2.5. */
static unsigned run_length(bits_t *bits, unsigned length_symbol)
{
    static const unsigned bases[29] = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                       15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                       67, 83, 99, 115, 131, 163, 195, 227, 258};
    const unsigned index = length_symbol - 257;
    const unsigned extra = index < 8 || index == 28 ? 0 : (index - 4) / 4;
    return bases[index] + number(bits, extra);
}

static unsigned distance(bits_t *bits)
{
    const unsigned index = code(bits, 0, 5);
    const unsigned extra = index < 4 ? 0 : index / 2 - 1;
    const unsigned base = index < 4 ? index + 1 : ((2 + index % 2) << extra) + 1;
    return base + number(bits, extra);
}

/* Returns how many bytes came out, or 0 if something is wrong. */
static size_t inflate_block(bits_t *bits)
{
    size_t size = 0;
    for (unsigned next = symbol(bits); next != 256; next = symbol(bits)) {
        if (bits->ran_out || next > 285 || size + 258 > ROWS_MAX) {
            return 0;
        }
        if (next < 256) {
            rows[size++] = (uint8_t)next;
            continue;
        }
        const unsigned length = run_length(bits, next);
        const unsigned back = distance(bits);
        if (back > size) {
            return 0;
        }
        for (unsigned i = 0; i < length; i++, size++) {
            rows[size] = rows[size - back];
        }
    }
    return size;
}

static const char *inflate(const uint8_t *data, size_t size, size_t expected)
{
    bits_t bits = {.bytes = data, .size = size};
    if (size < 6 || (data[0] << 8 | data[1]) % 31 != 0 || (data[0] & 15) != 8) {
        return "not zlib's format";
    }
    bits.at = 16;
    if (number(&bits, 1) != 1 || number(&bits, 2) != 1) {
        return "not one block with fixed codes";
    }
    if (inflate_block(&bits) != expected) {
        return "not as much data as the image has";
    }
    const size_t end = (bits.at + 7) / 8;
    return end + 4 == size && u32(data + end) == adler_of(rows, expected) ? NULL
                                                                          : "wrong Adler checksum";
}

static const char *unfilter(const png_t *png)
{
    const size_t width = 3 * (size_t)png->width;
    for (size_t y = 0; y < png->height; y++) {
        const uint8_t filter = rows[y * (width + 1)];
        if (filter != 0 && filter != 2) {
            return "a filter that is not used here";
        }
        for (size_t x = 0; x < width; x++) {
            const uint8_t above = filter == 2 && y > 0 ? image[(y - 1) * width + x] : 0;
            image[y * width + x] = (uint8_t)(rows[y * (width + 1) + 1 + x] + above);
        }
    }
    return NULL;
}

/* The next chunk, or NULL if there is none of that type. Steps over it. */
static const uint8_t *chunk(const uint8_t **at, const uint8_t *end, const char *type, size_t *size)
{
    const uint8_t *const begin = *at;
    if (end - begin < 12 || u32(begin) > (size_t)(end - begin) - 12 ||
        memcmp(begin + 4, type, 4) != 0) {
        return NULL;
    }
    *size = u32(begin);
    *at = begin + 12 + *size;
    return u32(begin + 8 + *size) == crc_of(begin + 4, *size + 4) ? begin + 8 : NULL;
}

const char *png_read(const uint8_t *file, size_t size, png_t *png)
{
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10};
    static const uint8_t kind[5] = {8, 2, 0, 0, 0};
    const uint8_t *at = file + 8;
    const uint8_t *const end = file + size;
    size_t count = 0;
    if (size < 8 || memcmp(file, signature, 8) != 0) {
        return "no PNG signature";
    }
    const uint8_t *const header = chunk(&at, end, "IHDR", &count);
    if (header == NULL || count != 13 || memcmp(header + 8, kind, 5) != 0) {
        return "no header, or another kind of image";
    }
    *png = (png_t){u32(header), u32(header + 4), image};
    const uint8_t *const data = chunk(&at, end, "IDAT", &count);
    if (data == NULL) {
        return "no data, or a wrong CRC";
    }
    const char *const trouble =
        inflate(data, count, (3 * (size_t)png->width + 1) * (size_t)png->height);
    if (trouble != NULL) {
        return trouble;
    }
    if (chunk(&at, end, "IEND", &count) == NULL || count != 0 || at != end) {
        return "no proper end";
    }
    return unfilter(png);
}
