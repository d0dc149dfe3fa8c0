/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the ESP32 port with the simulated lidar, with and without a receiving task. */

#include <string.h>

#include "unity.h"

#include "freertos/FreeRTOS.h"
#include "freertos/task.h"
#include "every_port.h"
#include "tmini_esp32.h"
#include "idf.h"
#include "tasks.h"

static tmini_esp32_t port;
static tmini_esp32_wiring_t wiring;

static void wait(void)
{
    (void)tmini_esp32_wait(&port, pdMS_TO_TICKS(10));
}

PORT_UNDER_TEST(esp32, &wiring);

void port_begin(const sim_observer_t *observer)
{
    idf_begin(observer);
    idf_begin_tasks();
    memset(&port, 0, sizeof port);
    wiring = (tmini_esp32_wiring_t)TMINI_ESP32_WIRING_DEFAULT;
}

/* Nothing is left installed, and no call has named a missing driver. */
void port_assert_stopped(void)
{
    TEST_ASSERT_EQUAL_UINT(0, tasks_count());
    TEST_ASSERT_FALSE(idf.installed);
    TEST_ASSERT_EQUAL_UINT(0, idf.locks_held);
    TEST_ASSERT_EQUAL_UINT(0, idf.stray_calls);
}

port_counts_t port_counted(void)
{
    tmini_esp32_counters_t c;
    tmini_esp32_counters(&port, &c);
    return (port_counts_t){.bytes = c.bytes,
                           .lost = c.buffers_full + c.queues_full,
                           .overruns = c.overruns,
                           .framing_errors = c.framing_errors,
                           .breaks = c.breaks};
}

static void through_the_callers_loop(void)
{
    wiring.with_task = false;
}

static void enlarge(void)
{
    wiring.buffer_size = 8192;
    wiring.queue_length = 256;
}

#define WAY                                                                      \
    .enlarge = enlarge, .holds = 8192, .behind = 128 + 8, .packets_per_loss = 4, \
    .hold_up = machine_pass_held_up, .break_reception = idf_break_reception

const port_way_t port_ways[] = {
    {.name = "through a task", WAY},
    {.name = "through the caller's loop", .choose = through_the_callers_loop, WAY},
};
const unsigned port_way_count = sizeof port_ways / sizeof port_ways[0];
