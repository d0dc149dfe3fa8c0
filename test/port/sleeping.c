/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a port must do that has a function in which the polling task sleeps, for each way of
 * receiving. */

#include "every_port.h"

#include "irq_lines.h"
#include "unity.h"

static void sleep_until_due(void)
{
    port_sleep(tmini_next_poll_ms(&lidar));
}

/* Bytes wait for 10 ms at most, and the kernel may be late. */
static uint32_t patience_us(void)
{
    return 10000 + 2 * port_tick_us;
}

/* ------------------------------------------------------------------------------------- wake-ups */

static unsigned pauses(void (*pause)(void), uint32_t ms)
{
    const uint64_t end_us = machine.now_us + 1000u * (uint64_t)ms;
    unsigned count = 0;
    while (machine.now_us < end_us) {
        poll_all();
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
    start_port();
    (void)pauses(sleep_until_due, 100);
    send_bytes();
    port_sleep(20);
    poll_all();
    came_us = 0;
}

/* Returns false if nothing has come, because the place is after two sleeps. */
static bool is_read_in_time(uint32_t place)
{
    sleep_after_bytes();
    const uint32_t before = skipped();
    irq_happen_after(place, send_bytes);
    for (unsigned i = 0; skipped() == before && i < (came_us > 0 ? 10 : 2); i++) {
        port_sleep(200);
        poll_all();
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
