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
#include "virtual_idf.h"

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
    virtual_idf_begin(observer);
    memset(&port, 0, sizeof port);
    wiring = (tmini_esp32_wiring_t)TMINI_ESP32_WIRING_DEFAULT;
}

/* Nothing is left installed, and no call has named a missing driver. */
void port_assert_stopped(void)
{
    const virtual_idf_state_t state = virtual_idf_state();
    TEST_ASSERT_EQUAL_UINT(1, state.tasks);
    TEST_ASSERT_FALSE(state.installed);
    TEST_ASSERT_EQUAL_UINT(0, state.locks_held);
    TEST_ASSERT_EQUAL_UINT(0, state.stray_calls);
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
    wiring.queue_length = 128;
}

#define WAY                                                                      \
    .enlarge = enlarge, .holds = 8192, .behind = 128 + 8, .packets_per_loss = 4, \
    .hold_up = virtual_idf_hold_interrupts, .break_reception = virtual_idf_break_reception

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

/* A gap was reported after this many bytes: the library takes no more before a poll. */
static void assert_gap_after(size_t count)
{
    TEST_ASSERT_EQUAL_UINT(count, tmini_esp32_wait(&port, 0));
    TEST_ASSERT_EQUAL_UINT(count, tmini_ring_unread(&lidar.ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_feed_room(&lidar));
}

/* First come the FIFO's bytes, then the overflow, and then the bytes of about ten milliseconds. */
void test_an_overflow_is_reported_in_its_place_however_late_the_events_are_taken(void)
{
    start_by_hand();
    virtual_idf_hold_interrupts(20000);
    vTaskDelay(3);
    assert_gap_after(128);
    poll_all();
    TEST_ASSERT_TRUE(tmini_esp32_wait(&port, 0) > 60);
    TEST_ASSERT_NOT_EQUAL_UINT(0, tmini_feed_room(&lidar)); /* No second gap. */
}

/* Each gap costs a poll: any number of gaps is reported as at most two. */
void test_of_several_overflows_the_first_is_reported_in_its_place_and_one_after_the_others(void)
{
    start_by_hand();
    for (unsigned i = 0; i < 3; i++) {
        virtual_idf_hold_interrupts(20000);
        vTaskDelay(2);
    }
    vTaskDelay(1);
    assert_gap_after(128);
    poll_all();
    const size_t rest = tmini_esp32_wait(&port, 0);
    TEST_ASSERT_TRUE(rest > 256);
    TEST_ASSERT_EQUAL_UINT(0, tmini_feed_room(&lidar));
    poll_all();
    (void)tmini_esp32_wait(&port, 0);
    TEST_ASSERT_NOT_EQUAL_UINT(0, tmini_feed_room(&lidar));
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

/* About nine events come in the 30 ms between two polls, but the queue holds four. The port cannot
 * know which were lost: it assumes a gap, which costs the current packet. */
void test_when_events_are_lost_no_scan_is_complete(void)
{
    const unsigned rounds = 30;
    unsigned scans = 0;
    tmini_esp32_counters_t uart;
    tmini_counters_t counters;
    wiring.queue_length = 4;
    start_by_hand();
    for (unsigned i = 0; i < rounds; i++) {
        vTaskDelay(3);
        (void)tmini_esp32_wait(&port, 0);
        tmini_event_t event;
        while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) {
            scans += event == TMINI_EVENT_SCAN;
            TEST_ASSERT_FALSE(event == TMINI_EVENT_SCAN && tmini_scan(&lidar)->complete);
        }
    }
    tmini_esp32_counters(&port, &uart);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(rounds, uart.queues_full);
    TEST_ASSERT_NOT_EQUAL_UINT(0, scans);
    TEST_ASSERT_TRUE(truth_packets() - counters.packets <= rounds + 2);
}

void test_an_overflow_whose_event_was_lost_is_reported_too(void)
{
    tmini_esp32_counters_t uart;
    wiring.queue_length = 4;
    start_by_hand();
    vTaskDelay(2); /* Fills the queue. */
    virtual_idf_hold_interrupts(20000);
    vTaskDelay(3);
    TEST_ASSERT_NOT_EQUAL_UINT(0, tmini_esp32_wait(&port, 0));
    TEST_ASSERT_EQUAL_UINT(0, tmini_feed_room(&lidar));
    tmini_esp32_counters(&port, &uart);
    TEST_ASSERT_EQUAL_UINT32(0, uart.overruns); /* The event of the overflow was lost. */
    TEST_ASSERT_EQUAL_UINT32(1, uart.queues_full);

    poll_until(TMINI_EVENT_SCAN);
    TEST_ASSERT_FALSE(tmini_scan(&lidar)->complete);
}

static void assert_nothing_was_lost(void)
{
    tmini_esp32_counters_t uart;
    tmini_counters_t counters;
    tmini_esp32_counters(&port, &uart);
    tmini_counters(&lidar, &counters);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(0, uart.overruns);
    TEST_ASSERT_EQUAL_UINT32(0, uart.buffers_full);
    TEST_ASSERT_TRUE(truth_packets() > 200);
    TEST_ASSERT_TRUE(truth_packets() - counters.packets <= 12); /* Still in the buffers. */
}

/* Pauses of 10 ms, but every 20th is longer: 1570 bytes arrive, more than the library's ring
 * holds. */
void test_a_pause_of_120_ms_between_polls_loses_nothing(void)
{
    start();
    for (unsigned i = 0; i < 400; i++) {
        vTaskDelay(i % 20 == 0 ? 12 : 1);
        poll_all();
    }
    assert_nothing_was_lost();
}

/* As above, but in every turn of the loop: the driver's buffer is read whenever the ring has
 * room. */
void test_a_loop_that_always_pauses_for_120_ms_and_receives_by_itself_loses_nothing(void)
{
    wiring.with_task = false;
    start();
    for (unsigned i = 0; i < 40; i++) {
        vTaskDelay(12);
        receive_and_poll_all();
    }
    assert_nothing_was_lost();
}
