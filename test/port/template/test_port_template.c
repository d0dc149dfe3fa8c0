/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the unchanged port template: it counts time and stores bytes, and sending fails. */

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
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_init(&port, NULL));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_init(&lidar, &config));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_start(&port, &lidar));
}

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
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFFu, tmini_port_template.now_ms(&port));
    tmini_port_template_tick(&port);
    TEST_ASSERT_EQUAL_UINT32(0, tmini_port_template.now_ms(&port));
}

/* What the interrupt does with a byte; returns how many have reached the lidar. */
static uint32_t receive(bool error)
{
    tmini_counters_t counters;
    tmini_port_template_receive(&port, 0x11, error);
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(&lidar, &counters);
    return counters.bytes_skipped;
}

void test_a_byte_reaches_the_lidar_also_with_an_error_which_is_counted(void)
{
    TEST_ASSERT_EQUAL_UINT32(1, receive(false));
    TEST_ASSERT_EQUAL_UINT32(0, line_errors());
    TEST_ASSERT_EQUAL_UINT32(2, receive(true));
    TEST_ASSERT_EQUAL_UINT32(1, line_errors());
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
    TEST_ASSERT_EQUAL_UINT32(0, receive(false));
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_start(&port, &lidar));
    TEST_ASSERT_EQUAL_UINT32(1, receive(false));
}
