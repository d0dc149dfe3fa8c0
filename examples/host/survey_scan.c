/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "survey.h"

#define STEADY_US 8000000u
#define SAMPLE_US 250u /* Section 1. */
#define BYTES_US(n) ((n)*434u / 10u)
#define HZ_OF_SAMPLES 40000u /* Divided by a turn's samples: its frequency in 0.1 Hz. */

/* From fewer samples the speed cannot be computed well. */
#define SPEED_SAMPLES 10u

void survey_scan_begin(survey_scan_t *scan, uint16_t set_chz, uint64_t now_us)
{
    *scan = (survey_scan_t){.set_chz = set_chz, .start_us = now_us};
    (void)tmini_ring_init(&scan->ring, scan->memory, sizeof scan->memory, false);
    (void)tmini_decoder_init(&scan->decoder, &scan->ring, 255);
}

static uint32_t difference(uint32_t a, uint32_t b)
{
    return a > b ? a - b : b - a;
}

static void note_speed(survey_scan_t *scan, const tmini_packet_t *packet, uint64_t now_us)
{
    const uint32_t swept_q6 = tmini_clockwise(packet->first_angle_q6, packet->last_angle_q6);
    const uint32_t i = scan->early_count;
    if (packet->count < SPEED_SAMPLES || i == SURVEY_EARLY) {
        return;
    }
    scan->early[i].us = (uint32_t)(now_us - scan->first_us);
    scan->early[i].chz =
        (uint16_t)(swept_q6 * HZ_OF_SAMPLES * 10 / TMINI_FULL_CIRCLE_Q6 / (packet->count - 1u));
    scan->early_count++;
}

/* Is the frequency in a start packet that of the turn before it or after it? (Section 9.8.) */
static void compare_reported(survey_scan_t *scan)
{
    if (scan->before_samples > 0 && scan->now_samples > 0) {
        scan->before_error += difference(scan->reported_dhz, HZ_OF_SAMPLES / scan->before_samples);
        scan->after_error += difference(scan->reported_dhz, HZ_OF_SAMPLES / scan->now_samples);
    }
}

static void note_steady_turn(survey_scan_t *scan, const tmini_packet_t *packet)
{
    if (scan->turns == 0) {
        scan->start_q6 = packet->first_angle_q6;
    }
    const uint16_t off_q6 = tmini_clockwise(scan->start_q6, packet->first_angle_q6);
    scan->start_sum_q6 += off_q6 < TMINI_FULL_CIRCLE_Q6 / 2 ? off_q6 : (int32_t)off_q6 - 23040;
    scan->turns++;
    scan->turn_samples += scan->now_samples;
    scan->turn_reported_dhz += packet->ct / 2u;
}

/* LastCRC is the one byte before a start packet (section 7). */
static void note_start(survey_scan_t *scan, const tmini_packet_t *packet, uint64_t now_us)
{
    const uint8_t verdict = scan->decoder.verdict;
    scan->last_crc_bytes += packet->gap == 1 ? 1 : 0;
    scan->confirmed += verdict == TMINI_CT_CONFIRMED ? 1 : 0;
    scan->refuted += verdict == TMINI_CT_REFUTED ? 1 : 0;
    scan->last_crcs_aa += verdict == TMINI_CT_CONFIRMED && scan->crc == 0xAA ? 1 : 0;
    scan->crc = 0;
    if (scan->start_packets > 0) {
        compare_reported(scan);
        if (now_us - scan->first_us > STEADY_US && scan->now_samples > 0) {
            note_steady_turn(scan, packet);
        }
        scan->before_samples = scan->now_samples;
    }
    scan->reported_dhz = packet->ct / 2u;
    scan->now_samples = 0;
    scan->is_damaged = false;
    scan->start_packets++;
}

/* A packet of one sample that is not the rest of a turn (section 9.6). */
static void note_lone(survey_scan_t *scan, const tmini_packet_t *packet)
{
    if (!tmini_packet_is_start(packet) && scan->latest_is_point != 0 && scan->latest_count == 1) {
        scan->lone_packets++;
    }
    scan->latest_is_point = tmini_packet_is_start(packet) ? 0 : 1;
    scan->latest_count = packet->count;
}

static void note_samples(survey_scan_t *scan, const tmini_packet_t *packet, uint64_t now_us)
{
    tmini_point_t point;
    for (size_t i = 0; tmini_packet_point(packet, i, &point); i++) {
        scan->flagged += point.flag == TMINI_FLAG_SPECULAR || point.flag == TMINI_FLAG_AMBIENT;
    }
    scan->samples += packet->count;
    scan->now_samples += scan->is_damaged ? 0 : packet->count;
    if (scan->steady_us == 0 && now_us - scan->first_us > STEADY_US) {
        scan->steady_us = now_us;
    } else if (scan->steady_us != 0) {
        scan->steady_samples += packet->count;
        scan->steady_end_us = now_us;
    }
}

static void note_first(survey_scan_t *scan, const tmini_packet_t *packet, uint64_t now_us)
{
    scan->first_us =
        now_us - packet->count * SAMPLE_US - BYTES_US(TMINI_PACKET_SIZE(packet->count));
    scan->first_q6 = packet->first_angle_q6;
    scan->begins_with_start = tmini_packet_is_start(packet);
}

/* Adds up the angle turned before the first start packet. More than a turn means that the rotor has
 * passed the start angle without sending one (section 9.8). */
static void note_way(survey_scan_t *scan, const tmini_packet_t *packet)
{
    static const uint32_t full_q6 = TMINI_FULL_CIRCLE_Q6;
    const uint32_t at_q6 = scan->until_start_q6 % full_q6;
    const uint32_t to_q6 = tmini_clockwise(scan->first_q6, packet->first_angle_q6);
    if (to_q6 + full_q6 / 2 < at_q6) {
        scan->until_start_q6 += full_q6;
    }
    scan->until_start_q6 = scan->until_start_q6 - at_q6 + to_q6;
}

/* The frequency cannot be computed from a turn with a gap. At full speed the samples that are
 * missing in the gap are counted, too. */
static void note_gap(survey_scan_t *scan, const tmini_packet_t *packet)
{
    const bool is_last_crc = tmini_packet_is_start(packet) && packet->gap == 1;
    if (scan->packets > 0 && packet->gap > 0 && !is_last_crc) {
        scan->damages++;
        scan->is_damaged = true;
        scan->steady_samples += scan->steady_us != 0 ? packet->gap * 40u / 130u : 0;
    }
    scan->now_samples = scan->is_damaged ? 0 : scan->now_samples;
}

static void take(survey_scan_t *scan, const tmini_packet_t *packet, uint64_t now_us)
{
    const bool is_start = tmini_packet_is_start(packet);
    if (scan->packets == 0) {
        note_first(scan, packet, now_us);
    }
    note_gap(scan, packet);
    note_lone(scan, packet);
    note_speed(scan, packet, now_us);
    if (scan->start_packets == 0) {
        note_way(scan, packet);
    }
    if (is_start) {
        note_start(scan, packet, now_us);
    }
    note_samples(scan, packet, now_us);
    scan->crc = tmini_ct_crc8(scan->crc, packet->ct);
    scan->has_ct |= !is_start && packet->ct != 0;
    scan->longest = packet->count > scan->longest ? packet->count : scan->longest;
    scan->packets++;
}

void survey_scan_feed(survey_scan_t *scan, const uint8_t *bytes, size_t count, uint64_t now_us)
{
    tmini_ring_write(&scan->ring, bytes, count);
    while (tmini_decoder_next(&scan->decoder, 0) == TMINI_FRAME_PACKET) {
        (void)tmini_decoder_take(&scan->decoder, false, (uint32_t)(now_us / 1000), 0);
        take(scan, &scan->decoder.packet, now_us);
    }
    tmini_ct_read(&scan->decoder.ct, &scan->ct);
}

uint32_t survey_scan_measured_chz(const survey_scan_t *scan)
{
    return scan->turn_samples > 0
               ? (uint32_t)((uint64_t)HZ_OF_SAMPLES * 10 * scan->turns / scan->turn_samples)
               : 0;
}
