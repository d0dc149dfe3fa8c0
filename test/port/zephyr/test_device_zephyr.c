/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the lidar as a Zephyr device, made from its devicetree node. */

#include <string.h>

#include "unity.h"

#include "scanning.h"
#include "tmini_zephyr_device.h"
#include "zephyr_model.h"

static const struct device *const device = DEVICE_DT_GET(DT_NODELABEL(lidar));
static unsigned scans;
static unsigned infos;
static const tmini_scan_t *last;
static tmini_point_t copy[CONFIG_TMINI_POINTS];
static unsigned copied;

static void on_event(const struct device *from, tmini_event_t event, void *user_data)
{
    TEST_ASSERT_EQUAL_PTR(device, from);
    TEST_ASSERT_NOT_EQUAL_INT(TMINI_EVENT_NONE, event);
    TEST_ASSERT_EQUAL_PTR(&scans, user_data);
    infos += event == TMINI_EVENT_INFO;
    if (event == TMINI_EVENT_SCAN) {
        scans++;
        last = tmini_scan(tmini_zephyr_device_lidar(from));
        copied = last->count;
        memcpy(copy, last->points, copied * sizeof copy[0]);
        truth_assert_some_revolution(last);
    }
}

void setUp(void)
{
    const sim_observer_t observer = truth_begin();
    zephyr_model_begin(&observer);
    zephyr_model_boot();
    scans = 0;
    infos = 0;
    tmini_zephyr_device_callback_set(device, on_event, &scans);
}

static void pass_ms(int ms)
{
    (void)k_sleep(K_MSEC(ms));
}

void test_each_scan_is_an_event_at_the_devicetrees_frequency(void)
{
    tmini_zephyr_counters_t uart;
    TEST_ASSERT_TRUE(device_is_ready(device));
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_device_start(device));
    pass_ms(3000);
    scans = 0;
    pass_ms(1000);
    TEST_ASSERT_UINT_WITHIN(1, 10, scans);
    TEST_ASSERT_EQUAL_UINT(1000, sim_frequency_chz(&machine.lidar));
    tmini_zephyr_device_counters(device, &uart);
    TEST_ASSERT_UINT_WITHIN(64, machine.line_bytes, uart.bytes);
}

void test_a_scan_stays_valid_until_the_next(void)
{
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_device_start(device));
    while (scans < 2) {
        pass_ms(10);
    }
    pass_ms(80);
    TEST_ASSERT_EQUAL_UINT(copied, last->count);
    TEST_ASSERT_EQUAL_MEMORY(copy, last->points, copied * sizeof copy[0]);
}

void test_it_scans_until_it_is_stopped(void)
{
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_device_start(device));
    pass_ms(3000);
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_device_stop(device));
    pass_ms(500);
    scans = 0;
    pass_ms(500);
    TEST_ASSERT_EQUAL_UINT(0, scans);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_IDLE, tmini_state(tmini_zephyr_device_lidar(device)));
}

/* At rest, nothing but the unlocking wakes the thread. */
void test_a_command_between_lock_and_unlock_wakes_the_sleeping_thread(void)
{
    pass_ms(5000);
    const unsigned before = board.waits;
    pass_ms(60000);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(3, board.waits - before);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_request_info(tmini_zephyr_device_lock(device)));
    tmini_zephyr_device_unlock(device);
    pass_ms(100);
    TEST_ASSERT_EQUAL_UINT(1, infos);
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_device_start(device));
    pass_ms(3000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_SCANNING, tmini_state(tmini_zephyr_device_lidar(device)));
}

void test_without_a_callback_the_device_scans_too(void)
{
    tmini_zephyr_device_callback_set(device, NULL, NULL);
    TEST_ASSERT_EQUAL_INT(0, tmini_zephyr_device_start(device));
    pass_ms(3000);
    TEST_ASSERT_EQUAL_INT(TMINI_STATE_SCANNING, tmini_state(tmini_zephyr_device_lidar(device)));
    TEST_ASSERT_EQUAL_UINT(0, scans);
}

void test_a_request_that_the_library_refuses_is_an_error(void)
{
    memset(tmini_zephyr_device_lidar(device), 0, sizeof(tmini_t));
    TEST_ASSERT_LESS_THAN_INT(0, tmini_zephyr_device_start(device));
    TEST_ASSERT_LESS_THAN_INT(0, tmini_zephyr_device_stop(device));
}

void test_a_uart_that_is_not_ready_makes_no_device(void)
{
    zephyr_model_begin(NULL);
    board.ready = false;
    zephyr_model_boot();
    TEST_ASSERT_FALSE(device_is_ready(device));
    TEST_ASSERT_LESS_THAN_INT(0, tmini_zephyr_device_start(device));
}
