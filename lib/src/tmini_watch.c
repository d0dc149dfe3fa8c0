/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* While the lidar scans: is it still there, and is it well? And the ladder that brings it back. */

#include "tmini_driver.h"

/* Every third attempt to recover reboots the lidar first. */
#define REBOOT_RUNG 3

/* ---------------------------------------------------------------------------------- faults */

static void report(tmini_t *lidar, uint8_t faults)
{
    lidar->observed = faults;
    if (faults != lidar->faults) {
        lidar->faults = faults;
        driver_raise(lidar, TMINI_EVENT_FAULT);
    }
}

/* What one revolution shows is believed when the next one shows it too. */
static void observe(tmini_t *lidar, uint8_t faults)
{
    if (faults == lidar->observed) {
        report(lidar, faults);
    }
    lidar->observed = faults;
}

/* A start packet: judge the revolution that it ends, by CT information if the unit sends that, else
 * by whether it had any range. If it was not received whole, the rest may have had one. */
static void judge_revolution(tmini_t *lidar, bool trusted)
{
    unsigned faults = tmini_turn_faults(&lidar->turn);
    bool judged = trusted;
    if (faults == TMINI_FAULTS_UNKNOWN) {
        faults = lidar->range_seen ? 0 : TMINI_FAULT_DATA;
        judged = lidar->whole || lidar->range_seen;
    }
    if (judged) {
        observe(lidar, (uint8_t)faults);
    }
    if (lidar->whole) {
        lidar->rung = 0; /* It has truly recovered, if it was lost. */
    }
    lidar->whole = true;
    lidar->range_seen = false;
}

/* ------------------------------------------------------------------------------- scan packets */

/* The first packet after a start, or after a loss: nothing continues what was before. */
static void resume(tmini_t *lidar)
{
    tmini_parser_await(&lidar->parser, NULL);
    lidar->unsent = 0; /* A start that is no longer needed must not be sent (section 2). */
    tmini_turn_discard(&lidar->turn);
    tmini_scan_discard(&lidar->builder);
    lidar->goal = GOAL_START;
    lidar->whole = false;
    lidar->range_seen = false;
    lidar->observed = lidar->faults;
    lidar->turning_ms = lidar->now_ms;
    driver_enter(lidar, PHASE_SCANNING, lidar->timing->data_ms);
    if (lidar->recovering) {
        lidar->recovering = false;
        lidar->recoveries++;
        driver_raise(lidar, TMINI_EVENT_RECOVERED);
    } else {
        driver_raise(lidar, TMINI_EVENT_STARTED);
    }
}

/* A packet means that the lidar scans: also when the reply to the start was lost, or when a lost
 * lidar comes back by itself. But not the tail behind a stop (section 9.10). */
static bool is_welcome(const tmini_t *lidar)
{
    if (lidar->goal == GOAL_START) {
        return lidar->phase != PHASE_HUSHING;
    }
    return lidar->recovering && lidar->phase == PHASE_BOOTING;
}

static void gather(tmini_t *lidar)
{
    const tmini_packet_t *const packet = &lidar->latest.packet;
    if (lidar->builder.capacity == 0) {
        driver_raise(lidar, TMINI_EVENT_PACKET);
    } else if (tmini_scan_close(&lidar->builder, packet)) {
        lidar->held = true;
        lidar->scans++;
        driver_raise(lidar, TMINI_EVENT_SCAN);
    } else {
        tmini_scan_add(&lidar->builder, packet, lidar->now_ms);
    }
}

void tmini_driver_packet(tmini_t *lidar)
{
    if (!is_welcome(lidar)) {
        return;
    }
    if (lidar->phase != PHASE_SCANNING) {
        resume(lidar);
    }
    tmini_packet_t *const packet = &lidar->latest.packet;
    tmini_packet_open(packet, &lidar->parser);
    lidar->phase_ms = lidar->now_ms;
    const bool trusted = tmini_turn_add(&lidar->turn, packet);
    if (packet->gap > 1) { /* One byte may be LastCRC; with more, a packet may be lost. */
        lidar->whole = false;
    }
    const bool has_range = tmini_packet_has_range(packet);
    if (tmini_packet_is_start(packet)) {
        judge_revolution(lidar, trusted);
        lidar->turning_ms = lidar->now_ms;
    }
    if (has_range) {
        lidar->range_seen = true;
        lidar->turning_ms = lidar->now_ms;
    }
    gather(lidar);
}

/* No start packet and no range for so long: the rotor is blocked (section 8). */
void tmini_driver_watch_rotor(tmini_t *lidar)
{
    if (driver_elapsed(lidar, lidar->turning_ms, lidar->timing->turn_ms)) {
        report(lidar, (uint8_t)(lidar->faults | TMINI_FAULT_ENCODER));
    }
}

/* ----------------------------------------------------------------------------------- recovery */

void tmini_driver_lose(tmini_t *lidar)
{
    lidar->losses++;
    lidar->recovering = true;
    driver_raise(lidar, TMINI_EVENT_LOST);
    if (lidar->no_recovery) {
        driver_enter(lidar, PHASE_BACKING_OFF, 0);
    } else if (lidar->rung == 0) {
        tmini_driver_climb(lidar);
    } else {
        tmini_driver_back_off(lidar); /* Lost again before it made a whole revolution. */
    }
}

void tmini_driver_climb(tmini_t *lidar)
{
    const bool reboots = lidar->rung > 0 && lidar->rung % REBOOT_RUNG == 0;
    lidar->goal = reboots ? GOAL_REBOOT : GOAL_START;
    tmini_driver_hush(lidar);
}

/* The pause doubles from rung to rung. */
static uint16_t pause_ms(const tmini_t *lidar)
{
    const tmini_timing_t *const timing = lidar->timing;
    const unsigned doublings = lidar->rung - 1u;
    const uint32_t pause = doublings < 16 ? (uint32_t)timing->back_off_ms << doublings : UINT32_MAX;
    return (uint16_t)(pause < timing->back_off_max_ms ? pause : timing->back_off_max_ms);
}

void tmini_driver_back_off(tmini_t *lidar)
{
    /* At the top, the last rungs are climbed again and again. */
    lidar->rung =
        (uint8_t)(lidar->rung < UINT8_MAX ? lidar->rung + 1 : UINT8_MAX - REBOOT_RUNG + 1);
    lidar->goal = GOAL_START;
    lidar->unsent = 0;
    tmini_parser_await(&lidar->parser, NULL);
    driver_enter(lidar, PHASE_BACKING_OFF, pause_ms(lidar));
}
