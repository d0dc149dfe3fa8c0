/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Interpolated angles against the exact rational value (section 5), for every number of samples and
 * every difference of the two angles: 5.9 million packets, 750 million samples. Each run takes one
 * packet in sixteen, and all of them with TMINI_TEST_EFFORT=16 or more. */

#include "effort.h"
#include "encoder.h"
#include "receiver.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define FULL_TURN 23040u
#define PACKETS_IN_ONE_RUN 16u

static uint8_t memory[2048];
static uint8_t bytes[ENCODE_PACKET_MAX];
static receiver_t receiver;
static tmini_point_t points[255];

void setUp(void)
{
    receiver_open(&receiver, memory, sizeof memory, 255);
    memset(bytes, 0, sizeof bytes);
}

static void read_packet(unsigned count, uint16_t first, unsigned difference)
{
    const encode_packet_t packet = {
        .lsn = (uint8_t)count,
        .first_q6 = first,
        .last_q6 = (uint16_t)((first + difference) % FULL_TURN),
    };
    encode_packet_header(bytes, &packet);
    encode_seal(bytes);
    receiver_feed(&receiver, bytes, ENCODE_PACKET_HEADER + ENCODE_SAMPLE_SIZE * count);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next(&receiver));
    TEST_ASSERT_EQUAL_UINT(count, tmini_packet_points(&receiver.packet, 0, points, 255));
}

/* first + index * difference / intervals, rounded to nearest, halves up. */
static uint16_t exact(uint16_t first, unsigned difference, unsigned index, unsigned intervals)
{
    const uint32_t turned = (2u * index * difference + intervals) / (2u * intervals);
    return (uint16_t)((first + turned) % FULL_TURN);
}

static void expect_exact_angles(unsigned count, uint16_t first, unsigned difference)
{
    for (unsigned i = 0; i < count; i++) {
        const uint16_t expected = exact(first, difference, i, count - 1);
        if (points[i].angle_q6 != expected) { /* An assertion per angle would take too long. */
            printf("%u samples, difference %u, sample %u\n", count, difference, i);
            TEST_ASSERT_EQUAL_UINT16(expected, points[i].angle_q6);
        }
    }
}

void test_every_angle_is_the_exact_value_rounded_to_nearest(void)
{
    const unsigned stride = effort() < PACKETS_IN_ONE_RUN ? PACKETS_IN_ONE_RUN / effort() : 1;
    for (unsigned count = 2; count <= 255; count++) {
        const unsigned begin = (count + effort_seed()) % stride;
        for (unsigned difference = begin; difference < FULL_TURN; difference += stride) {
            const uint16_t first = (uint16_t)((difference * 7u + count * 31u) % FULL_TURN);
            read_packet(count, first, difference);
            expect_exact_angles(count, first, difference);
        }
    }
}
