/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "truth.h"

#include "unity.h"

#include "reference_decoder.h"

#define POINTS_MAX 400000u

static struct {
    reference_point_t points[POINTS_MAX];
    uint32_t revolutions[POINTS_MAX];
    uint32_t count;
    uint32_t packets;
    uint32_t seen; /* Number of points already found in scans, or skipped. */
} truth;

static void note_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    const unsigned samples = packet->bytes[3]; /* LSN */
    truth.packets++;
    for (unsigned i = 0; i < samples && truth.count < POINTS_MAX; i++) {
        truth.points[truth.count] = reference_point(packet->bytes, i);
        truth.revolutions[truth.count] = packet->revolution;
        truth.count++;
    }
}

sim_observer_t truth_begin(void)
{
    truth.count = 0;
    truth.packets = 0;
    truth.seen = 0;
    return (sim_observer_t){.on_packet = note_packet};
}

uint32_t truth_packets(void)
{
    return truth.packets;
}

static bool is_equal(const reference_point_t *sent, const tmini_point_t *point)
{
    return sent->angle_q6 == point->angle_q6 && sent->distance_mm == point->distance_mm &&
           sent->intensity == point->intensity && sent->flag == point->flag;
}

/* The index of the revolution's first point; the number of points if there is none. */
static uint32_t first_of(uint32_t revolution)
{
    uint32_t i = 0;
    while (i < truth.count && truth.revolutions[i] != revolution) {
        i++;
    }
    return i;
}

void truth_assert_revolution(const tmini_scan_t *scan, uint32_t revolution)
{
    const uint32_t first = first_of(revolution);
    TEST_ASSERT_TRUE_MESSAGE(scan->complete, "the scan is not complete");
    for (uint32_t i = 0; i < scan->count; i++) {
        TEST_ASSERT_TRUE_MESSAGE(first + i < truth.count, "more points than were sent");
        TEST_ASSERT_EQUAL_UINT32(revolution, truth.revolutions[first + i]);
        TEST_ASSERT_TRUE_MESSAGE(is_equal(&truth.points[first + i], &scan->points[i]),
                                 "a point is not as it was sent");
    }
    const uint32_t after = first + scan->count;
    TEST_ASSERT_TRUE_MESSAGE(after >= truth.count || truth.revolutions[after] != revolution,
                             "points are missing");
}

static bool is_revolution_at(const tmini_scan_t *scan, uint32_t first)
{
    const uint32_t after = first + scan->count;
    if (after > truth.count || truth.revolutions[after - 1] != truth.revolutions[first] ||
        (after < truth.count && truth.revolutions[after] == truth.revolutions[first])) {
        return false;
    }
    unsigned i = 0;
    while (i < scan->count && is_equal(&truth.points[first + i], &scan->points[i])) {
        i++;
    }
    return i == scan->count;
}

static bool begins_revolution(uint32_t at)
{
    return at == 0 || truth.revolutions[at - 1] != truth.revolutions[at];
}

void truth_assert_some_revolution(const tmini_scan_t *scan)
{
    uint32_t at = truth.seen;
    TEST_ASSERT_TRUE_MESSAGE(scan->complete && scan->count > 0, "the scan is not complete");
    while (at < truth.count && !(begins_revolution(at) && is_revolution_at(scan, at))) {
        at++;
    }
    TEST_ASSERT_TRUE_MESSAGE(at < truth.count, "it is no revolution");
    truth.seen = at + scan->count;
}

void truth_assert_nothing_invented(const tmini_scan_t *scan)
{
    for (unsigned i = 0; i < scan->count; i++) {
        while (truth.seen < truth.count && !is_equal(&truth.points[truth.seen], &scan->points[i])) {
            truth.seen++;
        }
        TEST_ASSERT_TRUE_MESSAGE(truth.seen < truth.count, "a point was never sent");
        truth.seen++;
    }
}
