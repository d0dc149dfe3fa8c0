/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A thread acts as the line: each millisecond it passes on the simulated lidar's bytes. */

#include <zephyr/device.h>
#include <zephyr/drivers/serial/uart_emul.h>
#include <zephyr/kernel.h>
#include <zephyr/ztest.h>

#include "judge_scan.h"
#include "tmini_zephyr_device.h"

#define LINE_STACK 4096

static const struct device *const device = DEVICE_DT_GET(DT_NODELABEL(lidar));
static const struct device *const uart = DEVICE_DT_GET(DT_BUS(DT_NODELABEL(lidar)));

static sim_t sim;
static sim_judge_t judge;
static unsigned true_scans;
static unsigned other_scans;

static uint64_t now_us(void)
{
    return (uint64_t)k_uptime_get() * 1000u;
}

static void note_packet(void *context, const sim_packet_t *packet)
{
    ARG_UNUSED(context);
    (void)sim_judge_sent(&judge, packet);
}

static void on_sent(const struct device *from, size_t size, void *user_data)
{
    uint8_t bytes[16];
    ARG_UNUSED(size);
    ARG_UNUSED(user_data);
    sim_receive(&sim, bytes, uart_emul_get_tx_data(from, bytes, sizeof bytes), now_us());
}

static void run_line(void *p1, void *p2, void *p3)
{
    ARG_UNUSED(p1);
    ARG_UNUSED(p2);
    ARG_UNUSED(p3);
    for (;;) {
        uint8_t bytes[64];
        const size_t count = sim_transmit(&sim, now_us(), bytes, sizeof bytes);
        (void)uart_emul_put_rx_data(uart, bytes, count);
        k_sleep(K_MSEC(1));
    }
}

K_THREAD_STACK_DEFINE(line_stack, LINE_STACK);
static struct k_thread line;

static bool is_true(const tmini_scan_t *scan)
{
    const sim_reading_t reading = judge_scan(&judge, scan);
    return scan->complete && reading.lies == 0 && reading.missing == 0;
}

static void on_event(const struct device *from, tmini_event_t event, void *user_data)
{
    ARG_UNUSED(user_data);
    if (event == TMINI_EVENT_SCAN) {
        const bool as_sent = is_true(tmini_scan(tmini_zephyr_device_lidar(from)));
        true_scans += as_sent;
        other_scans += !as_sent;
    }
}

static void *set_up(void)
{
    sim_config_t config = sim_default_config();
    const sim_observer_t observer = {.on_packet = note_packet};
    config.marked = true;
    sim_judge_begin(&judge);
    sim_init(&sim, &config);
    sim_observe(&sim, &observer);
    uart_emul_callback_tx_data_ready_set(uart, on_sent, NULL);
    k_thread_create(&line, line_stack, LINE_STACK, run_line, NULL, NULL, NULL, 1, 0, K_NO_WAIT);
    tmini_zephyr_device_callback_set(device, on_event, NULL);
    return NULL;
}

static void start_anew(void *fixture)
{
    ARG_UNUSED(fixture);
    zassert_ok(tmini_zephyr_device_start(device));
    k_sleep(K_SECONDS(4));
    true_scans = 0;
    other_scans = 0;
}

static void stop(void *fixture)
{
    ARG_UNUSED(fixture);
    zassert_ok(tmini_zephyr_device_stop(device));
    k_sleep(K_SECONDS(1));
    zassert_equal(sim_mode(&sim), SIM_IDLE);
}

ZTEST_SUITE(tmini_device, NULL, set_up, start_anew, stop, NULL);

ZTEST(tmini_device, test_each_revolution_is_a_true_scan_at_the_devicetrees_frequency)
{
    k_sleep(K_SECONDS(10));
    zassert_within(true_scans, 100, 2);
    zassert_equal(other_scans, 0);
    zassert_equal(sim_frequency_chz(&sim), 1000);
}

ZTEST(tmini_device, test_it_comes_back_after_a_power_failure)
{
    sim_power(&sim, false, now_us());
    k_sleep(K_SECONDS(2));
    sim_power(&sim, true, now_us());
    k_sleep(K_SECONDS(20));
    true_scans = 0;
    k_sleep(K_SECONDS(2));
    zassert_within(true_scans, 20, 1);
}

/* More bytes arrive at once than the UART's FIFO holds. */
ZTEST(tmini_device, test_lost_bytes_cost_scans_and_are_counted)
{
    static uint8_t burst[512];
    tmini_zephyr_counters_t counters;
    (void)uart_emul_put_rx_data(uart, burst, sizeof burst);
    k_sleep(K_SECONDS(1));
    tmini_zephyr_device_counters(device, &counters);
    zassert_equal(counters.overruns, 1);
    zassert_within(true_scans, 9, 1);
    zassert_within(other_scans, 2, 1);
}
