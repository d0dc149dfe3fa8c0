/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "limit.h"

#include "tmini/tmini_atomic.h"

#include <string.h>

#define HEADER_SIZE 10u
#define SAMPLE_SIZE 3u
#define FULL_TURN_Q6 23040u
#define HALF 0x8000u /* Half of 1/64 degree. */

static unsigned half_at(const uint8_t *bytes)
{
    return bytes[0] | (unsigned)bytes[1] << 8;
}

/* Returns the angle between two samples, in units of 2^-16 of 1/64 degree. */
static uint32_t step_of(unsigned first, unsigned last, size_t count)
{
    const uint32_t swept = last >= first ? last - first : last + FULL_TURN_Q6 - first;
    return count > 1 ? (swept << 16) / (uint32_t)(count - 1) : 0;
}

/* Stores the samples' points and returns their part of the checksum. */
TMINI_NOINLINE static unsigned store(const uint8_t *sample, size_t count, uint32_t angle,
                                     uint32_t step, limit_point_t *point)
{
    uint32_t sum = 0;
    const limit_point_t *const end = point + count;
    for (; point != end; point++) {
        uint32_t word;
        memcpy(&word, sample, sizeof word);
        sum ^= word;
        const uint16_t pair = word & 0x3FF; /* Intensity and flag. */
        point->angle_q6 = (uint16_t)(angle >> 16);
        point->distance_mm = word >> 10 & 0x3FFF;
        memcpy(&point->intensity, &pair, sizeof pair);
        angle += step;
        sample += SAMPLE_SIZE;
    }
    return (unsigned)((sum ^ sum >> 8) & 0xFF) | (unsigned)(sum >> 16 & 0xFF) << 8;
}

static void wrap(limit_point_t *point, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (point[i].angle_q6 >= FULL_TURN_Q6) {
            point[i].angle_q6 = (uint16_t)(point[i].angle_q6 - FULL_TURN_Q6);
        }
    }
}

size_t limit_decode(const uint8_t *bytes, size_t count, limit_point_t *points)
{
    size_t at = 0;
    while (count - at >= HEADER_SIZE) {
        const uint8_t *const packet = &bytes[at];
        if (half_at(packet) != 0x55AA) {
            at++; /* LastCRC, at the end of a revolution. */
            continue;
        }
        const size_t samples = packet[3];
        if (count - at < HEADER_SIZE + SAMPLE_SIZE * samples) {
            break;
        }
        const unsigned first = half_at(&packet[4]) >> 1;
        const unsigned last = half_at(&packet[6]) >> 1;
        const unsigned sum = store(&packet[HEADER_SIZE], samples, ((uint32_t)first << 16) + HALF,
                                   step_of(first, last, samples), points);
        if (last < first) {
            wrap(points, samples);
        }
        if (sum == (half_at(packet) ^ half_at(&packet[2]) ^ half_at(&packet[4]) ^
                    half_at(&packet[6]) ^ half_at(&packet[8]))) {
            points += samples;
        }
        at += HEADER_SIZE + SAMPLE_SIZE * samples;
    }
    return at;
}
