/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "corrupt.h"

#include <string.h>

uint8_t corrupt_lookalike(random_t *random)
{
    static const uint8_t likely[] = {0xAA, 0x55, 0xAA, 0x55, 0xA5, 0x5A,
                                     0x00, 0x01, 0x02, 0x03, 0x28, 0x81};
    const uint32_t draw = random_below(random, 2u * sizeof likely);
    return draw < sizeof likely ? likely[draw] : (uint8_t)random_below(random, 256);
}

void corrupt_fill(random_t *random, uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        bytes[i] = corrupt_lookalike(random);
    }
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Uniform in low..high. */
static size_t pick(random_t *random, size_t low, size_t high)
{
    return (size_t)random_between(random, (uint32_t)low, (uint32_t)high);
}

static size_t remove_bytes(uint8_t *bytes, size_t size, size_t at, size_t count)
{
    count = smaller(count, size - at);
    memmove(bytes + at, bytes + at + count, size - at - count);
    return size - count;
}

static size_t insert_bytes(random_t *random, uint8_t *bytes, size_t size, size_t at, size_t count)
{
    memmove(bytes + at + count, bytes + at, size - at);
    corrupt_fill(random, bytes + at, count);
    return size + count;
}

static size_t add_garbage(random_t *random, uint8_t *bytes, size_t size, size_t count,
                          size_t capacity)
{
    count = smaller(count, capacity);
    size = smaller(size, capacity - count);
    return insert_bytes(random, bytes, size, pick(random, 0, size), count);
}

size_t corrupt_once(random_t *random, corrupt_kind_t kind, uint8_t *bytes, size_t size,
                    size_t capacity)
{
    size_t at;
    if (size == 0) {
        return 0;
    }
    at = pick(random, 0, size - 1u);
    switch (kind) {
    case CORRUPT_DROP:
        return remove_bytes(bytes, size, at, 1);
    case CORRUPT_CUT:
        return remove_bytes(bytes, size, at, pick(random, 2, 200));
    case CORRUPT_INSERT:
        return add_garbage(random, bytes, size, 1, capacity);
    case CORRUPT_GARBAGE:
        return add_garbage(random, bytes, size, pick(random, 2, 32), capacity);
    case CORRUPT_BURST:
        corrupt_fill(random, bytes + at, smaller(pick(random, 2, 32), size - at));
        return size;
    default:
        bytes[at] = (uint8_t)(bytes[at] ^ (1u << random_below(random, 8)));
        return size;
    }
}

size_t corrupt_some(random_t *random, unsigned faults, uint8_t *bytes, size_t size, size_t capacity)
{
    for (; faults > 0; faults--) {
        const corrupt_kind_t kind = (corrupt_kind_t)random_below(random, CORRUPT_KINDS);
        size = corrupt_once(random, kind, bytes, size, capacity);
    }
    return size;
}
