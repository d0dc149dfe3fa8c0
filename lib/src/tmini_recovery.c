/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What to try next. The wishes are a set: to stop, questions, to scan. One function chooses the
 * next operation from what is wanted and what is known. To scan, a ladder of attempts is made, at
 * the start and after a loss: an attempt asks until the lidar answers, sets the wanted frequency,
 * and starts. After a failure comes a pause, which doubles up to a limit. A lidar that answers and
 * does not scan is rebooted before the fourth attempt and each later one. */

#include "tmini_driver.h"

/* Failed attempts after which the next one reboots the lidar first. */
#define REBOOT_AFTER 3

/* Value of `attempts` while the first attempt has not failed yet. */
#define FIRST_ATTEMPT (REBOOT_AFTER + 1)

#define BIT(event) (1u << (event))

/* The next attempt to scan is the first one of the ladder. */
static void reset(tmini_t *lidar)
{
    lidar->recovery.attempts = FIRST_ATTEMPT;
    lidar->recovery.pause_ms = TMINI_BACK_OFF_MS / 2; /* It doubles before it is used. */
}

void tmini_recovery_wish(tmini_t *lidar, tmini_event_t event)
{
    lidar->recovery.wishes = (uint8_t)(lidar->recovery.wishes | BIT(event));
    lidar->recovery.is_lost = false; /* A lost lidar gets no question. */
    reset(lidar);
}

/* ----------------------------------------------------------------------------------- the ladder */

TMINI_NOINLINE void tmini_recovery_restart_reception(const tmini_t *lidar)
{
    const tmini_port_t *const port = lidar->link.port;
    if (port->restart != NULL) {
        port->restart(lidar->link.port_context);
    }
}

void tmini_recovery_back_off(tmini_t *lidar, int result)
{
    tmini_recovery_t *const recovery = &lidar->recovery;
    const uint16_t max_ms = lidar->link.timing->back_off_max_ms;
    const uint32_t doubled_ms = 2u * (uint32_t)recovery->pause_ms;
    if (recovery->wishes != BIT(TMINI_EVENT_STARTED) ||
        (result == TMINI_ERROR_TIMEOUT && tmini_recovery_is_mute(lidar) && max_ms > 0)) {
        tmini_recovery_go_on(lidar, TMINI_EVENT_NONE);
        return;
    }
    if (result != TMINI_ERROR_WRITE) { /* Otherwise the lidar has heard nothing. */
        if (recovery->attempts >= REBOOT_AFTER) {
            recovery->attempts = 0;
        }
        recovery->attempts++;
    }
    recovery->pause_ms = (uint16_t)(doubled_ms < max_ms ? doubled_ms : max_ms);
    tmini_command_wait(lidar, lidar->is_listen_only ? TMINI_PHASE_LISTENING : TMINI_PHASE_PAUSING,
                       recovery->pause_ms);
}

/* Asking comes before each start: a lidar that boots does not receive a start. The start follows
 * even if it has not answered, or its frequency could not be set, because scanning matters more. A
 * lidar that does not answer is not rebooted: it would not receive that either. */
static tmini_event_t next_attempt(const tmini_t *lidar, tmini_event_t ended)
{
    if (ended != TMINI_EVENT_FREQUENCY) {
        return TMINI_EVENT_FREQUENCY;
    }
    return lidar->recovery.attempts == REBOOT_AFTER && !tmini_recovery_is_mute(lidar)
               ? TMINI_EVENT_REBOOTED
               : TMINI_EVENT_STARTED;
}

/* ------------------------------------------------------------------------------- the next step */

tmini_event_t tmini_recovery_first(unsigned events)
{
    unsigned event = TMINI_EVENT_NONE;
    for (; events != 0 && (events & 1u) == 0; events >>= 1) {
        event++;
    }
    return (tmini_event_t)event;
}

/* The wishes that have an operation of their own. The others are fulfilled by the ladder, which
 * also asks for the frequency. */
static unsigned wishes_beside_ladder(const tmini_t *lidar)
{
    const unsigned by_ladder = BIT(TMINI_EVENT_STARTED) | BIT(TMINI_EVENT_FREQUENCY);
    const unsigned wishes = lidar->recovery.wishes;
    return tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED) ? wishes & ~by_ladder : wishes;
}

bool tmini_recovery_is_step(const tmini_t *lidar, tmini_event_t operation)
{
    return (wishes_beside_ladder(lidar) & BIT(operation)) == 0;
}

static void note_step(tmini_t *lidar, tmini_event_t operation)
{
    tmini_recovery_t *const recovery = &lidar->recovery;
    if (operation == TMINI_EVENT_REBOOTED) {
        recovery->reboots++;
        recovery->attempts = REBOOT_AFTER - 1; /* It may have been lost: after the next failure,
                                                * another. */
    } else if (operation == TMINI_EVENT_STARTED && recovery->is_lost) {
        recovery->restarts++;
    }
}

/* To stop comes first, then the questions, then the ladder. */
void tmini_recovery_go_on(tmini_t *lidar, tmini_event_t ended)
{
    tmini_event_t operation = tmini_recovery_first(wishes_beside_ladder(lidar));
    uint8_t attempts = lidar->link.timing->max_attempts;
    if (operation == TMINI_EVENT_NONE) {
        if (!tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED)) {
            return;
        }
        if (lidar->is_listen_only) {
            tmini_command_wait(lidar, TMINI_PHASE_LISTENING, TMINI_SPIN_UP_TIMEOUT_MS);
            return;
        }
        operation = next_attempt(lidar, ended);
        note_step(lidar, operation);
        if (!lidar->is_recovery_off) {
            attempts = 1; /* The ladder repeats it. */
        }
    }
    tmini_command_begin(lidar, operation, attempts);
}

void tmini_recovery_restart(tmini_t *lidar)
{
    reset(lidar);
    tmini_recovery_go_on(lidar, TMINI_EVENT_NONE);
}

void tmini_recovery_begin(tmini_t *lidar)
{
    tmini_recovery_t *const recovery = &lidar->recovery;
    recovery->losses++;
    recovery->is_lost = true;
    tmini_recovery_restart_reception(lidar);
    if (lidar->is_recovery_off) {
        tmini_command_wait(lidar, TMINI_PHASE_LISTENING, 0);
    } else if (recovery->attempts > 0) { /* Lost again before it made a complete revolution. */
        tmini_recovery_back_off(lidar, TMINI_OK);
    } else {
        tmini_recovery_restart(lidar);
    }
}
