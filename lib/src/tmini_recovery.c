/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ladder that brings a lidar to scan, at the start and after a loss: set the wanted frequency,
 * then start, and every so often a soft reboot first; after each failure a pause, which doubles up
 * to a limit. */

#include "tmini_driver.h"

/* Every third attempt that fails is followed by one that reboots the lidar first. */
#define REBOOT_AFTER 3

/* In the place of a number of failed attempts: the first has not failed yet. */
#define FIRST_ATTEMPT (REBOOT_AFTER + 1)

/* In the place of an operation that has ended: none, or a pause. */
#define NO_OPERATION ((tmini_command_code_t)0)

/* An attempt has failed: a pause, and then the next. */
static void back_off(tmini_t *lidar)
{
    tmini_recovery_t *const recovery = &lidar->recovery;
    const uint32_t longer_ms =
        recovery->attempts == FIRST_ATTEMPT ? TMINI_BACK_OFF_MS : (uint32_t)recovery->pause_ms * 2;
    const uint16_t max_ms = lidar->link.timing->back_off_max_ms;
    recovery->attempts = (uint16_t)(recovery->attempts < REBOOT_AFTER ? recovery->attempts + 1 : 1);
    recovery->pause_ms = (uint16_t)(longer_ms < max_ms ? longer_ms : max_ms);
    tmini_command_wait(lidar, recovery->pause_ms);
}

/* What comes after an operation that has ended. A reboot takes seconds, and a lidar that is only
 * unplugged does not hear it: first what is quick. Scanning matters more than the frequency: it
 * follows however the frequency's setting ended. */
static tmini_command_code_t next_operation(const tmini_t *lidar, tmini_command_code_t ended)
{
    if (ended == TMINI_COMMAND_GET_FREQUENCY) {
        return TMINI_COMMAND_START;
    }
    if (ended == NO_OPERATION && lidar->recovery.attempts == REBOOT_AFTER) {
        return TMINI_COMMAND_REBOOT;
    }
    return lidar->wanted_chz != 0 ? TMINI_COMMAND_GET_FREQUENCY : TMINI_COMMAND_START;
}

static void count(tmini_t *lidar, tmini_command_code_t operation)
{
    if (operation == TMINI_COMMAND_REBOOT) {
        lidar->recovery.reboots++;
    } else if (operation == TMINI_COMMAND_START && lidar->state == TMINI_STATE_RECOVERING) {
        lidar->recovery.restarts++;
    }
}

/* One attempt each: the ladder repeats them, not the command. Without the ladder the command
 * does. */
static void make_attempt(tmini_t *lidar, tmini_command_code_t ended, bool is_idle)
{
    const tmini_command_code_t operation = next_operation(lidar, ended);
    count(lidar, operation);
    tmini_command_begin(lidar, operation,
                        lidar->is_recovery_off ? lidar->link.timing->max_attempts : 1);
    if (is_idle) {
        (void)tmini_command_proceed(lidar);
    }
}

void tmini_recovery_start(tmini_t *lidar, bool is_idle)
{
    lidar->recovery.attempts = FIRST_ATTEMPT;
    make_attempt(lidar, NO_OPERATION, is_idle);
}

void tmini_recovery_begin(tmini_t *lidar)
{
    lidar->recovery.losses++;
    if (lidar->is_recovery_off || lidar->is_listen_only) {
        tmini_command_wait(lidar, 0);
    } else if (lidar->recovery.attempts == 0) {
        tmini_recovery_start(lidar, false);
    } else {
        back_off(lidar); /* Lost again before it made a complete revolution. */
    }
}

/* A start goes on until a packet comes; what ends well is a pause, a reboot, or a frequency that
 * has been set: then the line is quiet. */
void tmini_recovery_go_on(tmini_t *lidar, tmini_command_code_t operation, int result, bool is_idle)
{
    if (result == TMINI_OK || operation == TMINI_COMMAND_GET_FREQUENCY) {
        make_attempt(lidar, operation, is_idle);
    } else {
        back_off(lidar);
    }
}
