/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ladder of attempts that makes a lidar scan, at the start and after a loss. An attempt sets
 * the wanted frequency, then starts. After a failure comes a pause, which doubles up to a limit;
 * after every third failure a soft reboot. */

#include "tmini_driver.h"

/* After every third failed attempt, the next one reboots the lidar first. */
#define REBOOT_AFTER 3

/* Value of `attempts` while the first attempt has not failed yet. */
#define FIRST_ATTEMPT (REBOOT_AFTER + 1)

/* No operation has ended, or it was a pause. */
#define NO_OPERATION TMINI_EVENT_NONE

TMINI_NOINLINE void tmini_recovery_restart_reception(const tmini_t *lidar)
{
    const tmini_port_t *const port = lidar->link.port;
    if (port->restart != NULL) {
        port->restart(lidar->link.port_context);
    }
}

void tmini_recovery_back_off(tmini_t *lidar)
{
    tmini_recovery_t *const recovery = &lidar->recovery;
    const uint16_t max_ms = lidar->link.timing->back_off_max_ms;
    const uint32_t doubled_ms = 2u * (uint32_t)recovery->pause_ms;
    recovery->attempts = (uint8_t)(recovery->attempts < REBOOT_AFTER ? recovery->attempts + 1 : 1);
    recovery->pause_ms = (uint16_t)(doubled_ms < max_ms ? doubled_ms : max_ms);
    tmini_command_wait(lidar, recovery->pause_ms);
}

/* Chooses the operation that follows the one that has ended. A reboot is not tried at once, because
 * it takes seconds and an unplugged lidar does not receive it. The start follows even if the
 * frequency could not be set, because scanning matters more. */
static tmini_event_t next_operation(const tmini_t *lidar, tmini_event_t ended)
{
    if (ended == TMINI_EVENT_FREQUENCY) {
        return TMINI_EVENT_STARTED;
    }
    if (ended == NO_OPERATION && lidar->recovery.attempts == REBOOT_AFTER) {
        return TMINI_EVENT_REBOOTED;
    }
    return lidar->command.wanted_chz != 0 ? TMINI_EVENT_FREQUENCY : TMINI_EVENT_STARTED;
}

static void count(tmini_t *lidar, tmini_event_t operation)
{
    if (operation == TMINI_EVENT_REBOOTED) {
        lidar->recovery.reboots++;
    } else if (operation == TMINI_EVENT_STARTED && lidar->state == TMINI_STATE_RECOVERING) {
        lidar->recovery.restarts++;
    }
}

void tmini_recovery_go_on(tmini_t *lidar, tmini_event_t ended, bool is_idle)
{
    const tmini_event_t operation = next_operation(lidar, ended);
    count(lidar, operation);
    tmini_command_begin(lidar, operation, is_idle);
}

/* With listen_only nothing is sent; the driver waits for packets. */
void tmini_recovery_start(tmini_t *lidar, bool is_idle)
{
    lidar->recovery.attempts = FIRST_ATTEMPT;
    lidar->recovery.pause_ms = TMINI_BACK_OFF_MS / 2; /* It doubles before it is used. */
    if (lidar->is_listen_only) {
        tmini_command_wait(lidar, TMINI_SPIN_UP_TIMEOUT_MS);
    } else {
        tmini_recovery_go_on(lidar, NO_OPERATION, is_idle);
    }
}

void tmini_recovery_begin(tmini_t *lidar)
{
    lidar->recovery.losses++;
    tmini_recovery_restart_reception(lidar);
    if (lidar->recovery.attempts > 0) {
        tmini_recovery_back_off(lidar); /* Lost again before it made a complete revolution. */
    } else if (lidar->is_recovery_off) {
        tmini_command_wait(lidar, 0);
    } else {
        tmini_recovery_start(lidar, false);
    }
}
