/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Zephyr port with the async UART API. */

#include <errno.h>

#include "unity.h"

#include <zephyr/drivers/uart.h>

#include "irq_lines.h"
#include "scanning.h"
#include "zephyr_model.h"
#include "zephyr_rig.h"

void setUp(void)
{
    zephyr_rig_begin();
}

void tearDown(void)
{
    zephyr_rig_end();
}

void test_every_point_arrives_through_two_buffers_in_turn(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 10);
    machine_pass(3000); /* Longer than the driver's timeout. */
    TEST_ASSERT_UINT_WITHIN(64, machine.line_bytes, zephyr_rig_counters().bytes);
}

void test_wherever_an_interrupt_comes_every_point_arrives(void)
{
    zephyr_rig_start();
    assert_true_scans_wherever_bytes_come();
}

void test_pauses_that_the_receive_buffer_can_hold_cost_no_scan(void)
{
    zephyr_rig_start();
    /* Half: the library assumes the line's full rate, twice the lidar's. */
    assert_pauses_cost_no_scan(1024 / 2);
}

void test_an_overrun_is_a_gap_after_which_reception_starts_again(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    machine_pass_held_up(20000);
    assert_gap();
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().overruns);
}

void test_line_errors_are_counted_by_kind_and_reception_starts_again(void)
{
    static const int errors[] = {UART_ERROR_FRAMING, UART_ERROR_NOISE, UART_BREAK};
    zephyr_rig_start();
    assert_true_scans(1, 1);
    for (unsigned i = 0; i < 3; i++) {
        board.damage = errors[i];
        assert_gap();
    }
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().noise_errors);
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().breaks);
    TEST_ASSERT_EQUAL_UINT32(0, zephyr_rig_counters().overruns);
}

/* On a line held low, each byte is an error, but there is at most one interrupt per 10 ms. */
void test_a_line_held_low_causes_no_interrupt_storm(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    machine_power(false);
    const uint32_t before = zephyr_rig_counters().breaks;
    for (unsigned i = 0; i < 1000; i++) {
        board.damage = UART_BREAK;
        machine_receive(0, (const uint8_t *)"", 1);
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(before + 2, zephyr_rig_counters().breaks);
}

void test_a_driver_without_the_async_api_is_refused_and_not_started(void)
{
    board.async = -ENOSYS;
    TEST_ASSERT_EQUAL_INT(-ENOSYS, zephyr_rig_start_port());
    board.async = 0;
    board.async_enable = -ENODEV;
    TEST_ASSERT_EQUAL_INT(-ENODEV, tmini_zephyr_start(&port, &lidar));
    board.async_enable = 0;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(-EALREADY, tmini_zephyr_start(&port, &lidar));
}

void test_it_stops_and_starts_while_the_lidar_streams(void)
{
    zephyr_rig_start();
    for (unsigned i = 0; i < 5; i++) {
        (void)scans_until_complete();
        tmini_zephyr_stop(&port);
        TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
        machine_pass(3000 + 7000 * i);
        TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    }
}

void test_reception_that_was_ended_starts_again(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    TEST_ASSERT_EQUAL_INT(0, uart_rx_disable(&zephyr_model_uart));
    assert_gap();
    tmini_zephyr_port.restart(&port); /* The driver does this after a loss. */
    (void)scans_until_complete();
    tmini_zephyr_stop(&port);
    tmini_zephyr_port.restart(&port); /* A restart of a stopped port does nothing. */
}
