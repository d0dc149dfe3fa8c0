/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "deflate.h"

#include <stdlib.h>

#define RUN_MIN 3
#define RUN_MAX 258
#define END_OF_BLOCK 256
#define ADLER_MODULUS 65521u

typedef struct {
    uint8_t *bytes;
    size_t size;
    uint32_t bits; /* Not yet written; the first one is the lowest. */
    unsigned bit_count;
} bit_writer_t;

static void put_bits(bit_writer_t *writer, uint32_t bits, unsigned count)
{
    writer->bits |= bits << writer->bit_count;
    writer->bit_count += count;
    while (writer->bit_count >= 8) {
        writer->bytes[writer->size++] = (uint8_t)writer->bits;
        writer->bits >>= 8;
        writer->bit_count -= 8;
    }
}

/* Huffman codes are written with their highest bit first, everything else with its lowest. */
static void put_code(bit_writer_t *writer, uint32_t code, unsigned count)
{
    uint32_t reversed = 0;
    for (unsigned i = 0; i < count; i++) {
        reversed |= (code >> i & 1u) << (count - 1 - i);
    }
    put_bits(writer, reversed, count);
}

/* The fixed code of a literal, a length or the end of the block (RFC 1951, 3.2.6). */
static void put_symbol(bit_writer_t *writer, unsigned symbol)
{
    if (symbol < 144) {
        put_code(writer, 0x30 + symbol, 8);
    } else if (symbol < 256) {
        put_code(writer, 0x190 + symbol - 144, 9);
    } else if (symbol < 280) {
        put_code(writer, symbol - 256, 7);
    } else {
        put_code(writer, 0xC0 + symbol - 280, 8);
    }
}

/* "Copy `length` bytes from one byte back": the previous byte again and again (RFC 1951, 3.2.5). */
static void put_run(bit_writer_t *writer, unsigned length)
{
    if (length == RUN_MAX) {
        put_symbol(writer, 285);
    } else if (length < 11) {
        put_symbol(writer, 257 + length - RUN_MIN);
    } else {
        const unsigned value = length - RUN_MIN;
        unsigned extra = 1;
        while (value >> (extra + 3) != 0) {
            extra++;
        }
        put_symbol(writer, 257 + 4 * extra + (value >> extra));
        put_bits(writer, value & ((1u << extra) - 1), extra);
    }
    put_code(writer, 0, 5); /* Distance 1. */
}

/* How often bytes[at - 1] is repeated from `at` on. */
static size_t run_length(const uint8_t *bytes, size_t size, size_t at)
{
    size_t length = 0;
    while (at > 0 && length < RUN_MAX && at + length < size &&
           bytes[at + length] == bytes[at - 1]) {
        length++;
    }
    return length;
}

static uint32_t adler32(const uint8_t *bytes, size_t size)
{
    uint32_t low = 1;
    uint32_t high = 0;
    for (size_t i = 0; i < size; i++) {
        low = (low + bytes[i]) % ADLER_MODULUS;
        high = (high + low) % ADLER_MODULUS;
    }
    return high << 16 | low;
}

static void put_block(bit_writer_t *writer, const uint8_t *bytes, size_t size)
{
    put_bits(writer, 1, 1); /* The last block, */
    put_bits(writer, 1, 2); /* with fixed codes. */
    for (size_t at = 0; at < size;) {
        const size_t length = run_length(bytes, size, at);
        if (length >= RUN_MIN) {
            put_run(writer, (unsigned)length);
            at += length;
        } else {
            put_symbol(writer, bytes[at++]);
        }
    }
    put_symbol(writer, END_OF_BLOCK);
    put_bits(writer, 0, 7); /* Completes the last byte. */
}

uint8_t *deflate_zlib(const uint8_t *bytes, size_t size, size_t *compressed_size)
{
    /* No byte takes more than nine bits; header, block header, end and checksum fit in 16 bytes. */
    bit_writer_t writer = {.bytes = malloc(size + size / 8 + 16)};
    if (writer.bytes == NULL) {
        return NULL;
    }
    writer.bytes[writer.size++] = 0x78; /* Deflate with a 32 kB window, */
    writer.bytes[writer.size++] = 0x01; /* and the header's own check bits. */
    put_block(&writer, bytes, size);
    const uint32_t checksum = adler32(bytes, size);
    for (int shift = 24; shift >= 0; shift -= 8) {
        writer.bytes[writer.size++] = (uint8_t)(checksum >> shift);
    }
    *compressed_size = writer.size;
    return writer.bytes;
}
