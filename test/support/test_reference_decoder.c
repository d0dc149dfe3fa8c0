/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compares the reference decoder's counts and points with values worked out by hand.
 * test_differential.c compares everything else with the parser, test_angles.c all angles with the
 * library. */

#include "known_packets.h"
#include "reference_decoder.h"

#include "unity.h"

#include <string.h>

/* Section 9.14: LastCRC, a start packet of a real unit, an awaited reply. */
static const uint8_t after_it[25] = {0x42, 0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F, 0x00,
                                     0x9E, 0x56, 0x15, 0x54, 0x02, 0xA5, 0x5A, 0x04, 0x00,
                                     0x00, 0x00, 0x04, 0x58, 0x02, 0x00, 0x00};

void test_all_that_is_found_is_counted(void)
{
    static const reference_reply_t awaited = {0, 0x04, 4};
    static const reference_options_t options = {80, &awaited};
    static const reference_counts_t expected = {.packets = 3,
                                                .start_packets = 1,
                                                .points = 39,
                                                .replies = 1,
                                                .bytes = 159,
                                                .bytes_in_packets = 147,
                                                .bytes_in_replies = 11,
                                                .bytes_skipped = 1};
    uint8_t bytes[159];
    memcpy(bytes, manual_packet, 67);
    memcpy(bytes + 67, after_it, 25);
    memcpy(bytes + 92, manual_packet, 67);
    const reference_counts_t counts = reference_decode(bytes, sizeof bytes, &options, NULL, NULL);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &counts, sizeof counts);
}

/* 339.15625 degrees are 21706/64, 0.765625 are 49/64: 1383/64 clockwise in 18 steps. */
void test_the_manuals_points_are_those_of_the_manual(void)
{
    static const struct {
        unsigned index;
        reference_point_t point;
    } expected[] = {{0, {21706, 11842, 1, 0}},
                    {1, {21783, 11819, 1, 0}},
                    {9, {22398, 11121, 1, 0}}, /* 22397.5: halves are rounded up. */
                    {13, {22705, 0, 1, 2}},
                    {18, {49, 11135, 1, 2}}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        const reference_point_t point = reference_point(manual_packet, expected[i].index);
        TEST_ASSERT_EQUAL_UINT16(expected[i].point.angle_q6, point.angle_q6);
        TEST_ASSERT_EQUAL_UINT16(expected[i].point.distance_mm, point.distance_mm);
        TEST_ASSERT_EQUAL_UINT8(expected[i].point.intensity, point.intensity);
        TEST_ASSERT_EQUAL_UINT8(expected[i].point.flag, point.flag);
    }
}
