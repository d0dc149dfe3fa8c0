/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Zephyr port with the async UART API. */

#include <errno.h>

#include "unity.h"

#include <zephyr/drivers/uart.h>

#include "every_port.h"
#include "tmini_zephyr.h"
#include "zephyr_model.h"

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
    static const uint32_t errors[] = {UART_ERROR_FRAMING, UART_ERROR_NOISE, UART_ERROR_NOISE,
                                      UART_BREAK,         UART_BREAK,       UART_BREAK};
    tmini_zephyr_counters_t counters;
    start();
    assert_true_scans(1, 1);
    for (unsigned i = 0; i < 6; i++) {
        machine_receive(errors[i], (const uint8_t *)"", 1);
        assert_gap();
    }
    tmini_zephyr_counters(port_program.context, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.framing_errors);
    TEST_ASSERT_EQUAL_UINT32(2, counters.noise_errors);
    TEST_ASSERT_EQUAL_UINT32(3, counters.breaks);
    TEST_ASSERT_EQUAL_UINT32(0, counters.overruns);
}

/* On a line held low, each byte is an error, but there is at most one interrupt per 10 ms. */
void test_a_line_held_low_causes_no_interrupt_storm(void)
{
    start();
    assert_true_scans(1, 1);
    machine_power(false);
    const uint32_t before = port_counted().breaks;
    for (unsigned i = 0; i < 1000; i++) {
        machine_receive(UART_BREAK, (const uint8_t *)"", 1);
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(before + 2, port_counted().breaks);
}

void test_a_driver_without_the_async_api_is_refused_and_not_started(void)
{
    board.async = -ENOSYS;
    TEST_ASSERT_EQUAL_INT(0, port_init());
    TEST_ASSERT_EQUAL_INT(-ENOSYS, port_start());
    board.async = 0;
    board.async_enable = -ENODEV;
    TEST_ASSERT_EQUAL_INT(-ENODEV, port_start());
    board.async_enable = 0;
    TEST_ASSERT_EQUAL_INT(0, port_start());
}

void test_reception_that_was_ended_starts_again(void)
{
    start();
    assert_true_scans(1, 1);
    TEST_ASSERT_EQUAL_INT(0, uart_rx_disable(&zephyr_model_uart));
    assert_gap();
    port_program.port->restart(port_program.context); /* The driver does this after a loss. */
    (void)scans_until_complete();
    port_stop();
    port_program.port->restart(
        port_program.context); /* A restart of a stopped port does nothing. */
}
