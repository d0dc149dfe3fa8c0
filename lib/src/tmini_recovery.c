/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ladder that brings back a lidar that was lost while scanning: stop and start again, and every
 * so often a soft reboot first; after each failure a pause, which doubles up to a limit. */

#include "tmini_driver.h"

/* Every third attempt to recover reboots the lidar first. */
#define REBOOT_ATTEMPT 3

/* Until it is over, nothing is tried; 0: for ever. */
static void begin_pause(tmini_t *lidar, uint16_t pause_ms)
{
    lidar->recovery.is_pausing = true;
    tmini_command_wait(lidar, pause_ms);
}

/* The pause after so many failed attempts: doubles with each. */
static uint16_t back_off_ms(const tmini_t *lidar)
{
    const tmini_timing_t *const timing = lidar->link.timing;
    const unsigned doublings = lidar->recovery.attempts - 1u;
    const uint32_t pause = doublings < 16 ? (uint32_t)timing->back_off_ms << doublings : UINT32_MAX;
    return (uint16_t)(pause < timing->back_off_max_ms ? pause : timing->back_off_max_ms);
}

/* An attempt has failed. After very many, the last ones are repeated again and again. */
static void back_off(tmini_t *lidar)
{
    const uint8_t attempts = lidar->recovery.attempts;
    lidar->recovery.attempts =
        (uint8_t)(attempts < UINT8_MAX ? attempts + 1 : UINT8_MAX - REBOOT_ATTEMPT + 1);
    begin_pause(lidar, back_off_ms(lidar));
}

/* One attempt each: the ladder repeats them, not the command. */
static void begin(tmini_t *lidar, tmini_operation_t operation)
{
    lidar->recovery.is_pausing = false;
    tmini_command_begin(lidar, operation, 1, 0);
}

static void restart(tmini_t *lidar)
{
    lidar->recovery.restarts++;
    begin(lidar, TMINI_OPERATION_START);
}

static void reboot(tmini_t *lidar)
{
    lidar->recovery.reboots++;
    begin(lidar, TMINI_OPERATION_REBOOT);
}

/* A reboot takes seconds, and a lidar that is only unplugged does not hear it: first what is
 * quick. */
static void make_attempt(tmini_t *lidar)
{
    const uint8_t failed = lidar->recovery.attempts;
    if (failed > 0 && failed % REBOOT_ATTEMPT == 0) {
        reboot(lidar);
    } else {
        restart(lidar);
    }
}

/* A start goes on until a packet comes; it is a reboot that ends well, or a pause. */
static void take_result(tmini_t *lidar, int result)
{
    if (result < 0) {
        back_off(lidar);
    } else if (result == TMINI_OK && lidar->recovery.is_pausing) {
        make_attempt(lidar);
    } else if (result == TMINI_OK) {
        restart(lidar);
    }
}

void tmini_recovery_begin(tmini_t *lidar)
{
    lidar->recovery.losses++;
    if (lidar->disable_recovery) {
        begin_pause(lidar, 0);
    } else if (lidar->recovery.attempts == 0) {
        make_attempt(lidar);
    } else {
        back_off(lidar); /* Lost again before it made a complete revolution. */
    }
}

void tmini_recovery_poll(tmini_t *lidar)
{
    take_result(lidar, tmini_command_poll(lidar));
}

void tmini_recovery_reply(tmini_t *lidar, const uint8_t *content)
{
    take_result(lidar, tmini_command_reply(lidar, content));
}

bool tmini_recovery_packet(tmini_t *lidar)
{
    const bool is_back = tmini_command_packet(lidar);
    if (is_back) {
        lidar->recovery.recoveries++;
    }
    return is_back;
}

void tmini_recovery_forget(tmini_t *lidar)
{
    lidar->recovery.attempts = 0;
}
