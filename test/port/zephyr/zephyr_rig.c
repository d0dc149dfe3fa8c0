/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "zephyr_rig.h"

#include <string.h>

#include "unity.h"

#include "scanning.h"
#include "zephyr_model.h"

tmini_zephyr_t port;

static void wait(void)
{
    tmini_zephyr_wait(&port, K_MSEC(10));
}

void zephyr_rig_begin(void)
{
    const sim_observer_t observer = truth_begin();
    const scanning_t program = {
        .port = &tmini_zephyr_port, .context = &port, .wait = wait, .work = machine_pass};
    zephyr_model_begin(&observer);
    memset(&port, 0, sizeof port);
    scanning_begin(&program, 1024);
}

void zephyr_rig_end(void)
{
    tmini_zephyr_stop(&port);
    TEST_ASSERT_FALSE(board.receiving || board.async_is_on);
}

int zephyr_rig_start_port(void)
{
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_init(&port, &zephyr_model_uart));
    return tmini_zephyr_start(&port, &lidar);
}

void zephyr_rig_start(void)
{
    TEST_ASSERT_EQUAL_INT(0, zephyr_rig_start_port());
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_start(&lidar));
}

tmini_zephyr_counters_t zephyr_rig_counters(void)
{
    tmini_zephyr_counters_t counters;
    tmini_zephyr_counters(&port, &counters);
    return counters;
}
