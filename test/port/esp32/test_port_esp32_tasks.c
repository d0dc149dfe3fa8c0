/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the ESP32 port with the simulated lidar, with and without a receiving task. */

#include <string.h>

#include "unity.h"

#include "freertos/FreeRTOS.h"
#include "freertos/task.h"
#define PORT_WORK work
#include "every_port.h"
#include "tmini_esp32.h"
#include "idf.h"

static tmini_esp32_t port;
static tmini_esp32_wiring_t wiring;

static void wait(void)
{
    (void)tmini_esp32_wait(&port, pdMS_TO_TICKS(10));
}

static void work(uint32_t us)
{
    vTaskDelay(us / 10000u);
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
    TEST_ASSERT_EQUAL_UINT(1, idf_tasks());
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
    .hold_up = idf_hold_interrupts, .break_reception = idf_break_reception

const port_way_t port_ways[] = {
    {.name = "through a task", WAY},
    {.name = "through the caller's loop", .choose = through_the_callers_loop, WAY},
};
const unsigned port_way_count = sizeof port_ways / sizeof port_ways[0];

static void poll_all(void)
{
    while (tmini_poll(&lidar) != TMINI_EVENT_NONE) {
    }
}

/* Receives before it polls: bytes that arrived during the pause must not look like silence. */
static void receive_and_poll_all(void)
{
    size_t received = 0;
    do {
        received = tmini_esp32_wait(&port, 0);
        poll_all();
    } while (received > 0);
}

/* Starts without a receiving task: the test decides when events are read. At return the lidar
 * scans, and all bytes so far have been handed on. */
static void start_by_hand(void)
{
    wiring.with_task = false;
    start();
    poll_until(TMINI_EVENT_SCAN);
    receive_and_poll_all();
}

/* First come the FIFO's bytes, then the overflow, and then the bytes of about ten milliseconds. */
void test_an_overflow_is_reported_in_its_place_however_late_the_events_are_taken(void)
{
    start_by_hand();
    idf_hold_interrupts(20000);
    vTaskDelay(3);
    TEST_ASSERT_EQUAL_UINT(128, tmini_esp32_wait(&port, 0));
    TEST_ASSERT_EQUAL_UINT(128, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_feed_room(&lidar)); /* The gap is here. */
    poll_all();
    TEST_ASSERT_TRUE(tmini_esp32_wait(&port, 0) > 60);
    TEST_ASSERT_NOT_EQUAL_UINT(0, tmini_feed_room(&lidar)); /* No second gap. */
}

/* The driver's buffer holds at most 256 bytes. Bytes that did not fit were stashed, not lost. */
void test_with_a_full_buffer_the_gap_is_after_the_bytes_that_were_kept(void)
{
    wiring.buffer_size = 256;
    start_by_hand();
    vTaskDelay(5);
    const size_t received = tmini_esp32_wait(&port, 0);
    TEST_ASSERT_TRUE(received > 256);
    TEST_ASSERT_EQUAL_UINT(received, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_feed_room(&lidar));
}
