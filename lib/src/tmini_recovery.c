/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ladder that brings back a lidar that was lost while scanning: stop and start again, and every
 * so often a soft reboot first; after each failure a pause, which doubles up to a limit. */

#include "tmini_driver.h"

/* Every third attempt that fails is followed by one that reboots the lidar first. */
#define REBOOT_AFTER 3

/* In the place of a number of failed attempts: the first has not failed yet. */
#define FIRST_ATTEMPT (REBOOT_AFTER + 1)

/* An attempt has failed: a pause, and then the next. */
static void back_off(tmini_t *lidar)
{
    const tmini_timing_t *const timing = lidar->link.timing;
    tmini_recovery_t *const recovery = &lidar->recovery;
    const uint32_t longer_ms = recovery->attempts == FIRST_ATTEMPT
                                   ? timing->back_off_ms
                                   : (uint32_t)recovery->pause_ms * 2;
    const uint16_t max_ms = timing->back_off_max_ms;
    recovery->attempts = (uint16_t)(recovery->attempts < REBOOT_AFTER ? recovery->attempts + 1 : 1);
    recovery->pause_ms = (uint16_t)(longer_ms < max_ms ? longer_ms : max_ms);
    tmini_command_wait(lidar, recovery->pause_ms);
}

/* One attempt each: the ladder repeats them, not the command. A reboot takes seconds, and a lidar
 * that is only unplugged does not hear it: first what is quick. When it is over, start. */
static void make_attempt(tmini_t *lidar)
{
    tmini_recovery_t *const recovery = &lidar->recovery;
    const bool has_rebooted = lidar->command.operation == TMINI_COMMAND_REBOOT;
    tmini_command_code_t operation = TMINI_COMMAND_START;
    if (recovery->attempts == REBOOT_AFTER && !has_rebooted) {
        operation = TMINI_COMMAND_REBOOT;
        recovery->reboots++;
    } else {
        recovery->restarts++;
    }
    tmini_command_begin(lidar, operation, 1, 0);
}

void tmini_recovery_begin(tmini_t *lidar)
{
    lidar->recovery.losses++;
    if (lidar->is_recovery_off) {
        tmini_command_wait(lidar, 0);
    } else if (lidar->recovery.attempts == 0) {
        lidar->recovery.attempts = FIRST_ATTEMPT;
        make_attempt(lidar);
    } else {
        back_off(lidar); /* Lost again before it made a complete revolution. */
    }
}

/* A start goes on until a packet comes; it is a reboot that ends well, or a pause. */
void tmini_recovery_go_on(tmini_t *lidar, int result)
{
    if (result == TMINI_OK) {
        make_attempt(lidar);
    } else {
        back_off(lidar);
    }
}
