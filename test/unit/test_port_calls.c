/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the driver asks of its port: which functions, in which order, with which bytes, and with the
 * port's own context. The port is mocked; a call that is not expected fails the test. */

#include "mock_port_functions.h"

#include "tmini/tmini.h"
#include "tmini/tmini_blocking.h"

#include "unity.h"

static const uint8_t stop[] = {0xA5, 0x65};
static const uint8_t health[] = {0xA5, 0x92};
static const uint8_t health_reply[] = {0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06, 0x02, 0x00, 0x00};

static int context;
static tmini_t lidar;
static uint8_t rx[256];
static const tmini_port_t port = {.write = port_write, .now_ms = port_now_ms, .wait = port_wait};
static const tmini_config_t config = {
    .port = &port, .port_context = &context, .rx_buffer = rx, .rx_size = sizeof rx};

/* Asks nothing of the port. */
void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_init(&lidar, &config));
}

static void expect_clock(uint32_t now_ms)
{
    port_now_ms_ExpectAndReturn(&context, now_ms);
}

/* Stops the lidar, whose line is quiet from then on. */
static void make_idle(void)
{
    expect_clock(1000);
    port_write_ExpectAndReturn(&context, stop, 2, 2);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&lidar));
    port_now_ms_IgnoreAndReturn(1050);
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_STOPPED, tmini_poll(&lidar));
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidar));
    port_now_ms_StopIgnore();
}

void test_a_call_reads_the_clock_and_writes_a_command_whole(void)
{
    expect_clock(1000);
    port_write_ExpectAndReturn(&context, stop, 2, 2);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&lidar));
}

void test_a_port_that_took_one_byte_is_offered_the_rest(void)
{
    expect_clock(1000);
    port_write_ExpectAndReturn(&context, stop, 2, 1);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&lidar));
    expect_clock(1001);
    port_write_ExpectAndReturn(&context, &stop[1], 1, 1);
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidar));
}

void test_a_poll_with_nothing_to_do_reads_the_clock_once(void)
{
    make_idle();
    expect_clock(1051);
    TEST_ASSERT_EQUAL_INT(TMINI_EVENT_NONE, tmini_poll(&lidar));
}

static void reply(void *of, int calls)
{
    TEST_ASSERT_EQUAL_PTR(&context, of);
    TEST_ASSERT_EQUAL_INT(0, calls);
    tmini_feed(&lidar, health_reply, sizeof health_reply);
}

/* The reply comes while it waits. */
void test_a_blocking_call_waits_by_the_port(void)
{
    tmini_health_t result;
    make_idle();
    port_now_ms_IgnoreAndReturn(1060);
    port_write_ExpectAndReturn(&context, health, 2, 2);
    port_wait_AddCallback(reply);
    port_wait_Expect(&context);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_blocking_read_health(&lidar, &result, 1000));
    TEST_ASSERT_EQUAL_HEX8(0x02, result.faults);
}
