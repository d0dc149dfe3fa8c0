/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the unchanged port template: it counts time and stores bytes, and sending fails. */

#include "known_packets.h"
#include "machine.h"
#include "tmini_port_template.h"
#include "unity.h"

#define PACKETS 5u

static const uint8_t noise = 0x11;
static uint8_t rx[256];
static tmini_t lidar;
static tmini_port_template_t port;
static tmini_counters_t counters;

#define ERROR 0x100u

static void arrive(uint32_t flags, uint8_t byte)
{
    (void)machine_put(flags | byte);
}

static bool is_up(void)
{
    return machine.count > 0;
}

static void serve(void)
{
    const uint16_t entry = machine_take();
    tmini_port_template_receive(&port, (uint8_t)entry, (entry & ERROR) != 0);
}

void setUp(void)
{
    static const machine_uart_t uart = {
        .fifo_size = 1, .arrive = arrive, .is_up = is_up, .serve = serve};
    const tmini_config_t config = {
        .port = &tmini_port_template,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
    };
    machine_begin(NULL, &uart);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_init(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_start(&port, &lidar));
}

void tearDown(void) {}

static uint32_t line_errors(void)
{
    tmini_port_template_counters_t line;
    tmini_port_template_counters(&port, &line);
    return line.line_errors;
}

void test_a_command_through_the_unfilled_template_fails_as_a_write_error(void)
{
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_request_info(&lidar));
    TEST_ASSERT_EQUAL(TMINI_EVENT_NONE, tmini_poll(&lidar));
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL(TMINI_EVENT_COMMAND_FAILED, tmini_poll(&lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_WRITE, tmini_command_error(&lidar));
}

void test_the_clock_counts_ticks_and_wraps_around_at_32_bits(void)
{
    tmini_port_template_tick(&port);
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL_UINT32(2, tmini_port_template.now_ms(&port));
    port.time_ms = 0xFFFFFFFFu;
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL_UINT32(0, tmini_port_template.now_ms(&port));
}

static void poll_all(void)
{
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(&lidar, &counters);
}

void test_a_byte_reaches_the_lidar_also_with_an_error_which_is_counted(void)
{
    for (uint32_t errors = 0; errors < 2; errors++) {
        machine_receive(errors * ERROR, &noise, 1);
        poll_all();
        TEST_ASSERT_EQUAL_UINT32(errors + 1, counters.bytes_skipped);
        TEST_ASSERT_EQUAL_UINT32(errors, line_errors());
    }
}

/* At every third one. */
void test_bytes_at_any_access_of_a_poll_reach_the_lidar(void)
{
    machine.access_ns = MACHINE_BYTE_NS / 3;
    for (unsigned i = 0; i < PACKETS; i++) {
        machine_send(0, start_packet, sizeof start_packet);
    }
    while (!machine_has_sent()) {
        (void)tmini_poll(&lidar);
    }
    poll_all();
    TEST_ASSERT_EQUAL_UINT32(PACKETS, counters.packets);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_skipped);
}

void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_port_template_init(NULL, NULL));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_port_template_start(NULL, &lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_ARGUMENT, tmini_port_template_start(&port, NULL));
}

void test_a_restart_of_a_stopped_port_starts_nothing(void)
{
    tmini_port_template_stop(&port);
    tmini_port_template.restart(&port);
    TEST_ASSERT_NULL(port.lidar);
}

void test_after_stop_bytes_are_dropped_and_after_start_they_reach_the_lidar(void)
{
    tmini_port_template_stop(&port);
    machine_receive(0, &noise, 1);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_start(&port, &lidar));
    machine_receive(0, &noise, 1);
    poll_all();
    TEST_ASSERT_EQUAL_UINT32(1, counters.bytes_skipped);
}
