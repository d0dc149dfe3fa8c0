/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The port template: compiles as it is, counts time, stores bytes, and does not pretend to send. */

#include "tmini_port_template.h"
#include "unity.h"

static uint8_t rx[256];
static tmini_t lidar;
static tmini_port_template_t port;

void setUp(void)
{
    const tmini_config_t config = {
        .port = &tmini_port_template,
        .port_context = &port,
        .rx_buffer = rx,
        .rx_size = sizeof rx,
    };
    tmini_port_template_init(&port, NULL);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
    tmini_port_template_start(&port, &lidar);
}

void tearDown(void) {}

void test_a_command_through_the_unfilled_template_fails_as_a_write_error(void)
{
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_request_info(&lidar));
    TEST_ASSERT_EQUAL(TMINI_EVENT_NONE, tmini_poll(&lidar));
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL(TMINI_EVENT_COMMAND_FAILED, tmini_poll(&lidar));
    TEST_ASSERT_EQUAL(TMINI_ERROR_WRITE, tmini_command_error(&lidar));
}

void test_the_clock_counts_ticks(void)
{
    tmini_port_template_tick(&port);
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL_UINT32(2, tmini_port_template.now_ms(&port));
}

void test_the_clock_wraps_around_at_32_bits(void)
{
    port.time_ms = 0xFFFFFFFFu;
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL_UINT32(0, tmini_port_template.now_ms(&port));
}

void test_a_received_byte_reaches_the_lidar(void)
{
    tmini_counters_t counters;
    tmini_port_template_receive(&port, 0x11, false);
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(0, port.receive_errors);
}

void test_a_byte_with_an_error_is_counted_and_still_reaches_the_lidar(void)
{
    tmini_counters_t counters;
    tmini_port_template_receive(&port, 0x11, true);
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(1, port.receive_errors);
}

void test_after_stop_bytes_go_nowhere_and_after_start_to_the_lidar_again(void)
{
    tmini_counters_t counters;
    tmini_port_template_stop(&port);
    tmini_port_template_receive(&port, 0x11, false);
    tmini_port_template_start(&port, &lidar);
    tmini_port_template_receive(&port, 0x11, false);
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.bytes_skipped);
}
