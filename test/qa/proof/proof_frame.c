/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proofs of frames: any sample is read from its place, and from inside the ring. */

#include "proof.h"

void prove_frame_samples(void)
{
    tmini_ring_t ring = any_ring();
    const tmini_frame_t frame = {.ring = &ring};
    const size_t index = nondet_size();
    const size_t wanted = nondet_size();
    const size_t byte = nondet_size();
    uint8_t joined[TMINI_SAMPLE_SIZE];
    size_t count = wanted;
    ASSUME(index < 255 && wanted >= 1 && wanted <= 255 - index);
    const uint8_t *const samples = tmini_frame_samples(&frame, index, &count, joined);
    CLAIM(count >= 1 && count <= wanted);
    ASSUME(byte < TMINI_SAMPLE_SIZE * count);
    CLAIM(samples[byte] == tmini_ring_peek(&ring, TMINI_SAMPLE_OFFSET(index) + byte));
}

void prove_frame_content(void)
{
    tmini_ring_t ring = any_ring_of(LARGE_RING_SIZE);
    const tmini_frame_t frame = {.ring = &ring};
    uint8_t content[TMINI_INFO_SIZE + 1] = {0};
    const size_t count = nondet_size();
    const size_t index = nondet_size();
    ASSUME(count <= TMINI_INFO_SIZE && index < count);
    const bool is_intact = tmini_frame_content(&frame, content, count);
    CLAIM(content[index] == tmini_ring_peek(&ring, TMINI_REPLY_HEADER_SIZE + index));
    CLAIM(content[count] == 0);
    CLAIM(is_intact == (!tmini_ring_is_dma(&ring) || tmini_ring_ahead(&ring) <= ring.window));
}
