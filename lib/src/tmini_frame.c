/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_frame.h"

/* Multiplies, because small processors have no division; exact below 2048. */
static size_t third_of(size_t bytes)
{
    return (size_t)((uint32_t)bytes * 683u >> 11);
}

const uint8_t *tmini_frame_samples(const tmini_frame_t *frame, size_t index, size_t *count,
                                   uint8_t joined[TMINI_SAMPLE_SIZE])
{
    const size_t wanted = TMINI_SAMPLE_SIZE * *count;
    size_t bytes = wanted;
    const uint8_t *const piece = tmini_ring_piece(frame->ring, TMINI_SAMPLE_OFFSET(index), &bytes);
    if (bytes == wanted) {
        return piece;
    }
    if (bytes < TMINI_SAMPLE_SIZE) {
        *count = 1;
        tmini_ring_copy(frame->ring, TMINI_SAMPLE_OFFSET(index), joined, TMINI_SAMPLE_SIZE);
        return joined;
    }
    *count = third_of(bytes);
    return piece;
}
