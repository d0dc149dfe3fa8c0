/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "every_port.h"

#include "tmini/tmini_blocking.h"
#include "unity.h"

void setUp(void);
void tearDown(void);

const port_way_t *port_way;

void init_lidar(size_t rx_size)
{
    scanning_begin(&port_program, rx_size);
}

void setUp(void)
{
    const sim_observer_t observer = truth_begin();
    port_way = NULL;
    port_begin(&observer);
    init_lidar(1024);
}

void tearDown(void)
{
    port_stop();
    port_assert_stopped();
}

/* Sets everything up anew, for this way. */
static void begin(const port_way_t *chosen)
{
    tearDown();
    setUp();
    port_way = chosen;
    UNITY_SET_DETAIL(port_way->name);
    if (port_way->choose != NULL) {
        port_way->choose();
    }
}

void begin_again(void)
{
    begin(port_way);
}

void begin_way(unsigned number)
{
    begin(&port_ways[number]);
}

bool next_way(void)
{
    const port_way_t *const next = port_way == NULL ? port_ways : port_way + 1;
    if (next == &port_ways[port_way_count]) {
        return false;
    }
    begin(next);
    return true;
}

void start_port(void)
{
    TEST_ASSERT_EQUAL_INT(0, port_init());
    TEST_ASSERT_EQUAL_INT(0, port_start());
}

void start(void)
{
    start_port();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
}

void assert_counted(uint32_t losses)
{
    const port_counts_t counts = port_counted();
    TEST_ASSERT_EQUAL_UINT32(losses, counts.overruns);
    TEST_ASSERT_EQUAL_UINT32(0, counts.framing_errors);
    TEST_ASSERT_EQUAL_UINT32(0, counts.breaks);
}

/* ------------------------------------------------------------------------------------ receiving */

void test_every_point_arrives(void)
{
    while (next_way()) {
        start();
        assert_true_scans(1, 10);
        TEST_ASSERT_UINT32_WITHIN(port_way->behind, machine.line_bytes, port_counted().bytes);
        TEST_ASSERT_EQUAL_UINT32(0, port_counted().lost);
        assert_counted(0);
    }
}

void test_wherever_bytes_come_every_point_arrives(void)
{
    while (next_way()) {
        if (!port_way->without_fifo) {
            start();
            assert_true_scans_wherever_bytes_come();
        }
    }
}

void test_pauses_that_the_layer_below_can_hold_cost_no_scan(void)
{
    while (next_way()) {
        if (port_way->holds > 0) {
            if (port_way->enlarge != NULL) {
                port_way->enlarge();
            }
            start();
            assert_pauses_cost_no_scan(port_way->holds);
        }
    }
}

/* In 20 ms 262 bytes arrive, with two whole packets: more than any FIFO holds. */
void test_an_overrun_is_a_gap_and_costs_only_the_packets_that_it_hit(void)
{
    while (next_way()) {
        tmini_counters_t counters;
        start();
        assert_true_scans(1, 2);
        port_way->hold_up(20000);
        assert_gap();
        assert_counted(1);
        tmini_counters(&lidar, &counters);
        /* One more may still be arriving. */
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(port_way->packets_per_loss + 1,
                                         truth_packets() - counters.packets);
    }
}

uint32_t packets(void)
{
    tmini_counters_t counters;
    for (unsigned polls = 0; polls < 10; polls++) {
        if (polls < 2) {
            port_program.wait();
        }
        (void)tmini_poll(&lidar);
    }
    tmini_counters(&lidar, &counters);
    return counters.packets;
}

/* Receives a packet in parts. The bytes alone do not show a loss in between. */
static uint32_t packets_with(uint32_t errors)
{
    const uint8_t *const rest = &manual_packet[PACKET_CUT];
    start_port();
    machine_receive(0, manual_packet, PACKET_CUT);
    machine_pass(200);
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    machine_receive(errors, rest, 1);
    machine_receive(0, rest + 1, 14);
    machine_pass(200);
    machine_receive(0, rest + 15, sizeof manual_packet - PACKET_CUT - 15);
    machine_pass(200);
    return packets();
}

void test_no_packet_is_put_together_across_a_loss(void)
{
    while (next_way()) {
        if (port_way->loss != 0) {
            TEST_ASSERT_EQUAL_UINT32(1, packets_with(0));
            begin_again();
            TEST_ASSERT_EQUAL_UINT32(0, packets_with(port_way->loss));
        }
    }
}

void test_errors_of_the_line_are_counted_by_kind(void)
{
    while (next_way()) {
        static const uint8_t byte = 0x55;
        if (port_way->framing_error != 0) {
            start();
            assert_true_scans(1, 1);
            machine_receive(port_way->framing_error, &byte, 1);
            poll_until(TMINI_EVENT_SCAN);
            machine_receive(port_way->line_break, &byte, 1);
            poll_until(TMINI_EVENT_SCAN);
            TEST_ASSERT_EQUAL_UINT32(1, port_counted().framing_errors);
            TEST_ASSERT_EQUAL_UINT32(1, port_counted().breaks);
            TEST_ASSERT_EQUAL_UINT32(0, port_counted().overruns);
        }
    }
}

/* ------------------------------------------------------------------------------ start and stop */

void test_starting_twice_is_refused_and_changes_nothing(void)
{
    while (next_way()) {
        if (!port_way->always_wired) {
            TEST_ASSERT_NOT_EQUAL_INT(0, port_start()); /* It has no wiring yet. */
            start();
            TEST_ASSERT_NOT_EQUAL_INT(0, port_start());
            assert_true_scans(1, 1);
        }
    }
}

void test_bytes_before_the_start_are_dropped(void)
{
    while (next_way()) {
        static const uint8_t start_scanning[] = {0xA5, 0x60};
        TEST_ASSERT_EQUAL_INT(0, port_init());
        sim_receive(&machine.lidar, start_scanning, sizeof start_scanning, machine.now_us);
        machine_pass(600000);
        TEST_ASSERT_GREATER_THAN_UINT32(1000, machine.line_bytes);
        TEST_ASSERT_EQUAL_UINT32(0, port_counted().bytes);
        TEST_ASSERT_EQUAL_INT(0, port_start());
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(port_way->old, port_counted().bytes);
        TEST_ASSERT_EQUAL_UINT32(0, port_counted().overruns);
    }
}

void test_it_stops_and_starts_while_the_lidar_streams(void)
{
    while (next_way()) {
        start();
        assert_true_scans(1, 1);
        for (unsigned i = 0; i < 20; i++) {
            port_stop();
            port_assert_stopped();
            const uint32_t bytes = port_counted().bytes;
            machine_pass(10000 + 100 * i);
            TEST_ASSERT_EQUAL_UINT32(bytes, port_counted().bytes);
            TEST_ASSERT_EQUAL_INT(0, port_start());
            TEST_ASSERT_LESS_OR_EQUAL_UINT32(port_way->old, port_counted().bytes);
            assert_counted(0);
            poll_until(TMINI_EVENT_SCAN);
            truth_assert_nothing_invented(tmini_scan(&lidar));
        }
        (void)scans_until_complete();
    }
}

void test_reception_that_was_broken_is_started_again(void)
{
    while (next_way()) {
        if (port_way->break_reception != NULL) {
            start();
            assert_true_scans(1, 1);
            port_way->break_reception();
            assert_recovery();
            port_stop();
            port_program.port->restart(port_program.context); /* Stopped, it does nothing. */
            port_assert_stopped();
        }
    }
}

/* -------------------------------------------------------------------------------------- sending */

void test_without_wiring_nothing_is_sent(void)
{
    static const uint8_t byte = 0xA5;
    if (port_ways[0].always_wired) {
        return;
    }
    TEST_ASSERT_EQUAL_INT(-1, port_program.port->write(port_program.context, &byte, 1));
}

void test_blocking_commands_work(void)
{
    while (next_way()) {
        tmini_info_t info;
        start_port();
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 1000));
        TEST_ASSERT_EQUAL_UINT(151, info.model);
    }
}
