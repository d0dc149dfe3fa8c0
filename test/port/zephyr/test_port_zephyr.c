/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the Zephyr port on a model of a board with the simulated lidar: what holds for both UART
 * APIs. test_port_zephyr_irq.c and test_port_zephyr_async.c describe and test the two. */

#include <errno.h>
#include <string.h>

#include "unity.h"

#include "every_port.h"
#include "tmini_zephyr.h"
#include "zephyr_model.h"

static tmini_zephyr_t port;

static void wait(void)
{
    tmini_zephyr_wait(&port, K_MSEC(10));
}

void port_sleep(uint32_t due_ms)
{
    tmini_zephyr_sleep(&port, due_ms);
}

const uint32_t port_tick_us = 1000;

PORT_UNDER_TEST(zephyr, &zephyr_model_uart);

void port_begin(const sim_observer_t *observer)
{
    zephyr_model_begin(observer);
    memset(&port, 0, sizeof port);
}

void port_assert_stopped(void)
{
    TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
}

port_counts_t port_counted(void)
{
    tmini_zephyr_counters_t c;
    tmini_zephyr_counters(&port, &c);
    return (port_counts_t){.bytes = c.bytes,
                           .overruns = c.overruns,
                           .framing_errors = c.framing_errors,
                           .breaks = c.breaks};
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
    start_port();
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
