/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_packet.h"

#include "tmini_packet_header.h"

/* Sample i lies at first + round(i * diff / (count - 1)). `step` is diff / (count - 1) with 17
 * fraction bits, rounded up, and HALF rounds to nearest, halves up. The result is exact: after at
 * most 254 steps the rounding up amounts to less than 254 / 2^17 < 1 / (2 * 254), and an exact
 * value that is not yet at the next rounding boundary is at least 1 / (2 * (count - 1)) below it.
 * Angles are counted modulo 2^15, more than a full circle, so that they fit in a word with their
 * fraction. */
#define STEP_BITS 17
#define HALF ((uint32_t)1 << (STEP_BITS - 1))
#define ANGLES ((uint32_t)1 << (32 - STEP_BITS))

/* FSA or LSA: bit 0 is the check bit. The field can hold up to 511 degrees; from 360 on, a full
 * circle is subtracted. */
static uint16_t angle_of(const uint8_t *field)
{
    const unsigned angle = (field[0] | (unsigned)field[1] << 8) >> 1;
    return (uint16_t)(angle < TMINI_FULL_CIRCLE_Q6 ? angle : angle - TMINI_FULL_CIRCLE_Q6);
}

/* In a sample's second byte, the lowest bits are the flag and the others distance (section 5). */
#define FLAG_MASK 3u
#define FLAG_BITS 2

/* Angle and distance are neighbours, and so are intensity and flag: each pair is stored at once. */
typedef char members_are_neighbours[offsetof(tmini_point_t, angle_q6) == 0 &&
                                            offsetof(tmini_point_t, distance_mm) == 2 &&
                                            offsetof(tmini_point_t, flag) ==
                                                offsetof(tmini_point_t, intensity) + 1
                                        ? 1
                                        : -1];

/* Fills a point from a sample. Intensity and flag are neighbours in both, so they are copied in one
 * access where any address is allowed. The sample is read first, because the compiler must assume
 * that the point overlaps it. */
static inline void set_point(tmini_point_t *point, uint32_t angle_q6, const uint8_t *sample)
{
    const unsigned distance_and_flag = sample[1] | (unsigned)sample[2] << 8;
#if TMINI_WORD_ALIGNMENT == 1
    tmini_copy_pair((uint8_t *)point + offsetof(tmini_point_t, intensity), sample, FLAG_MASK);
    tmini_store_two((uint8_t *)point, angle_q6, (uint32_t)distance_and_flag << (16 - FLAG_BITS));
#else
    const uint8_t intensity = sample[0];
    *point = (tmini_point_t){.angle_q6 = (uint16_t)angle_q6,
                             .distance_mm = (uint16_t)(distance_and_flag >> FLAG_BITS),
                             .intensity = intensity,
                             .flag = distance_and_flag & FLAG_MASK};
#endif
}

/* Decodes `count` contiguous samples (at least one), beginning with sample `index` of the packet.
 * The library's innermost loop: a separate function, so that all its variables stay in
 * registers. */
TMINI_NOINLINE static void decode(const tmini_packet_t *packet, size_t index, const uint8_t *sample,
                                  size_t count, tmini_point_t *point)
{
    const uint32_t step = packet->step;
    uint32_t angle =
        ((uint32_t)packet->first_angle_q6 << STEP_BITS) + HALF + (uint32_t)index * step;
    TMINI_UNROLL
    do {
        set_point(point, angle >> STEP_BITS, sample);
        sample += TMINI_SAMPLE_SIZE;
        point++;
        angle += step;
    } while (--count > 0);
}

/* Brings the angles of a packet that begins at `first_q6` below a full circle. Angles below
 * `first_q6` have wrapped at ANGLES, which is more than a full circle. */
static void wrap(uint16_t first_q6, tmini_point_t *points, size_t count)
{
    for (; count > 0; count--, points++) {
        const uint16_t angle_q6 = points->angle_q6;
        if (angle_q6 < first_q6) {
            points->angle_q6 = (uint16_t)(angle_q6 + (ANGLES - TMINI_FULL_CIRCLE_Q6));
        } else if (angle_q6 >= TMINI_FULL_CIRCLE_Q6) {
            points->angle_q6 = (uint16_t)(angle_q6 - TMINI_FULL_CIRCLE_Q6);
        }
    }
}

void tmini_packet_open(tmini_packet_t *packet, const tmini_frame_t *frame)
{
    packet->first_angle_q6 = angle_of(&frame->header[FSA]);
    packet->last_angle_q6 = angle_of(&frame->header[LSA]);
    packet->ct = frame->header[CT];
    packet->count = frame->header[LSN];
    packet->gap = frame->gap;
    packet->frame = frame;
    const uint32_t intervals = packet->count - 1u;
    const uint32_t swept = tmini_clockwise(packet->first_angle_q6, packet->last_angle_q6);
    packet->step = intervals > 0 ? ((swept << STEP_BITS) + intervals - 1) / intervals : 0;
}

bool tmini_packet_point(const tmini_packet_t *packet, size_t index, tmini_point_t *point)
{
    if (index >= packet->count) {
        return false;
    }
    uint8_t joined[TMINI_SAMPLE_SIZE];
    size_t count = 1;
    decode(packet, index, tmini_frame_samples(packet->frame, index, &count, joined), 1, point);
    wrap(packet->first_angle_q6, point, 1);
    return tmini_frame_intact(packet->frame);
}

static void apply_filter(unsigned filter, tmini_point_t *points, size_t count)
{
    for (; count > 0; count--, points++) {
        if ((filter >> points->flag & 1u) != 0) {
            points->distance_mm = 0;
        }
    }
}

size_t tmini_packet_points(const tmini_packet_t *packet, unsigned filter, tmini_point_t *points,
                           size_t max_points)
{
    const size_t wanted = packet->count < max_points ? packet->count : max_points;
    for (size_t done = 0; done < wanted;) {
        uint8_t joined[TMINI_SAMPLE_SIZE];
        size_t count = wanted - done;
        const uint8_t *const samples = tmini_frame_samples(packet->frame, done, &count, joined);
        decode(packet, done, samples, count, &points[done]);
        done += count;
    }
    if (packet->last_angle_q6 < packet->first_angle_q6) {
        wrap(packet->first_angle_q6, points, wanted);
    }
    if (filter != TMINI_FILTER_NONE) {
        apply_filter(filter, points, wanted);
    }
    return wanted;
}

bool tmini_packet_has_range(const tmini_packet_t *packet)
{
    const tmini_frame_t *const frame = packet->frame;
    size_t distance = TMINI_SAMPLE_OFFSET(0) + 1;
    for (unsigned left = packet->count; left > 0; left--) {
        if (tmini_frame_peek(frame, distance) > FLAG_MASK ||
            tmini_frame_peek(frame, distance + 1) > 0) {
            return true;
        }
        distance += TMINI_SAMPLE_SIZE;
    }
    return false;
}
