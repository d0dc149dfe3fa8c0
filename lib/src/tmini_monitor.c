/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* While the lidar scans: is it well? Packets in, faults out: what revolutions show, once two have
 * shown it; a rotor that stands still, by time. */

#include "tmini_driver.h"

/* What one revolution shows is believed when the next one shows it too. */
static void observe(tmini_monitor_t *monitor, uint8_t faults)
{
    if (faults == monitor->observed) {
        monitor->faults = faults;
    }
    monitor->observed = faults;
}

/* A start packet: the revolution that it ends is judged by what the unit itself says of its health
 * (section 7). If it says nothing, by whether there was any range; of a revolution that was not
 * received completely, the rest may have had one. */
static void judge_revolution(tmini_t *lidar, tmini_ct_verdict_t verdict)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    unsigned faults = tmini_ct_faults(&lidar->ct);
    bool is_known = verdict == TMINI_CT_CONFIRMED;
    if (faults == TMINI_FAULTS_UNKNOWN) {
        faults = monitor->has_range ? 0 : TMINI_FAULT_DATA;
        is_known = monitor->has_range || monitor->is_complete;
    }
    if (is_known) {
        observe(monitor, (uint8_t)faults);
    }
}

void tmini_monitor_begin(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    tmini_ct_discard(&lidar->ct);
    monitor->is_complete = false;
    monitor->has_range = false;
    monitor->observed = monitor->faults;
    monitor->rotating_ms = lidar->link.now_ms;
}

bool tmini_monitor_packet(tmini_t *lidar, tmini_ct_verdict_t verdict)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    const tmini_packet_t *const packet = &lidar->latest.packet;
    const bool is_start = tmini_packet_is_start(packet);
    const bool has_range = tmini_packet_has_range(packet);
    bool is_whole = false;
    if (packet->gap > 1) { /* One byte may be LastCRC; with more, a packet may be lost. */
        monitor->is_complete = false;
    }
    if (is_start) {
        judge_revolution(lidar, verdict);
        is_whole = monitor->is_complete;
        monitor->is_complete = true;
        monitor->has_range = false;
    }
    if (has_range) {
        monitor->has_range = true;
    }
    if (is_start || has_range) {
        monitor->rotating_ms = lidar->link.now_ms;
    }
    return is_whole;
}

void tmini_monitor_poll(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    /* No start packet and no range for so long: the rotor is blocked (section 8). */
    const uint16_t timeout_ms = lidar->link.timing->rotation_timeout_ms;
    if (timeout_ms > 0 && tmini_has_elapsed(lidar, monitor->rotating_ms, timeout_ms)) {
        monitor->faults |= TMINI_FAULT_ENCODER;
        monitor->observed = monitor->faults;
    }
}
