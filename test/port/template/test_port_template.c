/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the unchanged port template: it counts time and stores bytes, and sending fails. */

#include "encoder.h"
#include "irq_lines.h"
#include "tmini_port_template.h"
#include "unity.h"

#define PACKETS 5u

static uint8_t rx[256];
static tmini_t lidar;
static tmini_port_template_t port;

static uint8_t stream[PACKETS * ENCODE_PACKET_MAX];
static size_t stream_size;
static size_t arrived;
static size_t taken;
static uint32_t accesses;

static bool line_is_up(void)
{
    return taken < arrived;
}

static void serve_line(void)
{
    tmini_port_template_receive(&port, stream[taken++], false);
}

static void fail(unsigned line)
{
    (void)line;
    TEST_FAIL_MESSAGE("locked up");
}

/* A byte arrives at every third access to the library's indices. */
void interrupt(void)
{
    arrived += arrived < stream_size && ++accesses % 3 == 0;
    irq_access();
}

void setUp(void)
{
    stream_size = 0;
    arrived = 0;
    taken = 0;
    irq_reset(fail);
    irq.lines[0] = (irq_line_t){.is_up = line_is_up, .handler = serve_line};
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

void tearDown(void) {}

static uint32_t line_errors(void)
{
    tmini_port_template_counters_t counters;
    tmini_port_template_counters(&port, &counters);
    return counters.line_errors;
}

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
    TEST_ASSERT_EQUAL_UINT32(0, line_errors());
}

void test_a_byte_with_an_error_is_counted_and_still_reaches_the_lidar(void)
{
    tmini_counters_t counters;
    tmini_port_template_receive(&port, 0x11, true);
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(1, line_errors());
}

void test_bytes_at_any_access_of_a_poll_reach_the_lidar(void)
{
    static const encode_sample_t samples[2] = {{.distance_mm = 500}, {.distance_mm = 900}};
    static const encode_packet_t packet = {
        .lsn = 2, .first_q6 = 640, .last_q6 = 704, .samples = samples};
    tmini_counters_t counters;
    for (unsigned i = 0; i < PACKETS; i++) {
        stream_size += encode_packet(&stream[stream_size], &packet);
    }
    while (taken < stream_size || tmini_poll(&lidar) != TMINI_EVENT_NONE) {
        (void)tmini_poll(&lidar);
    }
    tmini_counters(&lidar, &counters);
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
    tmini_counters_t counters;
    tmini_port_template_stop(&port);
    tmini_port_template_receive(&port, 0x11, false);
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_port_template_start(&port, &lidar));
    tmini_port_template_receive(&port, 0x11, false);
    (void)tmini_poll(&lidar);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(1, counters.bytes_skipped);
}
