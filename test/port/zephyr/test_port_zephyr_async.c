/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Zephyr port with the async UART API. */

#include <errno.h>

#include "unity.h"

#include <zephyr/drivers/uart.h>

#include "irq_lines.h"
#include "zephyr_rig.h"

const port_way_t port_ways[] = {
    {.name = "through two buffers in turn",
     .holds = 1024 / 2, /* The library assumes the line's full rate, twice the lidar's. */
     .behind = 64,
     .packets_per_loss = 6,
     .hold_up = machine_pass_held_up,
     .loss = UART_ERROR_OVERRUN},
};
const unsigned port_way_count = sizeof port_ways / sizeof port_ways[0];

void test_line_errors_are_counted_by_kind_and_reception_starts_again(void)
{
    static const int errors[] = {UART_ERROR_FRAMING, UART_ERROR_NOISE, UART_BREAK};
    start();
    assert_true_scans(1, 1);
    for (unsigned i = 0; i < 3; i++) {
        board.damage = errors[i];
        assert_gap();
    }
    TEST_ASSERT_EQUAL_UINT32(1, counted().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, counted().noise_errors);
    TEST_ASSERT_EQUAL_UINT32(1, counted().breaks);
    TEST_ASSERT_EQUAL_UINT32(0, counted().overruns);
}

/* On a line held low, each byte is an error, but there is at most one interrupt per 10 ms. */
void test_a_line_held_low_causes_no_interrupt_storm(void)
{
    start();
    assert_true_scans(1, 1);
    machine_power(false);
    const uint32_t before = counted().breaks;
    for (unsigned i = 0; i < 1000; i++) {
        board.damage = UART_BREAK;
        machine_receive(0, (const uint8_t *)"", 1);
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(before + 2, counted().breaks);
}

void test_a_driver_without_the_async_api_is_refused_and_not_started(void)
{
    board.async = -ENOSYS;
    TEST_ASSERT_EQUAL_INT(0, port_init());
    TEST_ASSERT_EQUAL_INT(-ENOSYS, port_start());
    board.async = 0;
    board.async_enable = -ENODEV;
    TEST_ASSERT_EQUAL_INT(-ENODEV, tmini_zephyr_start(&port, &lidar));
    board.async_enable = 0;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(-EALREADY, tmini_zephyr_start(&port, &lidar));
}

void test_reception_that_was_ended_starts_again(void)
{
    start();
    assert_true_scans(1, 1);
    TEST_ASSERT_EQUAL_INT(0, uart_rx_disable(&zephyr_model_uart));
    assert_gap();
    tmini_zephyr_port.restart(&port); /* The driver does this after a loss. */
    (void)scans_until_complete();
    tmini_zephyr_stop(&port);
    tmini_zephyr_port.restart(&port); /* A restart of a stopped port does nothing. */
}
