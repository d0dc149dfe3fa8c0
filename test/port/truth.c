/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "truth.h"

#include "judge_scan.h"
#include "unity.h"

static sim_judge_t judge;
static uint32_t packets;

static void note_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    (void)sim_judge_sent(&judge, packet);
    packets++;
}

sim_observer_t truth_begin(void)
{
    sim_judge_begin(&judge);
    packets = 0;
    return (sim_observer_t){.on_packet = note_packet};
}

uint32_t truth_packets(void)
{
    return packets;
}

void truth_assert_nothing_invented(const tmini_scan_t *scan)
{
    const unsigned lies = judge_scan(&judge, scan).lies;
    for (unsigned lie = 0; lie < SIM_LIES; lie++) {
        TEST_ASSERT_TRUE_MESSAGE((lies & SIM_LIE(lie)) == 0, sim_lie_name((sim_lie_t)lie));
    }
}

void truth_assert_some_revolution(const tmini_scan_t *scan)
{
    const sim_reading_t reading = judge_scan(&judge, scan);
    TEST_ASSERT_TRUE_MESSAGE(scan->complete && scan->count > 0, "the scan is not complete");
    TEST_ASSERT_EQUAL_HEX_MESSAGE(0, reading.lies, "it is no revolution");
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, reading.missing, "points are missing");
}

void truth_assert_revolution(const tmini_scan_t *scan, uint32_t revolution)
{
    truth_assert_some_revolution(scan);
    TEST_ASSERT_EQUAL_UINT32(revolution, sim_judge_sample(&judge, judge.next - 1)->turn);
}
