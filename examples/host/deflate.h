/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compression in zlib's format (RFC 1950 and 1951): one block with the fixed codes, in which runs
 * of a repeated byte are shortened. That is all that a filtered drawing needs: most of it is runs of
 * zeros. */

#ifndef DEFLATE_H
#define DEFLATE_H

#include <stddef.h>
#include <stdint.h>

/* Returns the compressed bytes, to be released with free(), and their number in `*compressed_size`.
 * NULL if memory is short. */
uint8_t *deflate_zlib(const uint8_t *bytes, size_t size, size_t *compressed_size);

#endif
