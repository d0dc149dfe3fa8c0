/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the HAL port with the simulated lidar: seconds of scanning in each way of receiving, on a
 * clean and a bad line, and after a reset of only the controller. */

#include "hal_rig.h"

#include <string.h>

#include "simulator.h"
#include "unity.h"

#define SECONDS 10u

static sim_t sim;
static bool has_byte;
static model_byte_t next_byte;
static uint32_t bytes_sent;
static uint32_t error_every; /* Bytes between two errors; 0: no errors. */
static uint32_t scans;
static uint32_t complete_scans;

/* ----------------------------------------------------------------------------------------- line */

static bool sim_next(model_byte_t *byte)
{
    if (!has_byte && sim_transmit(&sim, model.now_ns / 1000u, &next_byte.byte, 1) == 1) {
        has_byte = true;
        bytes_sent++;
        next_byte.at_ns = model.now_ns;
        next_byte.errors = 0;
        if (error_every != 0 && bytes_sent % error_every == 0) {
            next_byte.errors = MODEL_FE;
            next_byte.byte ^= 0x10;
        }
    }
    *byte = next_byte;
    return has_byte;
}

static void sim_take(void)
{
    has_byte = false;
}

static void sim_hear(uint8_t byte, uint64_t now_us)
{
    sim_receive(&sim, &byte, 1, now_us);
}

/* ------------------------------------------------------------------------------------ the robot */

static void open_with_lidar(hal_rig_way_t way)
{
    const sim_config_t config = sim_default_config();
    hal_rig_open(way);
    model.next = sim_next;
    model.take = sim_take;
    model.sent = sim_hear;
    sim_init(&sim, &config);
    has_byte = false;
    bytes_sent = 0;
    error_every = 0;
    scans = 0;
    complete_scans = 0;
}

static void work(void)
{
    tmini_event_t event;
    do {
        event = tmini_poll(&hal_rig.lidar);
        if (event == TMINI_EVENT_SCAN) {
            scans++;
            complete_scans += tmini_scan(&hal_rig.lidar)->complete;
        }
    } while (event != TMINI_EVENT_NONE);
}

static void run_for(uint32_t ms, uint32_t poll_every_ms)
{
    for (uint32_t i = 0; i < ms; i += poll_every_ms) {
        model_pass(poll_every_ms * 1000u);
        work();
    }
}

static void scan_from_the_beginning(hal_rig_way_t way)
{
    open_with_lidar(way);
    model_pass(10000);
    TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_start(&hal_rig.lidar));
    run_for(2000, 5); /* The lidar starts and reaches its speed. */
    TEST_ASSERT_EQUAL(TMINI_STATE_SCANNING, tmini_state(&hal_rig.lidar));
    scans = 0;
    complete_scans = 0;
}

void setUp(void) {}

void tearDown(void) {}

static const hal_rig_way_t ways[] = {BY_DMA, BY_BLOCKS, BY_BYTES};

#define FOR_EACH_WAY(i) for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++)

/* The lidar turns at 6 Hz. The first and the last revolution may be cut off. */
static void check_all_scans_complete(uint32_t seconds)
{
    TEST_ASSERT_UINT32_WITHIN(2, 6 * seconds, scans);
    TEST_ASSERT_EQUAL_UINT32(scans, complete_scans);
}

void test_on_a_clean_line_every_scan_is_complete(void)
{
    FOR_EACH_WAY(i)
    {
        scan_from_the_beginning(ways[i]);
        run_for(SECONDS * 1000u, 5);
        check_all_scans_complete(SECONDS);
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().laps);
    }
}

/* The lidar was not stopped: it is still sending, and an overrun is pending. */
void test_a_controller_reset_while_the_lidar_spins_scans_again(void)
{
    FOR_EACH_WAY(i)
    {
        static const uint8_t start[] = {0xA5, 0x60};
        open_with_lidar(ways[i]);
        sim_receive(&sim, start, sizeof start, 0);
        model_pass(3000000);
        TEST_ASSERT_NOT_EQUAL(0, model.flags & MODEL_ORE);
        TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
        TEST_ASSERT_EQUAL(TMINI_OK, tmini_start(&hal_rig.lidar));
        run_for(4000, 5);
        scans = 0;
        complete_scans = 0;
        run_for(SECONDS * 1000u, 5);
        check_all_scans_complete(SECONDS);
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
        TEST_ASSERT_LESS_THAN_UINT32(2, hal_rig_errors().overruns);
    }
}

/* 2.6 framing errors per second, as on a bad line. */
void test_a_framing_error_costs_only_its_packet(void)
{
    FOR_EACH_WAY(i)
    {
        tmini_counters_t before;
        tmini_counters_t after;
        scan_from_the_beginning(ways[i]);
        tmini_counters(&hal_rig.lidar, &before);
        const uint32_t sent_before = sim.counts.packets;
        const uint32_t bytes_before = bytes_sent;
        error_every = 5000;
        run_for(SECONDS * 1000u, 5);
        tmini_counters(&hal_rig.lidar, &after);
        const uint32_t errors = bytes_sent / error_every - bytes_before / error_every;
        TEST_ASSERT_UINT32_WITHIN(4, 26, errors);
        TEST_ASSERT_UINT32_WITHIN(1 + errors, sim.counts.packets - sent_before,
                                  after.packets - before.packets);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(scans - errors, complete_scans);
        TEST_ASSERT_EQUAL_UINT32(0, hal_rig_errors().restarts);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(errors / 2, hal_rig_errors().framing_errors);
    }
}

void test_each_interruption_of_reception_costs_one_scan(void)
{
    FOR_EACH_WAY(i)
    {
        scan_from_the_beginning(ways[i]);
        for (unsigned second = 0; second < SECONDS; second++) {
            hal_rig.uart.RxState = HAL_UART_STATE_READY;
            run_for(1000, 5);
        }
        TEST_ASSERT_GREATER_THAN_UINT32(4 * SECONDS, complete_scans);
        TEST_ASSERT_UINT32_WITHIN(1, SECONDS, hal_rig_errors().restarts);
    }
}

void test_polls_22_ms_apart_lose_nothing(void)
{
    FOR_EACH_WAY(i)
    {
        scan_from_the_beginning(ways[i]);
        run_for(SECONDS * 1000u, 22);
        check_all_scans_complete(SECONDS);
    }
}

/* Interrupts are held back for long, as while a flash page is erased. */
void test_interrupts_held_back_for_long_leave_no_incomplete_scan_marked_complete(void)
{
    FOR_EACH_WAY(i)
    {
        scan_from_the_beginning(ways[i]);
        for (unsigned second = 0; second < SECONDS; second++) {
            model.held_until_ns = model.now_ns + (30000u + 12000u * second) * 1000u;
            model_pass(30000u + 12000u * second);
            run_for(970u - 12u * second, 5);
        }
        TEST_ASSERT_GREATER_THAN_UINT32(3 * SECONDS, complete_scans);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(scans - SECONDS + 3, complete_scans);
        TEST_ASSERT_EQUAL(TMINI_STATE_SCANNING, tmini_state(&hal_rig.lidar));
    }
}

void test_stopping_and_starting_the_port_brings_the_scans_back(void)
{
    FOR_EACH_WAY(i)
    {
        scan_from_the_beginning(ways[i]);
        tmini_stm32_hal_stop(&hal_rig.port);
        model_pass(300000);
        TEST_ASSERT_EQUAL(TMINI_OK, hal_rig_start());
        run_for(1000, 5);
        scans = 0;
        complete_scans = 0;
        run_for(3000, 5);
        check_all_scans_complete(3);
    }
}
