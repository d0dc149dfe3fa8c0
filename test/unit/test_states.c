/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The table of docs/design.md, "States and commands": what each command does in each state. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "unity.h"

#define NOTHING 0

typedef struct {
    const char *name;
    tmini_status_t (*command)(tmini_t *lidar);
    tmini_status_t status;
    uint8_t sent; /* At once; or NOTHING. */
    tmini_state_t after;
    tmini_event_t event; /* At the next poll. */
} cell_t;

void setUp(void)
{
    rig_open();
}

void tearDown(void)
{
    TEST_ASSERT_TRUE(lidar_is_sound(&rig.lidar));
}

static tmini_status_t set_frequency(tmini_t *lidar)
{
    return tmini_set_frequency(lidar, 700);
}

static void check(const cell_t *cell)
{
    if (cell->sent != NOTHING) {
        sends(cell->sent);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(cell->status, cell->command(&rig.lidar), cell->name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(cell->after, tmini_state(&rig.lidar), cell->name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(cell->event, tmini_poll(&rig.lidar), cell->name);
    was_sent();
}

static void do_nothing(void) {}

static void go_busy(void)
{
    rig_go_idle();
    sends(GET_INFO);
    begins(tmini_request_info(&rig.lidar));
}

static void go_stopping(void)
{
    rig_go_idle();
    sends(STOP);
    begins(tmini_stop(&rig.lidar));
}

/* Each cell on a lidar of its own. */
static void check_all(void (*go)(void), tmini_state_t state, const cell_t *cells)
{
    for (unsigned i = 0; i < 7; i++) {
        rig_init();
        go();
        TEST_ASSERT_EQUAL_INT(state, tmini_state(&rig.lidar));
        check(&cells[i]);
    }
}

void test_in_the_unknown_state_every_command_first_sends_a_stop(void)
{
    static const cell_t cells[7] = {
        {"unknown x start", tmini_start, TMINI_OK, STOP, TMINI_STATE_STARTING, TMINI_EVENT_NONE},
        {"unknown x stop", tmini_stop, TMINI_OK, STOP, TMINI_STATE_STOPPING, TMINI_EVENT_NONE},
        {"unknown x info", tmini_request_info, TMINI_OK, STOP, TMINI_STATE_BUSY, TMINI_EVENT_NONE},
        {"unknown x health", tmini_request_health, TMINI_OK, STOP, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"unknown x frequency", tmini_request_frequency, TMINI_OK, STOP, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"unknown x set frequency", set_frequency, TMINI_OK, STOP, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"unknown x reboot", tmini_reboot, TMINI_OK, STOP, TMINI_STATE_BUSY, TMINI_EVENT_NONE},
    };

    check_all(do_nothing, TMINI_STATE_UNKNOWN, cells);
}

void test_in_the_idle_state_every_command_is_sent_at_once(void)
{
    static const cell_t cells[7] = {
        {"idle x start", tmini_start, TMINI_OK, START, TMINI_STATE_STARTING, TMINI_EVENT_NONE},
        {"idle x stop", tmini_stop, TMINI_OK, STOP, TMINI_STATE_STOPPING, TMINI_EVENT_NONE},
        {"idle x info", tmini_request_info, TMINI_OK, GET_INFO, TMINI_STATE_BUSY, TMINI_EVENT_NONE},
        {"idle x health", tmini_request_health, TMINI_OK, GET_HEALTH, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"idle x frequency", tmini_request_frequency, TMINI_OK, GET_FREQUENCY, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"idle x set frequency", set_frequency, TMINI_OK, GET_FREQUENCY, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"idle x reboot", tmini_reboot, TMINI_OK, REBOOT, TMINI_STATE_BUSY, TMINI_EVENT_NONE},
    };

    check_all(rig_go_idle, TMINI_STATE_IDLE, cells);
}

void test_in_the_busy_state_queries_are_refused_and_wishes_kept(void)
{
    static const cell_t cells[7] = {
        {"busy x start", tmini_start, TMINI_OK, NOTHING, TMINI_STATE_BUSY, TMINI_EVENT_NONE},
        {"busy x stop", tmini_stop, TMINI_OK, STOP, TMINI_STATE_STOPPING,
         TMINI_EVENT_COMMAND_FAILED},
        {"busy x info", tmini_request_info, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"busy x health", tmini_request_health, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"busy x frequency", tmini_request_frequency, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"busy x set frequency", set_frequency, TMINI_OK, NOTHING, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
        {"busy x reboot", tmini_reboot, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_BUSY,
         TMINI_EVENT_NONE},
    };

    check_all(go_busy, TMINI_STATE_BUSY, cells);
}

void test_in_the_stopping_state_queries_are_refused_and_wishes_kept(void)
{
    static const cell_t cells[7] = {
        {"stopping x start", tmini_start, TMINI_OK, NOTHING, TMINI_STATE_STOPPING,
         TMINI_EVENT_NONE},
        {"stopping x stop", tmini_stop, TMINI_OK, NOTHING, TMINI_STATE_STOPPING, TMINI_EVENT_NONE},
        {"stopping x info", tmini_request_info, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_STOPPING,
         TMINI_EVENT_NONE},
        {"stopping x health", tmini_request_health, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_STOPPING,
         TMINI_EVENT_NONE},
        {"stopping x frequency", tmini_request_frequency, TMINI_ERROR_BUSY, NOTHING,
         TMINI_STATE_STOPPING, TMINI_EVENT_NONE},
        {"stopping x set frequency", set_frequency, TMINI_OK, NOTHING, TMINI_STATE_STOPPING,
         TMINI_EVENT_NONE},
        {"stopping x reboot", tmini_reboot, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_STOPPING,
         TMINI_EVENT_NONE},
    };

    check_all(go_stopping, TMINI_STATE_STOPPING, cells);
}

void test_in_the_starting_state_queries_are_refused_and_a_new_frequency_starts_anew(void)
{
    static const cell_t cells[7] = {
        {"starting x start", tmini_start, TMINI_OK, NOTHING, TMINI_STATE_STARTING,
         TMINI_EVENT_NONE},
        {"starting x stop", tmini_stop, TMINI_OK, STOP, TMINI_STATE_STOPPING,
         TMINI_EVENT_COMMAND_FAILED},
        {"starting x info", tmini_request_info, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_STARTING,
         TMINI_EVENT_NONE},
        {"starting x health", tmini_request_health, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_STARTING,
         TMINI_EVENT_NONE},
        {"starting x frequency", tmini_request_frequency, TMINI_ERROR_BUSY, NOTHING,
         TMINI_STATE_STARTING, TMINI_EVENT_NONE},
        {"starting x set frequency", set_frequency, TMINI_OK, STOP, TMINI_STATE_STARTING,
         TMINI_EVENT_NONE},
        {"starting x reboot", tmini_reboot, TMINI_ERROR_BUSY, NOTHING, TMINI_STATE_STARTING,
         TMINI_EVENT_NONE},
    };

    check_all(rig_go_starting, TMINI_STATE_STARTING, cells);
}

void test_in_the_scanning_state_queries_are_refused_and_a_new_frequency_starts_anew(void)
{
    static const cell_t cells[7] = {
        {"scanning x start", tmini_start, TMINI_OK, NOTHING, TMINI_STATE_SCANNING,
         TMINI_EVENT_NONE},
        {"scanning x stop", tmini_stop, TMINI_OK, STOP, TMINI_STATE_STOPPING, TMINI_EVENT_NONE},
        {"scanning x info", tmini_request_info, TMINI_ERROR_STATE, NOTHING, TMINI_STATE_SCANNING,
         TMINI_EVENT_NONE},
        {"scanning x health", tmini_request_health, TMINI_ERROR_STATE, NOTHING,
         TMINI_STATE_SCANNING, TMINI_EVENT_NONE},
        {"scanning x frequency", tmini_request_frequency, TMINI_ERROR_STATE, NOTHING,
         TMINI_STATE_SCANNING, TMINI_EVENT_NONE},
        {"scanning x set frequency", set_frequency, TMINI_OK, STOP, TMINI_STATE_STARTING,
         TMINI_EVENT_NONE},
        {"scanning x reboot", tmini_reboot, TMINI_ERROR_STATE, NOTHING, TMINI_STATE_SCANNING,
         TMINI_EVENT_NONE},
    };

    check_all(rig_go_scanning, TMINI_STATE_SCANNING, cells);
}

void test_in_the_recovering_state_queries_are_refused_and_a_new_frequency_tries_anew(void)
{
    static const cell_t cells[7] = {
        {"recovering x start", tmini_start, TMINI_OK, NOTHING, TMINI_STATE_RECOVERING,
         TMINI_EVENT_NONE},
        {"recovering x stop", tmini_stop, TMINI_OK, STOP, TMINI_STATE_STOPPING, TMINI_EVENT_NONE},
        {"recovering x info", tmini_request_info, TMINI_ERROR_STATE, NOTHING,
         TMINI_STATE_RECOVERING, TMINI_EVENT_NONE},
        {"recovering x health", tmini_request_health, TMINI_ERROR_STATE, NOTHING,
         TMINI_STATE_RECOVERING, TMINI_EVENT_NONE},
        {"recovering x frequency", tmini_request_frequency, TMINI_ERROR_STATE, NOTHING,
         TMINI_STATE_RECOVERING, TMINI_EVENT_NONE},
        {"recovering x set frequency", set_frequency, TMINI_OK, STOP, TMINI_STATE_RECOVERING,
         TMINI_EVENT_NONE},
        {"recovering x reboot", tmini_reboot, TMINI_ERROR_STATE, NOTHING, TMINI_STATE_RECOVERING,
         TMINI_EVENT_NONE},
    };

    check_all(rig_go_recovering, TMINI_STATE_RECOVERING, cells);
}
