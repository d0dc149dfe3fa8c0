/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the FreeRTOS port on a model of the kernel with the simulated lidar. The test itself is the
 * polling task. */

#include <string.h>

#include "unity.h"

#include "board.h"
#include "every_port.h"
#include "freertos_model.h"
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

void port_sleep(uint32_t due_ms)
{
    tmini_freertos_sleep(&port, due_ms);
}

const uint32_t port_tick_us = TICK_US;

static void restart_uart(void *uart)
{
    (void)uart;
    board_enable_lidar_interrupt();
}

PORT_UNDER_TEST(freertos, &wiring);

void port_begin(const sim_observer_t *observer)
{
    freertos_model_begin(observer, POLLING_PRIORITY);
    memset(&port, 0, sizeof port);
    wiring = (tmini_freertos_wiring_t){.write = board_lidar_write, .restart = restart_uart};
    board_enable_lidar_interrupt();
}

/* The receiving task sleeps and is used again. */
void port_assert_stopped(void)
{
    TEST_ASSERT_EQUAL_UINT(port.receiver != NULL ? 1 : 0, tasks_count());
}

static void receive_by_stream(void)
{
    wiring.stream = stream;
    wiring.stream_size = 1024;
    wiring.priority = RECEIVING_PRIORITY;
}

static void enlarge(void)
{
    wiring.stream_size = sizeof stream;
}

static void disable_interrupt(void)
{
    world.interrupt_enabled = false;
}

const port_way_t port_ways[] = {
    {.name = "from the interrupt",
     .holds = 870, /* A pause of 60 ms. */
     .packets_per_loss = 4,
     .behind = 16,
     .hold_up = machine_pass_held_up,
     .break_reception = disable_interrupt,
     .loss = 1},
    {.name = "through a stream",
     .choose = receive_by_stream,
     .enlarge = enlarge,
     .holds = sizeof stream,
     .packets_per_loss = 6,
     .behind = 16,
     .hold_up = machine_pass_held_up,
     .break_reception = disable_interrupt,
     .loss = 1},
};
const unsigned port_way_count = sizeof port_ways / sizeof port_ways[0];

port_counts_t port_counted(void)
{
    tmini_freertos_counters_t c;
    tmini_freertos_counters(&port, &c);
    return (port_counts_t){.bytes = c.bytes, .lost = c.bytes_lost, .overruns = c.overruns};
}

/* These bytes come, after an overrun or not, and the last interrupt for them. No task runs
 * meanwhile. */
static void receive(bool overrun, const uint8_t *bytes, size_t count)
{
    machine_receive(overrun, bytes, count);
    machine_step(200);
}

/* ------------------------------------------------------------------------- from the interrupt */

void test_the_polling_task_is_woken_once_per_64_bytes(void)
{
    start();
    assert_true_scans(1, 10);
    TEST_ASSERT_UINT_WITHIN(machine.line_bytes / 64 / 5, machine.line_bytes / 64, world.wakes);
}

/* ---------------------------------------------------------------------------- through a stream */

/* Only the bytes read together with the overrun are lost: the receiving task is woken at once, not
 * by its timeout. */
void test_an_overrun_costs_no_more_than_the_bytes_in_the_fifo(void)
{
    receive_by_stream();
    start();
    assert_true_scans(1, 2);
    for (unsigned i = 0; i < 20; i++) {
        world.overrun = true;
        while (world.overrun) {
            poll_until(TMINI_EVENT_SCAN);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(20, port_counted().overruns);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(20 * 16, port_counted().lost);
}

/* After the gap, the lidar takes no byte before the polling task has emptied rx_buffer. */
void test_an_overrun_before_the_stream_wakes_the_polling_task(void)
{
    receive_by_stream();
    start_port();
    tmini_freertos_wait(&port, 1); /* The first call sets the task that is to be woken. */
    receive(true, manual_packet, 1);
    const uint64_t begun_us = machine.now_us;
    tmini_freertos_wait(&port, pdMS_TO_TICKS(1000));
    TEST_ASSERT_TRUE(machine.now_us - begun_us < 100000);
}

/* --------------------------------------------------------------- losses that bytes do not show */

static void fill_small_stream(void)
{
    static const uint8_t nothing[97] = {0};
    receive_by_stream();
    wiring.stream_size = 128; /* It holds 127 bytes. */
    start_port();
    receive(false, nothing, sizeof nothing);
    receive(false, manual_packet, PACKET_CUT);
    TEST_ASSERT_EQUAL_UINT32(0, port_counted().lost);
    receive(false, nothing, 10);
    TEST_ASSERT_EQUAL_UINT32(10, port_counted().lost);
}

void test_no_packet_is_put_together_across_a_full_stream(void)
{
    fill_small_stream();
    vTaskDelay(pdMS_TO_TICKS(20)); /* The receiving task empties the stream. */
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    receive(false, &manual_packet[PACKET_CUT], sizeof manual_packet - PACKET_CUT);
    vTaskDelay(pdMS_TO_TICKS(20));
    TEST_ASSERT_EQUAL_UINT32(0, packets());
    TEST_ASSERT_EQUAL_UINT32(10, port_counted().lost); /* The stream is open again. */
}

void test_a_stream_that_was_full_takes_no_byte_until_it_is_empty(void)
{
    uint8_t taken[60];
    fill_small_stream();
    TEST_ASSERT_EQUAL_UINT(60, xStreamBufferReceive(port.stream, taken, sizeof taken, 0));
    receive(false, &manual_packet[PACKET_CUT], sizeof manual_packet - PACKET_CUT);
    TEST_ASSERT_EQUAL_UINT32(10 + sizeof manual_packet - PACKET_CUT, port_counted().lost);
}

/* It holds 127 of two packets' 134 bytes. */
void test_a_stream_that_was_full_when_stopped_is_open_and_empty_at_the_next_start(void)
{
    fill_small_stream();
    tmini_freertos_stop(&port);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    TEST_ASSERT_EQUAL_size_t(1024, tmini_feed_room(&lidar));
    receive(false, manual_packet, sizeof manual_packet);
    TEST_ASSERT_EQUAL_UINT32(0, port_counted().lost);
    receive(false, manual_packet, sizeof manual_packet);
    TEST_ASSERT_EQUAL_UINT32(134 - 127, port_counted().lost);
    TEST_ASSERT_EQUAL_UINT32(134, port_counted().bytes);
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
    TEST_ASSERT_EQUAL_UINT(1, tasks_count());
}

/* Without room for its bytes, the receiving task notices the stop only after a tick. */
void test_stopping_waits_for_the_receiving_task_every_time(void)
{
    static const uint8_t nothing[300];
    receive_by_stream();
    init_lidar(256);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    for (unsigned i = 0; i < 6; i++) {
        const bool is_full = i % 2 == 1;
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
        receive(false, nothing, is_full ? sizeof nothing : 0);
        vTaskDelay(1);
        const uint64_t begun_us = machine.now_us;
        tmini_freertos_stop(&port);
        TEST_ASSERT_TRUE(port.is_parked);
        TEST_ASSERT_EQUAL(is_full, machine.now_us > begun_us);
        TEST_ASSERT_TRUE(machine.now_us - begun_us <= 2 * TICK_US);
        poll_all();
    }
}

/* ------------------------------------------------------------------------------------- sleeping */

/* A tick of 16 bits wraps around after 64 s; its maximum would mean for ever. */
void test_no_sleep_reaches_the_wrap_of_the_tick(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_init(&port, &wiring));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_freertos_start(&port, &lidar));
    const uint64_t begun_us = machine.now_us;
    tmini_freertos_sleep(&port, 65535);
    TEST_ASSERT_EQUAL_UINT64(begun_us, machine.now_us); /* The first call. */
    tmini_freertos_sleep(&port, 0);
    TEST_ASSERT_EQUAL_UINT64(begun_us, machine.now_us);
    tmini_freertos_sleep(&port, 65535);
    TEST_ASSERT_TRUE(machine.now_us - begun_us > 30000000);
    TEST_ASSERT_TRUE(machine.now_us - begun_us <= 65535000);
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
