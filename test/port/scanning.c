/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "scanning.h"

#include "unity.h"

#include "irq_lines.h"
#include "judge_scan.h"
#include "machine.h"

#define ENOUGH_POINTS 2000u
#define PATIENCE_US 10000000u
#define BYTES_PER_MS 13u /* Sent by a scanning lidar (section 1). */
#define PLACES 150u
#define CATCH_UP 6u   /* Scans in one second. */
#define PARTS_MAX 24u /* Most incomplete scans after the worst disturbance. */

tmini_t lidar;

static uint8_t rx[1024] __attribute__((aligned(32)));
static tmini_point_t points[ENOUGH_POINTS];
static scanning_t program;
static sim_judge_t judge;
static uint32_t sent_packets;

static void note_packet(void *context, const sim_packet_t *packet)
{
    (void)context;
    (void)sim_judge_sent(&judge, packet);
    sent_packets++;
}

sim_observer_t truth_begin(void)
{
    sim_judge_begin(&judge);
    sent_packets = 0;
    return (sim_observer_t){.on_packet = note_packet};
}

uint32_t truth_packets(void)
{
    return sent_packets;
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

void scanning_begin(const scanning_t *the_program, size_t rx_size)
{
    program = *the_program;
    const tmini_config_t config = {
        .port = program.port,
        .port_context = program.context,
        .rx_buffer = rx,
        .rx_size = rx_size,
        .rx_dma = program.rx_dma,
        .points = points,
        .max_points = ENOUGH_POINTS,
    };
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
}

void poll_all(void)
{
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
}

void poll_until(tmini_event_t wanted)
{
    const uint64_t begun_us = machine.now_us;
    while (machine.now_us - begun_us < PATIENCE_US) {
        const tmini_event_t event = tmini_poll(&lidar);
        if (event == wanted) {
            return;
        }
        if (event == TMINI_EVENT_NONE) {
            program.wait();
        }
    }
    TEST_FAIL_MESSAGE("it did not happen in time");
}

void assert_true_scans(uint32_t first, uint32_t last)
{
    for (uint32_t revolution = first; revolution <= last; revolution++) {
        poll_until(TMINI_EVENT_SCAN);
        truth_assert_revolution(tmini_scan(&lidar), revolution);
    }
}

unsigned scans_until_complete(void)
{
    for (unsigned scans = 1; scans <= PARTS_MAX; scans++) {
        poll_until(TMINI_EVENT_SCAN);
        if (tmini_scan(&lidar)->complete) {
            truth_assert_some_revolution(tmini_scan(&lidar));
            return scans;
        }
        truth_assert_nothing_invented(tmini_scan(&lidar));
    }
    TEST_FAIL_MESSAGE("no scan is complete any more");
    return 0;
}

void assert_gap(void)
{
    TEST_ASSERT_NOT_EQUAL_UINT(1, scans_until_complete());
}

void assert_recovery(void)
{
    poll_until(TMINI_EVENT_LOST);
    poll_until(TMINI_EVENT_RECOVERED);
    (void)scans_until_complete();
}

static void pass_some_time(void)
{
    machine_pass(300); /* Too short to fill a FIFO of 16 bytes. */
}

void assert_true_scans_wherever_bytes_come(void)
{
    random_t random;
    uint32_t revolution = 1;
    random_seed(&random, 1);
    for (uint32_t place = 0; place < PLACES; place = irq_next_place(&random, place)) {
        irq_happen_after(place, pass_some_time);
        assert_true_scans(revolution, revolution);
        revolution++;
    }
}

/* After each pause, the program has CATCH_UP + 1 scans to read all waiting bytes. */
void assert_pauses_cost_no_scan(uint32_t bytes)
{
    const uint32_t longest_us = bytes * 900u / BYTES_PER_MS;
    uint32_t revolution = 1;
    for (uint32_t tenths = 1; tenths <= 10; tenths++) {
        assert_true_scans(revolution, revolution + CATCH_UP);
        revolution += CATCH_UP + 1;
        machine_pass(longest_us * tenths / 10);
    }
    assert_true_scans(revolution, revolution + CATCH_UP);
}
