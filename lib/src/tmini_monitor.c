/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* While the lidar scans: is it well? Packets in, faults out: what revolutions show, once two have
 * shown it; a rotor that stands still, by time; a rotor that does not turn as wanted, by the
 * frequency that it reports. */

#include "tmini_driver.h"

/* A frequency that differs by more than a twentieth for so long, and so many turns, will not become
 * the wanted one by itself. */
#define OFF_PART 20u
#define OFF_SECONDS 3u
#define OFF_TURNS 3u

/* Of 4000 a second (section 1): three seconds. */
#define TURN_SAMPLES_MAX 12000u

/* Of 300 packets without a start packet, this many with a range are not chance: damaged packets
 * whose checksum matches. */
#define TURNING_RANGES 100u

/* What one revolution shows is believed when the next one shows it too. */
static void observe(tmini_monitor_t *monitor, unsigned faults)
{
    if (faults == monitor->observed) {
        monitor->faults = (uint8_t)(faults | (monitor->faults & TMINI_FAULT_FREQUENCY));
    }
    monitor->observed = (uint8_t)faults;
}

/* A start packet: the revolution that it ends is judged by what the unit itself reports of its
 * health (section 7). If it reports nothing, by whether there was any range; of a revolution that
 * was not received completely, the rest may have had one. */
static void judge_revolution(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    unsigned faults = tmini_ct_faults(&lidar->decoder.ct);
    bool is_known = lidar->decoder.verdict == TMINI_CT_CONFIRMED;
    if (faults == TMINI_FAULTS_UNKNOWN) {
        faults = monitor->ranges > 0 ? 0 : TMINI_FAULT_DATA;
        is_known = monitor->ranges > 0 || monitor->is_complete;
    }
    if (is_known) {
        observe(monitor, faults);
    }
}

/* Counts revolutions in a row that took another time than wanted. Their number, by the frequency
 * that they report, is also how long that has lasted. */
static void judge_frequency(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    const unsigned wanted_chz = lidar->wanted_chz;
    const unsigned chz = (lidar->decoder.packet.ct >> 1) * 10u; /* Section 7. */
    const unsigned off_chz = chz > wanted_chz ? chz - wanted_chz : wanted_chz - chz;
    if (wanted_chz == 0 || chz == 0 || off_chz <= wanted_chz / OFF_PART) {
        tmini_monitor_forget_frequency(lidar);
        return;
    }
    monitor->off_turns = (uint8_t)(monitor->off_turns + (monitor->off_turns < UINT8_MAX));
    if (monitor->off_turns >= OFF_TURNS && monitor->off_turns * 100u >= OFF_SECONDS * chz) {
        monitor->faults |= TMINI_FAULT_FREQUENCY;
    }
}

void tmini_monitor_forget_frequency(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    monitor->off_turns = 0;
    monitor->is_tried_again = false;
    monitor->faults = monitor->faults & TMINI_FAULT_MASK;
}

bool tmini_monitor_wants_frequency(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    if ((monitor->faults & TMINI_FAULT_FREQUENCY) == 0 || monitor->is_tried_again) {
        return false;
    }
    monitor->is_tried_again = true;
    return true;
}

void tmini_monitor_begin(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    monitor->is_complete = false;
    monitor->ranges = 0;
    monitor->samples = 0;
    monitor->off_turns = 0;
    monitor->observed = monitor->faults & TMINI_FAULT_MASK;
    monitor->rotating_ms = lidar->line.now_ms;
}

/* A revolution has ended, and the next begins. */
static void begin_revolution(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    judge_revolution(lidar);
    judge_frequency(lidar);
    monitor->is_complete = true;
    monitor->ranges = 0;
    monitor->samples = 0;
    monitor->rotating_ms = lidar->line.now_ms;
}

bool tmini_monitor_packet(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    const tmini_packet_t *const packet = &lidar->decoder.packet;
    bool is_whole = false;
    monitor->samples = (uint16_t)(monitor->samples + packet->count);
    if (packet->gap > 1) { /* One byte may be LastCRC; with more, a packet may be lost. */
        monitor->is_complete = false;
    }
    if (tmini_packet_is_start(packet)) {
        is_whole = monitor->is_complete;
        begin_revolution(lidar);
    }
    if (tmini_packet_has_range(packet)) {
        monitor->ranges = (uint8_t)(monitor->ranges + (monitor->ranges < UINT8_MAX));
        monitor->rotating_ms = lidar->line.now_ms;
    }
    return is_whole;
}

static void note_standstill(tmini_monitor_t *monitor)
{
    monitor->faults |= TMINI_FAULT_ENCODER;
    monitor->observed = monitor->faults & TMINI_FAULT_MASK;
}

/* More samples than any turn has, and no start packet. If ranges have come after the fault was
 * noted, it turns. */
static bool turns_without_start(tmini_monitor_t *monitor)
{
    if (monitor->samples < TURN_SAMPLES_MAX) {
        return false;
    }
    const bool turns =
        monitor->ranges >= TURNING_RANGES && (monitor->faults & TMINI_FAULT_ENCODER) != 0;
    note_standstill(monitor);
    monitor->samples = 0;
    monitor->is_complete = false;
    monitor->ranges = 0;
    return turns;
}

/* No start packet and no range for this long: the rotor is blocked (section 8). */
bool tmini_monitor_poll(tmini_t *lidar)
{
    tmini_monitor_t *const monitor = &lidar->monitor;
    if (tmini_has_elapsed(lidar, monitor->rotating_ms, TMINI_ROTATION_TIMEOUT_MS)) {
        note_standstill(monitor);
    }
    return !turns_without_start(monitor);
}

uint32_t tmini_monitor_idle_ms(const tmini_t *lidar)
{
    const uint32_t still_ms = lidar->line.now_ms - lidar->monitor.rotating_ms;
    return still_ms < TMINI_ROTATION_TIMEOUT_MS ? TMINI_ROTATION_TIMEOUT_MS - still_ms
                                                : TMINI_ROTATION_TIMEOUT_MS;
}
