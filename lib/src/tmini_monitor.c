/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* While the lidar scans: is it well? Packets in, faults out, each seen in two revolutions. */

#include "tmini_driver.h"

/* Returns true if that is news. */
static bool report(tmini_monitor_t *monitor, uint8_t faults)
{
    const bool has_changed = faults != monitor->faults;
    monitor->observed = faults;
    monitor->faults = faults;
    return has_changed;
}

/* What one revolution shows is believed when the next one shows it too. */
static bool observe(tmini_monitor_t *monitor, uint8_t faults)
{
    const bool is_seen_twice = faults == monitor->observed;
    monitor->observed = faults;
    return is_seen_twice && report(monitor, faults);
}

/* A start packet: the revolution that it ends is judged by what the unit itself says of its health
 * (section 7). If it says nothing, by whether there was any range; of a revolution that was not
 * received completely, the rest may have had one. */
static bool judge_revolution(tmini_t *lidar, tmini_ct_verdict_t verdict)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    unsigned faults = tmini_ct_faults(&lidar->ct);
    bool is_known = verdict == TMINI_CT_CONFIRMED;
    if (faults == TMINI_FAULTS_UNKNOWN) {
        faults = monitor->has_range ? 0 : TMINI_FAULT_DATA;
        is_known = monitor->has_range || monitor->is_complete;
    }
    return is_known && observe(monitor, (uint8_t)faults);
}

static unsigned end_revolution(tmini_t *lidar, tmini_ct_verdict_t verdict)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    unsigned shown = judge_revolution(lidar, verdict) ? TMINI_SHOWN_FAULTS : 0u;
    if (monitor->is_complete) {
        shown |= TMINI_SHOWN_COMPLETE;
    }
    if (verdict == TMINI_CT_REFUTED) {
        shown |= TMINI_SHOWN_LOSS;
    }
    monitor->is_complete = true;
    monitor->has_range = false;
    return shown;
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

unsigned tmini_monitor_packet(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    const tmini_packet_t *const packet = &lidar->latest.packet;
    const tmini_ct_verdict_t verdict = tmini_ct_add(&lidar->ct, packet);
    const bool is_start = tmini_packet_is_start(packet);
    unsigned shown = 0;
    if (packet->gap > 1) { /* One byte may be LastCRC; with more, a packet may be lost. */
        monitor->is_complete = false;
    }
    if (is_start) {
        shown = end_revolution(lidar, verdict);
    }
    const bool has_range = tmini_packet_has_range(packet);
    if (has_range) {
        monitor->has_range = true;
    }
    if (is_start || has_range) {
        monitor->rotating_ms = lidar->link.now_ms;
    }
    return shown;
}

bool tmini_monitor_poll(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    /* No start packet and no range for so long: the rotor is blocked (section 8). */
    const uint16_t timeout_ms = lidar->link.timing->rotation_timeout_ms;
    return timeout_ms > 0 && tmini_has_elapsed(lidar, monitor->rotating_ms, timeout_ms) &&
           report(monitor, (uint8_t)(monitor->faults | TMINI_FAULT_ENCODER));
}
