/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Zephyr port with the interrupt-driven UART API. */

#include <errno.h>

#include "unity.h"

#include <zephyr/drivers/uart.h>

#include "irq_lines.h"
#include "every_port.h"
#include "zephyr_model.h"

static void byte_by_byte(void)
{
    machine.uart.fifo_size = 1;
}

static void switch_off(void)
{
    uart_irq_rx_disable(&zephyr_model_uart);
    uart_irq_callback_user_data_set(&zephyr_model_uart, NULL, NULL);
}

#define WAY                                                            \
    .old = 16, .packets_per_loss = 4, .hold_up = machine_pass_held_up, \
    .break_reception = switch_off, .loss = UART_ERROR_OVERRUN,         \
    .framing_error = UART_ERROR_FRAMING, .line_break = UART_BREAK

const port_way_t port_ways[] = {
    {.name = "through a FIFO", WAY},
    {.name = "byte by byte", .choose = byte_by_byte, .without_fifo = true, WAY},
};
const unsigned port_way_count = sizeof port_ways / sizeof port_ways[0];

void test_a_fifo_is_emptied_even_if_that_takes_several_readings(void)
{
    static const uint8_t bytes[64];
    machine.uart.fifo_size = 64;
    start();
    const uint32_t before = port_counted().bytes;
    machine_receive(0, bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT32(before + 64, port_counted().bytes);
}

/* One interrupt per byte must not cause one thread switch per byte. */
void test_the_polling_thread_is_woken_once_per_64_bytes(void)
{
    machine.uart.fifo_size = 1;
    start();
    assert_true_scans(1, 10);
    TEST_ASSERT_UINT_WITHIN(machine.line_bytes / 64 / 10, machine.line_bytes / 64, board.wakes);
}

void test_a_driver_without_interrupts_is_refused_and_not_started(void)
{
#ifdef ZEPHYR_BEFORE_3_3
    TEST_IGNORE_MESSAGE("Zephyr before 3.3 does not tell");
#endif
    TEST_ASSERT_EQUAL_INT(0, port_init());
    board.interrupts = -ENOSYS;
    TEST_ASSERT_EQUAL_INT(-ENOSYS, port_start());
    TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
    board.interrupts = -ENOTSUP;
    TEST_ASSERT_EQUAL_INT(-ENOTSUP, port_start());
    TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
    board.interrupts = 0;
    TEST_ASSERT_EQUAL_INT(0, port_start());
}

void test_a_byte_lost_while_the_fifo_is_read_is_a_gap(void)
{
    start();
    assert_true_scans(1, 2);
    board.lose_while_reading = true;
    assert_gap();
    TEST_ASSERT_EQUAL_UINT32(1, port_counted().overruns);
}

/* On some USARTs, the driver clears the error by reading the only byte. */
void test_an_overrun_without_a_byte_to_read_is_a_gap(void)
{
    machine.uart.fifo_size = 1;
    board.clearing_reads_data = true;
    start_port();
    machine_receive(0, manual_packet, 10);
    TEST_ASSERT_EQUAL_size_t(1024 - 10, tmini_feed_room(&lidar));
    machine_receive(UART_ERROR_OVERRUN, &manual_packet[10], 1);
    TEST_ASSERT_EQUAL_UINT32(1, port_counted().overruns);
    TEST_ASSERT_EQUAL_UINT32(10, port_counted().bytes);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed_room(&lidar));
}

void test_an_interrupt_that_is_late_for_the_stop_stores_nothing(void)
{
    start();
    assert_true_scans(1, 1);
    port_stop();
    const uint32_t bytes = port_counted().bytes;
    machine_receive(0, manual_packet, 10);
    board.late = true;
    irq_serve();
    TEST_ASSERT_EQUAL_UINT32(bytes, port_counted().bytes);
}

void test_a_uart_that_was_left_on_is_switched_off_first(void)
{
    board.receiving = true;
    start();
    assert_true_scans(1, 1);
}

/* A negative result of uart_err_check() is not a set of error flags. */
void test_a_driver_that_reports_no_errors_has_none(void)
{
    board.error_check = -ENOSYS;
    start();
    assert_true_scans(1, 3);
    assert_counted(0);
}
