/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_packet.h"

#include "tmini_packet_header.h"

/* Sample i lies at first + round(i * diff / (count - 1)). `step` is diff / (count - 1) with 17
 * fraction bits, rounded up, and HALF rounds to nearest, halves up. That is exact: after at most
 * 254 steps the rounding up amounts to less than 254 / 2^17 < 1 / (2 * 254), and an exact value
 * that is not yet at the next rounding boundary is at least 1 / (2 * (count - 1)) below it. It
 * cannot overflow: i * diff / (count - 1) <= diff < 23040 < 2^15. */
#define STEP_BITS 17
#define HALF ((uint32_t)1 << (STEP_BITS - 1))

/* FSA or LSA: bit 0 is the check bit. The field allows up to 511 degrees; 360 is 0. */
static uint16_t angle_of(const uint8_t *field)
{
    const unsigned angle = (field[0] | (unsigned)field[1] << 8) >> 1;
    return (uint16_t)(angle < TMINI_TURN_Q6 ? angle : angle - TMINI_TURN_Q6);
}

static uint16_t clockwise_difference(uint16_t from, uint16_t to)
{
    return (uint16_t)(to + (to < from ? TMINI_TURN_Q6 : 0) - from);
}

/* The point of the sample that lies `turned` (17 fraction bits) after the first. The sample is read
 * before the point, which might overlap it for all the compiler knows, is written. */
static inline void decode(tmini_point_t *point, const uint8_t *sample, uint32_t first_angle,
                          uint32_t turned)
{
    const uint8_t intensity = sample[0];
    const unsigned distance_and_flag = sample[1] | (unsigned)sample[2] << 8;
    point->angle_q6 = (uint16_t)(first_angle + (turned >> STEP_BITS));
    point->distance_mm = (uint16_t)(distance_and_flag >> 2);
    point->intensity = intensity;
    point->flag = distance_and_flag & 3u;
}

static void wrap(tmini_point_t *points, size_t count)
{
    for (; count > 0; count--, points++) {
        if (points->angle_q6 >= TMINI_TURN_Q6) {
            points->angle_q6 = (uint16_t)(points->angle_q6 - TMINI_TURN_Q6);
        }
    }
}

void tmini_packet_open(tmini_packet_t *packet, const tmini_parser_t *parser)
{
    packet->first_angle_q6 = angle_of(&parser->header[FSA]);
    packet->last_angle_q6 = angle_of(&parser->header[LSA]);
    packet->ct = parser->header[CT];
    packet->count = parser->header[LSN];
    packet->stray = parser->stray;
    packet->gap = parser->gap;
    packet->parser = parser;
    packet->step = 0;
    if (packet->count > 1) {
        const uint32_t intervals = packet->count - 1u;
        const uint32_t turn = clockwise_difference(packet->first_angle_q6, packet->last_angle_q6);
        packet->step = ((turn << STEP_BITS) + intervals - 1) / intervals;
    }
}

bool tmini_packet_point(const tmini_packet_t *packet, size_t index, tmini_point_t *point)
{
    if (index >= packet->count) {
        return false;
    }
    uint8_t joined[TMINI_SAMPLE_SIZE];
    size_t count = 1;
    const uint8_t *const sample =
        tmini_ring_samples(packet->parser->ring, TMINI_PACKET_SIZE_MAX(index), &count, joined);
    decode(point, sample, packet->first_angle_q6, HALF + (uint32_t)index * packet->step);
    wrap(point, 1);
    return tmini_parser_frame_intact(packet->parser);
}

static void apply_filter(unsigned filter, tmini_point_t *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if ((filter >> points[i].flag & 1u) != 0) {
            points[i].distance_mm = 0;
        }
    }
}

size_t tmini_packet_points(const tmini_packet_t *packet, unsigned filter, tmini_point_t *points,
                           size_t max_points)
{
    const size_t wanted = packet->count < max_points ? packet->count : max_points;
    const uint32_t first_angle = packet->first_angle_q6;
    const uint32_t step = packet->step;
    uint32_t turned = HALF;
    tmini_point_t *point = points;
    for (size_t done = 0; done < wanted;) {
        uint8_t joined[TMINI_SAMPLE_SIZE];
        size_t count = wanted - done;
        const uint8_t *sample =
            tmini_ring_samples(packet->parser->ring, TMINI_PACKET_SIZE_MAX(done), &count, joined);
        done += count;
        for (size_t left = count; left > 0; left--) {
            decode(point++, sample, first_angle, turned);
            sample += TMINI_SAMPLE_SIZE;
            turned += step;
        }
    }
    if (packet->last_angle_q6 < first_angle) {
        wrap(points, wanted);
    }
    if (filter != TMINI_FILTER_NONE) {
        apply_filter(filter, points, wanted);
    }
    return wanted;
}

bool tmini_packet_has_range(const tmini_packet_t *packet)
{
    const tmini_ring_t *const ring = packet->parser->ring;
    for (size_t i = 0; i < packet->count; i++) {
        const size_t sample = TMINI_PACKET_SIZE_MAX(i);
        if (tmini_ring_peek(ring, sample + 1) > 3 || tmini_ring_peek(ring, sample + 2) > 0) {
            return true;
        }
    }
    return false;
}
