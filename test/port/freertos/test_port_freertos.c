/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the FreeRTOS port on a model of the kernel with the simulated lidar. The test itself is the
 * polling task. */

#include <string.h>

#include "unity.h"

#include "board.h"
#include "freertos_model.h"
#include "scanning.h"
#include "tmini/tmini_blocking.h"
#include "tmini_freertos.h"

#define POLLING_PRIORITY 1u
#define RECEIVING_PRIORITY 2u
#define TICK_US (1000000u / configTICK_RATE_HZ + 1)

static uint8_t stream[8192];
static tmini_freertos_t port;
static tmini_freertos_wiring_t wiring;

/* The same handler as in the example. */
void UART1_Handler(void)
{
    uint8_t bytes[16];
    int overrun = 0;
    BaseType_t woken = pdFALSE;
    const size_t count = board_lidar_read(bytes, sizeof bytes, &overrun);
    if (overrun) {
        tmini_freertos_gap_from_isr(&port);
    }
    tmini_freertos_receive_from_isr(&port, bytes, count, &woken);
    portYIELD_FROM_ISR(woken);
}

static void wait(void)
{
    tmini_freertos_wait(&port, pdMS_TO_TICKS(10));
}

static void init_lidar(size_t rx_size)
{
    const scanning_t program = {
        .port = &tmini_freertos_port, .context = &port, .wait = wait, .work = machine_pass};
    scanning_begin(&program, rx_size);
}

void setUp(void)
{
    const sim_observer_t observer = truth_begin();
    freertos_model_begin(&observer, POLLING_PRIORITY);
    memset(&port, 0, sizeof port);
    wiring = (tmini_freertos_wiring_t){.write = board_lidar_write};
    init_lidar(1024);
}

void tearDown(void)
{
    tmini_freertos_stop(&port);
}

static void receive_by_stream(void)
{
    wiring.stream = stream;
    wiring.stream_size = 1024;
    wiring.priority = RECEIVING_PRIORITY;
}

static void start(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    board_enable_lidar_interrupt();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
}

static tmini_freertos_counters_t counted(void)
{
    tmini_freertos_counters_t counters;
    tmini_freertos_counters(&port, &counters);
    return counters;
}

/* ------------------------------------------------------------------------- from the interrupt */

void test_every_point_arrives_by_the_interrupt(void)
{
    start();
    assert_true_scans(1, 10);
    TEST_ASSERT_EQUAL_UINT(0, freertos_model_tasks());
    TEST_ASSERT_EQUAL_UINT32(machine.line_bytes, counted().bytes);
}

void test_the_polling_task_is_woken_once_per_64_bytes(void)
{
    start();
    assert_true_scans(1, 10);
    TEST_ASSERT_UINT_WITHIN(machine.line_bytes / 64 / 5, machine.line_bytes / 64, world.wakes);
}

void test_a_polling_task_that_works_60_ms_loses_nothing(void)
{
    start();
    assert_true_scans(1, 2);
    for (uint32_t revolution = 3; revolution < 8; revolution++) {
        machine_pass(60000);
        assert_true_scans(revolution, revolution);
    }
}

void test_wherever_an_interrupt_comes_every_point_arrives(void)
{
    start();
    assert_true_scans_wherever_bytes_come();
}

void test_an_overrun_of_the_uart_is_a_gap(void)
{
    start();
    assert_true_scans(1, 2);
    machine_pass_held_up(20000);
    assert_gap();
    TEST_ASSERT_EQUAL_UINT32(1, counted().overruns);
    TEST_ASSERT_EQUAL_UINT32(machine.line_bytes - machine.overrun_bytes, counted().bytes);
}

/* ---------------------------------------------------------------------------- through a stream */

void test_every_point_arrives_through_the_receiving_task(void)
{
    receive_by_stream();
    start();
    assert_true_scans(1, 10);
    TEST_ASSERT_EQUAL_UINT(1, freertos_model_tasks());
    TEST_ASSERT_EQUAL_UINT32(0, counted().bytes_lost);
}

/* In 60 ms 786 bytes arrive: more than rx_buffer holds. The stream keeps the rest. */
void test_the_stream_keeps_bytes_for_which_the_lidar_has_no_room(void)
{
    tmini_counters_t counters;
    receive_by_stream();
    init_lidar(512);
    start();
    assert_true_scans(1, 2);
    for (uint32_t revolution = 3; revolution < 8; revolution++) {
        machine_pass(60000);
        assert_true_scans(revolution, revolution);
    }
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(0, counted().bytes_lost);
}

void test_pauses_that_the_stream_can_hold_cost_no_scan(void)
{
    receive_by_stream();
    wiring.stream_size = sizeof stream;
    start();
    assert_pauses_cost_no_scan(sizeof stream);
}

/* In 300 ms 3930 bytes arrive; stream and rx_buffer together hold 2047. */
void test_a_stream_that_overflows_is_one_gap(void)
{
    tmini_counters_t counters;
    receive_by_stream();
    start();
    assert_true_scans(1, 2);
    machine_pass(300000);
    assert_gap();
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_UINT_WITHIN(500, 3930 - 2047, counted().bytes_lost);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(machine.line_bytes, counted().bytes);
}

void test_an_overrun_of_the_uart_before_the_stream_is_a_gap(void)
{
    receive_by_stream();
    start();
    assert_true_scans(1, 2);
    machine_pass_held_up(20000);
    assert_gap();
    TEST_ASSERT_EQUAL_UINT32(1, counted().overruns);
}

/* Only the bytes read together with the overrun are lost: the receiving task is woken at once, not
 * by its timeout. */
void test_an_overrun_costs_no_more_than_the_bytes_in_the_fifo(void)
{
    receive_by_stream();
    start();
    assert_true_scans(1, 2);
    for (unsigned i = 0; i < 20; i++) {
        world.overrun = true;
        poll_until(TMINI_EVENT_SCAN);
    }
    TEST_ASSERT_EQUAL_UINT32(20, counted().overruns);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(20 * 16, counted().bytes_lost);
}

/* After the gap, the lidar takes no byte before the polling task has emptied rx_buffer. */
void test_an_overrun_before_the_stream_wakes_the_polling_task(void)
{
    receive_by_stream();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    tmini_freertos_wait(&port, 1); /* The first call sets the task that is to be woken. */
    freertos_model_receive(true, manual_packet, 1);
    const uint64_t begun_us = machine.now_us;
    tmini_freertos_wait(&port, pdMS_TO_TICKS(1000));
    TEST_ASSERT_TRUE(machine.now_us - begun_us < 100000);
}

/* If the line pauses in the middle of a packet, the first part must still be handed on. */
void test_bytes_below_the_streams_trigger_level_are_handed_on_in_time(void)
{
    tmini_info_t info;
    receive_by_stream(); /* The reply has 27 bytes, but the stream's trigger level is 32. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    board_enable_lidar_interrupt();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_info(&lidar, &info, 1000));
    TEST_ASSERT_EQUAL_UINT(151, info.model);
}

/* --------------------------------------------------------------- losses that bytes do not show */

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
static void receive_packet(bool overrun)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    freertos_model_receive(false, manual_packet, PACKET_CUT);
    vTaskDelay(pdMS_TO_TICKS(20));
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    freertos_model_receive(overrun, &manual_packet[PACKET_CUT], sizeof manual_packet - PACKET_CUT);
    vTaskDelay(pdMS_TO_TICKS(20));
}

void test_no_packet_is_put_together_across_an_overrun(void)
{
    for (unsigned way = 0; way < 2; way++) {
        receive_packet(false);
        TEST_ASSERT_EQUAL_UINT32(1, packets());
        tmini_freertos_stop(&port);
        init_lidar(1024);
        receive_packet(true);
        TEST_ASSERT_EQUAL_UINT32(0, packets());
        tmini_freertos_stop(&port);
        setUp();
        receive_by_stream();
    }
}

static void fill_small_stream(void)
{
    static const uint8_t nothing[97] = {0};
    receive_by_stream();
    wiring.stream_size = 128; /* It holds 127 bytes. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    freertos_model_receive(false, nothing, sizeof nothing);
    freertos_model_receive(false, manual_packet, PACKET_CUT);
    TEST_ASSERT_EQUAL_UINT32(0, counted().bytes_lost);
    freertos_model_receive(false, nothing, 10);
    TEST_ASSERT_EQUAL_UINT32(10, counted().bytes_lost);
}

void test_no_packet_is_put_together_across_a_full_stream(void)
{
    fill_small_stream();
    vTaskDelay(pdMS_TO_TICKS(20)); /* The receiving task empties the stream. */
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    freertos_model_receive(false, &manual_packet[PACKET_CUT], sizeof manual_packet - PACKET_CUT);
    vTaskDelay(pdMS_TO_TICKS(20));
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    TEST_ASSERT_EQUAL_UINT32(10, counted().bytes_lost); /* The stream is open again. */
}

void test_a_stream_that_was_full_takes_no_byte_until_it_is_empty(void)
{
    uint8_t taken[60];
    fill_small_stream();
    TEST_ASSERT_EQUAL_UINT(60, xStreamBufferReceive(port.stream, taken, sizeof taken, 0));
    freertos_model_receive(false, &manual_packet[PACKET_CUT], sizeof manual_packet - PACKET_CUT);
    TEST_ASSERT_EQUAL_UINT32(10 + sizeof manual_packet - PACKET_CUT, counted().bytes_lost);
}

void test_a_stream_that_was_full_when_stopped_is_open_at_the_next_start(void)
{
    fill_small_stream();
    tmini_freertos_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    freertos_model_receive(false, manual_packet, sizeof manual_packet);
    TEST_ASSERT_EQUAL_UINT32(0, counted().bytes_lost);
    TEST_ASSERT_EQUAL_UINT32(sizeof manual_packet, counted().bytes);
}

/* ------------------------------------------------------------------------------ start and stop */

void test_what_cannot_work_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_init(NULL, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_init(&port, NULL));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_start(NULL, &lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_start(&port, &lidar));
    receive_by_stream();
    wiring.stream_size = 127;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_init(&port, &wiring));
    wiring.stream_size = 128;
    wiring.priority = configMAX_PRIORITIES;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_init(&port, &wiring));
    wiring.priority = configMAX_PRIORITIES - 1;
    wiring.write = NULL;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_start(&port, &lidar));
    wiring.write = board_lidar_write;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_freertos_start(&port, NULL));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_STATE, tmini_freertos_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT(1, freertos_model_tasks());
}

void test_bytes_before_the_start_are_dropped(void)
{
    static const uint8_t start_scanning[2] = {0xA5, 0x60};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    board_enable_lidar_interrupt();
    (void)board_lidar_write(NULL, start_scanning, 2);
    machine_pass(600000);
    TEST_ASSERT_TRUE(machine.line_bytes > 1000);
    TEST_ASSERT_EQUAL_UINT32(0, counted().bytes);
}

static void assert_stops_and_starts(unsigned tasks)
{
    start();
    assert_true_scans(1, 1);
    for (unsigned i = 0; i < 20; i++) {
        tmini_freertos_stop(&port);
        const uint32_t bytes = counted().bytes;
        machine_pass(5000 + 100 * i);
        TEST_ASSERT_EQUAL_UINT32(bytes, counted().bytes);
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
        poll_until(TMINI_EVENT_SCAN);
        truth_assert_nothing_invented(tmini_scan(&lidar));
    }
    (void)scans_until_complete();
    TEST_ASSERT_EQUAL_UINT(tasks, freertos_model_tasks());
}

void test_it_stops_and_starts_while_the_lidar_streams(void)
{
    assert_stops_and_starts(0);
}

void test_the_receiving_task_sleeps_while_stopped_and_is_used_again(void)
{
    receive_by_stream();
    assert_stops_and_starts(1);
}

/* The receiving task notices the stop only when its wait for bytes times out. */
void test_stopping_waits_for_the_receiving_task_every_time(void)
{
    receive_by_stream();
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
        vTaskDelay(1);
        const uint64_t begun_us = machine.now_us;
        tmini_freertos_stop(&port);
        TEST_ASSERT_TRUE(machine.now_us > begun_us);
        TEST_ASSERT_TRUE(machine.now_us - begun_us <= 10000 + 2 * TICK_US);
    }
}

void test_bytes_in_the_stream_at_a_stop_are_not_handed_on_later(void)
{
    receive_by_stream();
    init_lidar(256);
    start();
    assert_true_scans(1, 1);
    machine_pass(50000); /* rx_buffer is full, and the stream half full. */
    tmini_freertos_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    TEST_ASSERT_EQUAL_INT(pdTRUE, xStreamBufferIsEmpty(port.stream));
}

/* ----------------------------------------------------------------------------------- the clock */

/* This file is compiled for three tick counters: 1000 Hz with 32 bits, 1024 Hz with 16 bits, and
 * 50 Hz. The one of 16 bits wraps around every 64 s; a step here is 4.3 s. */
void test_the_clock_runs_in_milliseconds_across_every_wrap_of_the_tick(void)
{
    const uint32_t begun_ms = tmini_freertos_port.now_ms(&port);
    uint64_t passed_us = 0;
    for (unsigned i = 0; i < 3000; i++) {
        world.skipped_us += 4294967 + i;
        passed_us += 4294967 + i;
        const uint32_t shown_ms = tmini_freertos_port.now_ms(&port) - begun_ms;
        const uint32_t error_ms = shown_ms - (uint32_t)(passed_us / 1000u);
        /* At most one tick late. */
        TEST_ASSERT_TRUE(error_ms + TICK_US / 1000u + 1u <= TICK_US / 1000u + 2u);
    }
}

void test_waiting_for_0_ticks_waits_for_one_tick(void)
{
    const uint64_t begun_us = machine.now_us;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    tmini_freertos_wait(&port, 0);
    TEST_ASSERT_TRUE(machine.now_us > begun_us);
}

static void restart_uart(void *uart)
{
    (void)uart;
    board_enable_lidar_interrupt();
}

void test_the_programs_uart_is_restarted_when_the_lidar_is_lost(void)
{
    wiring.restart = restart_uart;
    start();
    assert_true_scans(1, 1);
    world.interrupt_enabled = false;
    assert_recovery();
    world.interrupt_enabled = false;
    tmini_freertos_stop(&port);
    tmini_freertos_port.restart(&port); /* A restart of a stopped port does nothing. */
    wiring.restart = NULL;
    start();
    tmini_freertos_port.restart(&port);
}

void test_without_wiring_nothing_is_sent(void)
{
    static const uint8_t byte = 0xA5;
    TEST_ASSERT_EQUAL_INT(-1, tmini_freertos_port.write(&port, &byte, 1));
}
