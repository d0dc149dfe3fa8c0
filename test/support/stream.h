/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A byte stream that a test composes: packets of the independent encoder, replies, garbage. */

#ifndef STREAM_H
#define STREAM_H

#include "encoder.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint8_t *bytes; /* The caller's. */
    size_t size;
    size_t capacity; /* An addition that does not fit is left out whole. */
} stream_t;

/* The sample that stream_add_packet() puts at `index`: 1000 + 7 * index mm, intensity 200 - index,
 * flag index % 4. */
encode_sample_t stream_sample(unsigned index);

void stream_add(stream_t *stream, const uint8_t *bytes, size_t count);
void stream_add_byte(stream_t *stream, uint8_t byte);

/* A valid packet with stream_sample()s; bit 0 of `ct` makes it a start packet. Returns its size. */
size_t stream_add_packet(stream_t *stream, uint8_t ct, uint8_t lsn, uint16_t first_q6,
                         uint16_t last_q6);

#endif
