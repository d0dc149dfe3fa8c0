/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "sleeping.h"

#include "every_port.h"
#include "irq_lines.h"
#include "unity.h"

#define CUT_US 5000000u
#define POWER_US 17000000u
#define STOP_US 30000000u
#define END_US 33000000u
#define TURNS_US 333333u /* Two at 6 Hz. */
#define EVENTS_MAX 40u

static void sleep_until_due(void)
{
    port_sleep(tmini_next_poll_ms(&lidar));
}

/* Bytes wait for 10 ms at most, and the kernel may be late. */
static uint32_t patience_us(void)
{
    return 10000 + 2 * port_tick_us;
}

/* ----------------------------------------------------------------------------- the same events */

typedef struct {
    tmini_event_t event;
    uint64_t time_us;
} happened_t;

typedef struct {
    happened_t events[EVENTS_MAX]; /* Without scans. */
    unsigned count;
    unsigned scans;
} log_t;

/* Called at each step of time: the supply does not wait for the program to wake up. */
static void switch_supply(void)
{
    const bool is_on = machine.now_us < CUT_US || machine.now_us >= POWER_US;
    static bool was_on = true;
    if (is_on != was_on) {
        machine_power(is_on);
        was_on = is_on;
    }
}

static void note(log_t *log, tmini_event_t event)
{
    if (event == TMINI_EVENT_SCAN) {
        log->scans++;
    } else if (event != TMINI_EVENT_MORE && event != TMINI_EVENT_NONE) {
        TEST_ASSERT_LESS_THAN_UINT(EVENTS_MAX, log->count);
        log->events[log->count++] = (happened_t){event, machine.now_us};
    }
}

static void poll_all(log_t *log)
{
    tmini_event_t event;
    while ((event = tmini_poll(&lidar)) != TMINI_EVENT_NONE) {
        note(log, event);
    }
}

/* The lidar starts, is without power for 12 s, comes back, and is stopped. */
static void run(log_t *log, void (*pause)(void))
{
    bool is_stopped = false;
    machine.uart.move = switch_supply;
    start();
    while (machine.now_us < END_US) {
        poll_all(log);
        if (!is_stopped && machine.now_us >= STOP_US) {
            is_stopped = true;
            TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&lidar));
        }
        pause();
    }
}

/* RECOVERED comes with a start packet, once per turn. */
void test_a_program_that_sleeps_gets_the_same_events_as_one_that_polls_each_10_ms(void)
{
    static const tmini_event_t expected[] = {TMINI_EVENT_STARTED, TMINI_EVENT_LOST,
                                             TMINI_EVENT_RECOVERED, TMINI_EVENT_STOPPED};
    while (next_way()) {
        log_t often = {.count = 0};
        log_t seldom = {.count = 0};
        run(&often, port_program.wait);
        begin_again();
        run(&seldom, sleep_until_due);
        TEST_ASSERT_EQUAL_UINT(4, often.count);
        TEST_ASSERT_EQUAL_UINT(4, seldom.count);
        for (unsigned i = 0; i < 4; i++) {
            const happened_t *const event = &seldom.events[i];
            const uint32_t limit_us =
                event->event == TMINI_EVENT_RECOVERED ? TURNS_US : patience_us();
            TEST_ASSERT_EQUAL_INT(expected[i], often.events[i].event);
            TEST_ASSERT_EQUAL_INT(expected[i], event->event);
            TEST_ASSERT_UINT64_WITHIN(limit_us, often.events[i].time_us, event->time_us);
        }
        TEST_ASSERT_UINT_WITHIN(1, often.scans, seldom.scans);
    }
}

/* ------------------------------------------------------------------------------------- wake-ups */

static unsigned pauses(void (*pause)(void), uint32_t ms)
{
    const uint64_t end_us = machine.now_us + 1000u * (uint64_t)ms;
    log_t log = {.count = 0};
    unsigned count = 0;
    while (machine.now_us < end_us) {
        poll_all(&log);
        pause();
        count++;
    }
    return count;
}

/* At rest nothing is due; a lost lidar is asked and started again; a scanning one is as if the
 * program polled each 10 ms. */
void test_a_sleeping_program_wakes_only_for_bytes_and_what_is_due(void)
{
    while (next_way()) {
        start();
        (void)pauses(sleep_until_due, 100); /* The next byte would wake. */
        (void)pauses(port_program.wait, 3000);
        const unsigned often = pauses(port_program.wait, 2000);
        TEST_ASSERT_UINT_WITHIN(often / 20, often, pauses(sleep_until_due, 2000));
        machine_power(false);
        (void)pauses(sleep_until_due, 2000);
        TEST_ASSERT_LESS_OR_EQUAL_UINT(200, pauses(sleep_until_due, 20000));
        machine_power(true);
        (void)pauses(sleep_until_due, 12000);
        TEST_ASSERT_EQUAL_INT(TMINI_STATE_SCANNING, tmini_state(&lidar));
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_stop(&lidar));
        (void)pauses(sleep_until_due, 2000);
        TEST_ASSERT_LESS_OR_EQUAL_UINT(3, pauses(sleep_until_due, 60000));
    }
}

/* ------------------------------------------------------------------------------- at each moment */

static uint64_t came_us;

static void send_bytes(void)
{
    static const uint8_t noise[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    came_us = machine.now_us;
    machine_receive(0, noise, sizeof noise);
}

static uint32_t skipped(void)
{
    tmini_counters_t counters;
    tmini_counters(&lidar, &counters);
    return counters.bytes_skipped;
}

/* Bytes have ended a sleep, and the next one was short: only from now on may a byte be missed. */
static void sleep_after_bytes(void)
{
    log_t log = {.count = 0};
    start_port();
    (void)pauses(sleep_until_due, 100);
    send_bytes();
    port_sleep(20);
    poll_all(&log);
    came_us = 0;
}

/* Returns false if nothing has come, because the place is after two sleeps. */
static bool is_read_in_time(uint32_t place)
{
    log_t log = {.count = 0};
    sleep_after_bytes();
    const uint32_t before = skipped();
    irq_happen_after(place, send_bytes);
    for (unsigned i = 0; skipped() == before && i < (came_us > 0 ? 10 : 2); i++) {
        port_sleep(200);
        poll_all(&log);
    }
    if (came_us > 0) {
        TEST_ASSERT_EQUAL_UINT32(before + 8, skipped());
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(patience_us(), machine.now_us - came_us);
    }
    return came_us > 0;
}

/* Eight bytes, enough for an interrupt, come at each access to what interrupt and program share,
 * and to the kernel. */
void test_no_byte_is_slept_over(void)
{
    while (next_way()) {
        uint32_t place = 0;
        while (is_read_in_time(place)) {
            place++;
            begin_again();
        }
        TEST_ASSERT_GREATER_THAN_UINT32(10, place);
    }
}

void test_what_is_due_soon_does_not_wait_for_more_bytes(void)
{
    while (next_way()) {
        sleep_after_bytes();
        send_bytes();
        const uint64_t begun_us = machine.now_us;
        port_sleep(3);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(3000 + port_tick_us, machine.now_us - begun_us);
    }
}
