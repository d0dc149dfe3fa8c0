/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Turns a hex dump back into bytes: plain bytes ("AA 55", "0xAA, 0x55", "AA55…"), and the lines of
 * xxd, hexdump, hexdump -C and od -t x1, with their addresses and characters. */

#ifndef HEXDUMP_H
#define HEXDUMP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HEXDUMP_LINE 4096u

typedef struct {
    bool has_addresses; /* The last line, too, which may have nothing else. */
    size_t count;       /* Of the unfinished line. */
    char line[HEXDUMP_LINE];
} hexdump_t;

/* Whether a file that begins so is a hex dump of a lidar's bytes. */
bool hexdump_is(const uint8_t *text, size_t count);

/* Turns text into bytes, in place of the text: the same buffer holds them. The unfinished line is
 * kept; a `count` of 0: it is the last one. Returns how many bytes there are. `bytes` has room for
 * half of a line more. */
size_t hexdump_take(hexdump_t *dump, const uint8_t *text, size_t count, uint8_t *bytes);

#endif
