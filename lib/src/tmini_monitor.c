/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Finds faults while the lidar scans. Faults of a revolution count when the next one has them too.
 * A blocked rotor sends many samples without a start packet. A wrong frequency is in the start
 * packets. */

#include "tmini_driver.h"

/* A frequency that differs by more than 1/20 for this many seconds and turns will not correct
 * itself. */
#define OFF_PART 20
#define OFF_SECONDS 3
#define OFF_TURNS 3

/* Before it is set again, it must be wrong for twice as long each time, up to this many
 * doublings. */
#define OFF_DOUBLINGS_MAX 4

/* No turn has more samples: three seconds, at 4000 per second (section 1). */
#define TURN_SAMPLES_MAX 12000u

/* If this many of 300 packets without a start packet have a range, the rotor turns. Fewer may be
 * damaged packets whose checksum matches by chance. */
#define TURNING_RANGES 100u

/* The faults of a revolution count when the next one has the same. */
static void observe(tmini_monitor_t *monitor, uint8_t faults)
{
    if (faults == monitor->observed) {
        monitor->faults = (uint8_t)(faults | (monitor->faults & TMINI_FAULT_FREQUENCY));
    }
    monitor->observed = faults;
}

/* A start packet ends a revolution, which is judged by the health that the unit reports (section
 * 7). If it reports none, a revolution without any range has a fault, provided that it was received
 * completely. */
static void judge_revolution(tmini_monitor_t *monitor, const tmini_decoder_t *decoder)
{
    const bool was_blocked = (monitor->observed & TMINI_FAULT_ENCODER) != 0;
    unsigned faults = tmini_ct_faults(&decoder->ct);
    bool is_known = decoder->verdict == TMINI_CT_CONFIRMED;
    if (faults == TMINI_FAULTS_UNKNOWN) {
        faults = monitor->ranges > 0 ? 0 : TMINI_FAULT_DATA;
        is_known = monitor->ranges > 0 || (decoder->was_whole && !was_blocked);
    }
    if (is_known) {
        observe(monitor, (uint8_t)faults);
    } else if (was_blocked) {
        monitor->observed = TMINI_FAULT_FREQUENCY; /* A rotor that stood has made no revolution, and
                                                    * no revolution has this fault. */
    }
}

/* A revolution at the wanted frequency ends the fault. How often it has been wrong is kept: a motor
 * that comes up to speed and beyond passes through the wanted frequency each time. */
static void end_frequency_fault(tmini_monitor_t *monitor)
{
    monitor->off_turns = 0;
    monitor->faults = monitor->faults & TMINI_FAULT_MASK;
}

void tmini_monitor_forget_frequency(tmini_monitor_t *monitor)
{
    end_frequency_fault(monitor);
    monitor->off_times = 0;
    monitor->turns_to_still = 0;
}

/* Counts consecutive revolutions at another frequency than wanted, or while it is unknown which
 * one is set. Their number, divided by the frequency that they report, is the time that this has
 * lasted. After three seconds a wrong frequency is a fault. True when the frequency is to be set
 * again: after these three seconds, then after twice as long each time, or 255 turns. */
static bool has_become_off(tmini_monitor_t *monitor, uint16_t chz, uint16_t wanted_chz,
                           uint16_t reported_chz)
{
    const int32_t faster_chz = (int32_t)chz - wanted_chz;
    const int32_t off_chz = faster_chz < 0 ? -faster_chz : faster_chz;
    const int32_t enough = OFF_SECONDS * (int32_t)chz;
    const bool is_wrong = off_chz * OFF_PART > wanted_chz;
    if (wanted_chz == 0 || chz == 0 || (!is_wrong && reported_chz != 0)) {
        end_frequency_fault(monitor);
        return false;
    }
    monitor->off_turns++;
    const int32_t lasted = monitor->off_turns * (int32_t)100;
    if (monitor->off_turns < OFF_TURNS || lasted < enough) {
        return false;
    }
    monitor->faults = monitor->faults & TMINI_FAULT_MASK;
    if (is_wrong) {
        monitor->faults |= TMINI_FAULT_FREQUENCY;
    }
    if (monitor->off_turns < UINT8_MAX && lasted < enough << monitor->off_times) {
        return false;
    }
    monitor->off_turns = 0;
    monitor->off_times = (uint8_t)(monitor->off_times + (monitor->off_times < OFF_DOUBLINGS_MAX));
    return true;
}

/* True if the wish has changed, and then not for some turns. */
static bool has_become_still(tmini_monitor_t *monitor)
{
    if (monitor->turns_to_still > 0) {
        monitor->turns_to_still--;
        return monitor->turns_to_still == 0;
    }
    return false;
}

static void begin_revolution(tmini_monitor_t *monitor)
{
    monitor->ranges = 0;
    monitor->samples = 0;
}

void tmini_monitor_begin(tmini_monitor_t *monitor)
{
    begin_revolution(monitor);
    monitor->off_turns = 0;
    monitor->observed = monitor->faults;
}

/* The latest packet continues a revolution. If the revolution has more samples than any turn, the
 * rotor is blocked (section 8). If that fault is already known and many packets have a range, the
 * rotor turns and only start packets are lost. */
static tmini_turn_t go_on(tmini_monitor_t *monitor, const tmini_packet_t *packet)
{
    monitor->samples = (uint16_t)(monitor->samples + packet->count);
    if (monitor->samples < TURN_SAMPLES_MAX) {
        return TMINI_TURN_GOES_ON;
    }
    tmini_turn_t turn = TMINI_TURN_GOES_ON;
    if (monitor->ranges >= TURNING_RANGES && (monitor->faults & TMINI_FAULT_ENCODER) != 0) {
        turn = TMINI_TURN_ENDLESS;
    }
    monitor->faults |= TMINI_FAULT_ENCODER;
    monitor->observed = monitor->faults;
    begin_revolution(monitor);
    return turn;
}

static tmini_turn_t end_revolution(tmini_monitor_t *monitor, const tmini_decoder_t *decoder,
                                   uint16_t wanted_chz, uint16_t reported_chz)
{
    const uint16_t chz = tmini_packet_frequency_chz(&decoder->packet);
    judge_revolution(monitor, decoder);
    begin_revolution(monitor);
    if (has_become_still(monitor)) {
        return TMINI_TURN_STILL;
    }
    if (has_become_off(monitor, chz, wanted_chz, reported_chz)) {
        return TMINI_TURN_OFF;
    }
    return decoder->was_whole ? TMINI_TURN_WHOLE : TMINI_TURN_GOES_ON;
}

tmini_turn_t tmini_monitor_packet(tmini_monitor_t *monitor, const tmini_decoder_t *decoder,
                                  uint16_t wanted_chz, uint16_t reported_chz)
{
    const tmini_packet_t *const packet = &decoder->packet;
    const tmini_turn_t turn = tmini_packet_is_start(packet)
                                  ? end_revolution(monitor, decoder, wanted_chz, reported_chz)
                                  : go_on(monitor, packet);
    if (tmini_packet_has_range(packet)) {
        monitor->ranges = (uint8_t)(monitor->ranges + (monitor->ranges < UINT8_MAX));
    }
    return turn;
}
