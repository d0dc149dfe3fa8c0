/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The table "States and commands" of docs/design.md: the effect of each command in each state. */

#include "invariants.h"
#include "rig.h"

#include "mock_port_functions.h"
#include "unity.h"

#define NOTHING 0

/* The status that a command returns, the command that it sends at once, and the state after it.
 * `aborts`: the next poll reports that the previous command has failed. */
typedef struct {
    tmini_status_t status;
    uint8_t sent;
    tmini_state_t after;
    bool aborts;
} cell_t;

/* clang-format off */
#define OK(code, state) {TMINI_OK, code, TMINI_STATE_##state, false}
#define ABORTS(code, state) {TMINI_OK, code, TMINI_STATE_##state, true}
#define REFUSED(why, state) {TMINI_ERROR_##why, NOTHING, TMINI_STATE_##state, false}
/* clang-format on */

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

static const struct {
    const char *name;
    tmini_status_t (*call)(tmini_t *lidar);
} commands[7] = {
    {"start", tmini_start},
    {"stop", tmini_stop},
    {"info", tmini_request_info},
    {"health", tmini_request_health},
    {"frequency", tmini_request_frequency},
    {"set frequency", set_frequency},
    {"reboot", tmini_reboot},
};

static void do_nothing(void) {}

static void go_busy(void)
{
    is_idle_and_asked(GET_INFO, tmini_request_info(&rig.lidar));
}

static void go_stopping(void)
{
    rig_go_idle();
    begins_with(STOP, tmini_stop(&rig.lidar));
}

/* Checks each command in turn, each with a lidar that was set up again. */
static void check(void (*go)(void), tmini_state_t state, const cell_t cells[7])
{
    for (unsigned i = 0; i < 7; i++) {
        const tmini_event_t event = cells[i].aborts ? TMINI_EVENT_COMMAND_FAILED : TMINI_EVENT_NONE;
        const char *const name = commands[i].name;
        rig_init();
        go();
        TEST_ASSERT_EQUAL_INT(state, tmini_state(&rig.lidar));
        if (cells[i].sent != NOTHING) {
            sends(cells[i].sent);
        }
        TEST_ASSERT_EQUAL_INT_MESSAGE(cells[i].status, commands[i].call(&rig.lidar), name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(cells[i].after, tmini_state(&rig.lidar), name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(event, tmini_poll(&rig.lidar), name);
        was_sent();
    }
}

void test_in_the_unknown_state_every_command_first_sends_a_stop(void)
{
    static const cell_t cells[7] = {OK(STOP, STARTING), OK(STOP, STOPPING), OK(STOP, BUSY),
                                    OK(STOP, BUSY),     OK(STOP, BUSY),     OK(STOP, BUSY),
                                    OK(STOP, BUSY)};
    check(do_nothing, TMINI_STATE_UNKNOWN, cells);
}

void test_in_the_idle_state_every_command_is_sent_at_once(void)
{
    static const cell_t cells[7] = {
        OK(START, STARTING),     OK(STOP, STOPPING),      OK(GET_INFO, BUSY), OK(GET_HEALTH, BUSY),
        OK(GET_FREQUENCY, BUSY), OK(GET_FREQUENCY, BUSY), OK(REBOOT, BUSY)};
    check(rig_go_idle, TMINI_STATE_IDLE, cells);
}

void test_in_the_busy_state_queries_are_refused_and_wishes_kept(void)
{
    static const cell_t cells[7] = {
        OK(NOTHING, BUSY),   ABORTS(STOP, STOPPING), REFUSED(BUSY, BUSY), REFUSED(BUSY, BUSY),
        REFUSED(BUSY, BUSY), OK(NOTHING, BUSY),      REFUSED(BUSY, BUSY)};
    check(go_busy, TMINI_STATE_BUSY, cells);
}

void test_in_the_stopping_state_queries_are_refused_and_wishes_kept(void)
{
    static const cell_t cells[7] = {OK(NOTHING, STOPPING),   OK(NOTHING, STOPPING),
                                    REFUSED(BUSY, STOPPING), REFUSED(BUSY, STOPPING),
                                    REFUSED(BUSY, STOPPING), OK(NOTHING, STOPPING),
                                    REFUSED(BUSY, STOPPING)};
    check(go_stopping, TMINI_STATE_STOPPING, cells);
}

void test_in_the_starting_state_queries_are_refused_and_a_new_frequency_starts_again(void)
{
    static const cell_t cells[7] = {OK(NOTHING, STARTING),   ABORTS(STOP, STOPPING),
                                    REFUSED(BUSY, STARTING), REFUSED(BUSY, STARTING),
                                    REFUSED(BUSY, STARTING), OK(STOP, STARTING),
                                    REFUSED(BUSY, STARTING)};
    check(rig_go_starting, TMINI_STATE_STARTING, cells);
}

void test_in_the_scanning_state_queries_are_refused_and_a_new_frequency_starts_again(void)
{
    static const cell_t cells[7] = {OK(NOTHING, SCANNING),    OK(STOP, STOPPING),
                                    REFUSED(STATE, SCANNING), REFUSED(STATE, SCANNING),
                                    REFUSED(STATE, SCANNING), OK(STOP, STARTING),
                                    REFUSED(STATE, SCANNING)};
    check(rig_go_scanning, TMINI_STATE_SCANNING, cells);
}

void test_in_the_recovering_state_queries_are_refused_and_a_new_frequency_tries_again(void)
{
    static const cell_t cells[7] = {OK(NOTHING, RECOVERING),    OK(STOP, STOPPING),
                                    REFUSED(STATE, RECOVERING), REFUSED(STATE, RECOVERING),
                                    REFUSED(STATE, RECOVERING), OK(STOP, RECOVERING),
                                    REFUSED(STATE, RECOVERING)};
    check(rig_go_recovering, TMINI_STATE_RECOVERING, cells);
}
