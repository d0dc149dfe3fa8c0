/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Zephyr port on a model of a board with the simulated lidar. */

#include <errno.h>

#include "unity.h"

#include <zephyr/drivers/uart.h>

#include "irq_lines.h"
#include "scanning.h"
#include "tmini/tmini_blocking.h"
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

void test_every_point_arrives_through_a_fifo(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 10);
    TEST_ASSERT_EQUAL_UINT32(machine.line_bytes, zephyr_rig_counters().bytes);
}

void test_every_point_arrives_byte_by_byte(void)
{
    machine.uart.fifo_size = 1;
    zephyr_rig_start();
    assert_true_scans(1, 10);
    TEST_ASSERT_EQUAL_UINT32(machine.line_bytes, zephyr_rig_counters().bytes);
}

void test_wherever_an_interrupt_comes_every_point_arrives(void)
{
    zephyr_rig_start();
    assert_true_scans_wherever_bytes_come();
}

void test_a_fifo_is_emptied_even_if_that_takes_several_readings(void)
{
    static const uint8_t bytes[64];
    machine.uart.fifo_size = 64;
    zephyr_rig_start();
    const uint32_t before = zephyr_rig_counters().bytes;
    machine_receive(0, bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT32(before + 64, zephyr_rig_counters().bytes);
}

/* One interrupt per byte must not cause one thread switch per byte. */
void test_the_polling_thread_is_woken_once_per_64_bytes(void)
{
    machine.uart.fifo_size = 1;
    zephyr_rig_start();
    assert_true_scans(1, 10);
    TEST_ASSERT_UINT_WITHIN(machine.line_bytes / 64 / 10, machine.line_bytes / 64, board.wakes);
}

void test_the_uart_gets_the_lidars_baud_rate(void)
{
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_UINT32(230400, board.baud_rate);
}

void test_a_driver_that_cannot_change_the_baud_rate_keeps_the_devicetrees(void)
{
    board.configure = -ENOSYS;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    board.configure = -ENOTSUP;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
}

void test_what_cannot_work_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(-EINVAL, tmini_zephyr_init(NULL, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(-EINVAL, tmini_zephyr_init(&port, NULL));
    TEST_ASSERT_EQUAL_INT(-EINVAL, tmini_zephyr_start(NULL, &lidar));
    TEST_ASSERT_EQUAL_INT(-EINVAL, tmini_zephyr_start(&port, &lidar));
    board.ready = false;
    TEST_ASSERT_EQUAL_INT(-ENODEV, tmini_zephyr_init(&port, &zephyr_model_uart));
    board.ready = true;
    board.configure = -EIO;
    TEST_ASSERT_EQUAL_INT(-EIO, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(-EINVAL, tmini_zephyr_start(&port, &lidar));
    board.configure = 0;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(-EINVAL, tmini_zephyr_start(&port, NULL));
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(-EALREADY, tmini_zephyr_start(&port, &lidar));
}

void test_a_driver_without_interrupts_is_refused_and_not_started(void)
{
#ifdef ZEPHYR_BEFORE_3_3
    TEST_IGNORE_MESSAGE("Zephyr before 3.3 does not tell");
#endif
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    board.interrupts = -ENOSYS;
    TEST_ASSERT_EQUAL_INT(-ENOSYS, tmini_zephyr_start(&port, &lidar));
    TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
    board.interrupts = -ENOTSUP;
    TEST_ASSERT_EQUAL_INT(-ENOTSUP, tmini_zephyr_start(&port, &lidar));
    TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
    board.interrupts = 0;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
}

void test_without_a_uart_nothing_is_sent(void)
{
    static const uint8_t byte = 0xA5;
    TEST_ASSERT_EQUAL_INT(-1, tmini_zephyr_port.write(&port, &byte, 1));
}

void test_it_stops_and_starts_while_the_lidar_streams(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    for (unsigned i = 0; i < 20; i++) {
        tmini_zephyr_stop(&port);
        const uint32_t bytes = zephyr_rig_counters().bytes;
        machine_pass(5000 + 100 * i);
        TEST_ASSERT_EQUAL_UINT32(bytes, zephyr_rig_counters().bytes);
        TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
        /* Overruns while stopped are not counted; bytes may be those of a full FIFO. */
        TEST_ASSERT_EQUAL_UINT32(0, zephyr_rig_counters().overruns);
        TEST_ASSERT_TRUE(zephyr_rig_counters().bytes <= 16);
        poll_until(TMINI_EVENT_SCAN);
        truth_assert_nothing_invented(tmini_scan(&lidar));
    }
    poll_until(TMINI_EVENT_SCAN);
    truth_assert_some_revolution(tmini_scan(&lidar));
}

void test_blocking_commands_work(void)
{
    tmini_info_t info;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 1000));
    TEST_ASSERT_EQUAL_UINT(151, info.model);
}

/* The gap divides a revolution into two incomplete scans. The next scan is complete. */
static void assert_gap_in_revolution(uint32_t revolution)
{
    for (unsigned part = 0; part < 2; part++) {
        poll_until(TMINI_EVENT_SCAN);
        TEST_ASSERT_FALSE(tmini_scan(&lidar)->complete);
        truth_assert_nothing_invented(tmini_scan(&lidar));
    }
    poll_until(TMINI_EVENT_SCAN);
    truth_assert_revolution(tmini_scan(&lidar), revolution + 1);
}

/* In 20 ms, 262 bytes with two whole packets arrive and overrun the FIFO. */
static void assert_overrun_is_a_gap(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 2);
    machine_pass_held_up(20000);
    assert_gap_in_revolution(3);
}

void test_an_overrun_of_the_fifo_is_a_gap(void)
{
    assert_overrun_is_a_gap();
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().overruns);
}

void test_an_overrun_without_a_fifo_is_a_gap(void)
{
    machine.uart.fifo_size = 1;
    assert_overrun_is_a_gap();
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().overruns);
}

void test_a_byte_lost_while_the_fifo_is_read_is_a_gap(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 2);
    board.lose_while_reading = true;
    assert_gap_in_revolution(3);
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().overruns);
}

static uint32_t packets(void)
{
    tmini_counters_t counters;
    for (unsigned polls = 0; polls < 10; polls++) {
        (void)tmini_poll(&lidar);
    }
    tmini_counters(&lidar, &counters);
    return counters.packets;
}

/* Receives a packet in two parts. The bytes alone do not show a loss in between. */
static void receive_packet_with_loss(bool lost)
{
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    machine_receive(0, manual_packet, sizeof manual_packet - 16);
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    if (lost) {
        board.lose_while_reading = true;
    }
    machine_receive(0, &manual_packet[sizeof manual_packet - 16], 16);
}

void test_no_packet_is_put_together_across_a_loss(void)
{
    receive_packet_with_loss(false);
    TEST_ASSERT_EQUAL_UINT32(1, packets());
    tmini_zephyr_stop(&port);
    setUp();
    receive_packet_with_loss(true);
    TEST_ASSERT_EQUAL_UINT32(0, packets());
}

/* On some USARTs, the driver clears the error by reading the only byte. */
void test_an_overrun_without_a_byte_to_read_is_a_gap(void)
{
    machine.uart.fifo_size = 1;
    board.clearing_reads_data = true;
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_start(&port, &lidar));
    machine_receive(0, manual_packet, 10);
    TEST_ASSERT_EQUAL_size_t(1024 - 10, tmini_feed_room(&lidar));
    board.damage = UART_ERROR_OVERRUN;
    machine_receive(0, &manual_packet[10], 1);
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().overruns);
    TEST_ASSERT_EQUAL_UINT32(10, zephyr_rig_counters().bytes);
    TEST_ASSERT_EQUAL_size_t(0, tmini_feed_room(&lidar));
}

void test_an_interrupt_that_is_late_for_the_stop_stores_nothing(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    tmini_zephyr_stop(&port);
    const uint32_t bytes = zephyr_rig_counters().bytes;
    machine_receive(0, manual_packet, 10);
    board.late = true;
    irq_serve();
    TEST_ASSERT_EQUAL_UINT32(bytes, zephyr_rig_counters().bytes);
}

void test_a_uart_that_was_left_on_is_switched_off_first(void)
{
    board.receiving = true;
    zephyr_rig_start();
    assert_true_scans(1, 1);
}

void test_reception_that_was_switched_off_starts_again(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    uart_irq_rx_disable(&zephyr_model_uart);
    uart_irq_callback_user_data_set(&zephyr_model_uart, NULL, NULL);
    assert_recovery();
    tmini_zephyr_stop(&port);
    tmini_zephyr_port.restart(&port); /* A restart of a stopped port does nothing. */
}

void test_line_errors_are_counted_by_kind(void)
{
    zephyr_rig_start();
    assert_true_scans(1, 1);
    board.damage = UART_ERROR_FRAMING;
    machine_pass(20000);
    board.damage = UART_BREAK;
    machine_pass(20000);
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(1, zephyr_rig_counters().breaks);
    TEST_ASSERT_EQUAL_UINT32(0, zephyr_rig_counters().overruns);
}

/* A negative result of uart_err_check() is not a set of error flags. */
void test_a_driver_that_reports_no_errors_has_none(void)
{
    board.error_check = -ENOSYS;
    zephyr_rig_start();
    assert_true_scans(1, 3);
    TEST_ASSERT_EQUAL_UINT32(0, zephyr_rig_counters().overruns);
    TEST_ASSERT_EQUAL_UINT32(0, zephyr_rig_counters().framing_errors);
    TEST_ASSERT_EQUAL_UINT32(0, zephyr_rig_counters().breaks);
}
