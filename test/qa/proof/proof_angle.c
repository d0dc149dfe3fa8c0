/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Proves for every FSA and LSA that the angle of each sample is the exact rational value of section
 * 5, rounded to nearest (halves up). Each run has one number of samples, SAMPLES, and one index,
 * INDEX, so that all factors and divisors are constants. */

#include "proof.h"

/* The angle, 0 to 23039, of a field with 16 bits, including the check bit. */
static uint32_t angle_of(uint16_t field)
{
    const uint32_t angle = field >> 1;
    return angle < 23040 ? angle : angle - 23040;
}

void prove_angle(void)
{
    tmini_ring_t ring = any_early_ring(RING_SIZE);
    tmini_frame_t frame = {.ring = &ring};
    tmini_packet_t packet;
    tmini_point_t point;
    const uint16_t fsa = nondet_half();
    const uint16_t lsa = nondet_half();
    const uint32_t index = INDEX;
    frame.header[1] = SAMPLES;
    frame.header[2] = (uint8_t)fsa;
    frame.header[3] = (uint8_t)(fsa >> 8);
    frame.header[4] = (uint8_t)lsa;
    frame.header[5] = (uint8_t)(lsa >> 8);
    tmini_packet_open(&packet, &frame);
    CLAIM(!tmini_packet_point(&packet, SAMPLES, &point));
    (void)tmini_packet_point(&packet, index, &point);
    const uint32_t from = angle_of(fsa);
    const uint32_t to = angle_of(lsa) + (angle_of(lsa) < from ? 23040 : 0);
    const uint32_t intervals = SAMPLES - 1;
    /* The result is the largest integer not above from + index * (to - from) / intervals + 1/2. */
    const uint32_t angle = point.angle_q6 + (point.angle_q6 < from ? 23040u : 0u);
    const uint32_t turned = angle - from;
    const uint32_t twice = 2 * index * (to - from) + intervals;
    CLAIM(point.angle_q6 < 23040);
    CLAIM(2 * intervals * turned <= twice && twice < 2 * intervals * (turned + 1));
}
