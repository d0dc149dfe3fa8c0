/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "zephyr_rig.h"

#include <string.h>

#include "unity.h"

tmini_zephyr_t port;

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

tmini_zephyr_counters_t counted(void)
{
    tmini_zephyr_counters_t counters;
    tmini_zephyr_counters(&port, &counters);
    return counters;
}

port_counts_t port_counted(void)
{
    const tmini_zephyr_counters_t c = counted();
    return (port_counts_t){.bytes = c.bytes,
                           .overruns = c.overruns,
                           .framing_errors = c.framing_errors,
                           .breaks = c.breaks};
}
