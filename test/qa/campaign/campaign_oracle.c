/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign_oracle.h"

#include <stdio.h>
#include <string.h>

/* Without LastCRC, if whole packets are missing, only the angles can show the hole between two
 * packets. Below 4 degrees, a hole cannot be distinguished from jitter. */
#define INVISIBLE_Q6 256u

typedef struct {
    line_mark_t first;
    line_mark_t last;   /* The previous point. */
    line_mark_t before; /* The last point before `odd`. */
    line_mark_t odd;    /* The first point of another revolution or out of order. */
    uint32_t odd_at;    /* Index of `odd` in the scan. */
    uint32_t next;      /* The expected sample. */
    uint32_t missing;   /* Samples missing so far. */
    uint32_t widest_q6; /* The widest hole that these left. */
    uint16_t angle_q6;  /* Angle of the previous point. */
    bool merged;
    bool false_point;
    bool disorder;
    bool again; /* A point was already in an earlier scan. */
} reading_t;

void oracle_begin(oracle_t *oracle, verdicts_t *verdicts, uint64_t trial, const line_t *line,
                  bool speaks)
{
    memset(oracle, 0, sizeof *oracle);
    oracle->verdicts = verdicts;
    oracle->trial = trial;
    oracle->line = line;
    oracle->speaks = speaks;
    verdicts->trials++;
}

static void note(oracle_t *oracle, wrong_t wrong, bool is_so)
{
    verdicts_t *const verdicts = oracle->verdicts;
    if (!is_so) {
        return;
    }
    if (verdicts->wrongs[wrong] == 0) {
        verdicts->first_trial[wrong] = oracle->trial;
    }
    verdicts->wrongs[wrong]++;
    if (oracle->speaks) {
        printf("  wrong: %s\n", oracle_name(wrong));
    }
}

static uint32_t turned_q6(uint16_t from, uint16_t to)
{
    return to >= from ? (uint32_t)to - from : (uint32_t)to + 23040u - from;
}

static void follow(reading_t *reading, uint32_t index, const tmini_point_t *point,
                   const line_mark_t *mark)
{
    const bool is_odd =
        mark->revolution != reading->first.revolution || mark->sample < reading->next;
    if (is_odd && !reading->merged && !reading->disorder) {
        reading->before = reading->last;
        reading->odd = *mark;
        reading->odd_at = index;
    }
    reading->last = *mark;
    if (mark->revolution != reading->first.revolution) {
        reading->merged = true;
    } else if (mark->sample < reading->next) {
        reading->disorder = true;
    } else if (mark->sample > reading->next) {
        const uint32_t hole_q6 = turned_q6(reading->angle_q6, point->angle_q6);
        reading->missing += mark->sample - reading->next;
        reading->widest_q6 = hole_q6 > reading->widest_q6 ? hole_q6 : reading->widest_q6;
    }
    reading->next = mark->sample + 1;
    reading->angle_q6 = point->angle_q6;
}

static uint32_t sent_us(const line_t *line, const line_mark_t *mark)
{
    for (uint32_t i = 0; i < line->packet_count; i++) {
        const line_packet_t *const packet = &line->packets[i];
        if (packet->revolution == mark->revolution &&
            mark->sample < packet->first + packet->samples) {
            return packet->sent_us;
        }
    }
    return 0;
}

/* Also counts in how many scans each point is: it must be only one. */
static reading_t read_points(oracle_t *oracle, const tmini_scan_t *scan)
{
    const line_t *const line = oracle->line;
    reading_t reading = {0};
    for (uint32_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        line_mark_t mark;
        const bool is_sent =
            line_identify(line, point->distance_mm, point->intensity, point->flag, &mark);
        if (is_sent) {
            reading.again |= oracle->seen[mark.revolution][mark.sample]++ > 0;
        }
        if (!is_sent || line->angles_q6[mark.revolution][mark.sample] != point->angle_q6) {
            reading.false_point = true;
            continue;
        }
        if (i == 0) {
            reading.first = mark;
            reading.missing = mark.sample; /* A scan begins with the start packet: sample 0. */
            reading.widest_q6 = mark.sample > 0 ? UINT32_MAX : 0;
            reading.angle_q6 = point->angle_q6;
            reading.next = mark.sample;
        }
        follow(&reading, i, point, &mark);
    }
    return reading;
}

/* Counts the samples missing between the last point and the next start packet. */
static void read_end(reading_t *reading, const line_t *line, const tmini_scan_t *scan)
{
    const uint32_t count = line->counts[reading->first.revolution];
    const uint32_t next = reading->first.revolution + 1;
    if (reading->next < count && scan->dropped == 0) {
        const uint32_t hole_q6 = next < line->config.revolutions && line->counts[next] > 0
                                     ? turned_q6(reading->angle_q6, line->angles_q6[next][0])
                                     : UINT32_MAX;
        reading->missing += count - reading->next;
        reading->widest_q6 = hole_q6 > reading->widest_q6 ? hole_q6 : reading->widest_q6;
    }
}

static void judge_completeness(oracle_t *oracle, const reading_t *reading, const tmini_scan_t *scan)
{
    const bool is_invisible =
        !oracle->line->config.ct_information && reading->widest_q6 <= INVISIBLE_Q6;
    const bool lacks = reading->missing > 0 || reading->first.revolution == 0;
    if (scan->complete && lacks && !reading->merged && is_invisible) {
        oracle->verdicts->invisible++;
        return;
    }
    note(oracle, WRONG_COMPLETE, scan->complete && (lacks || scan->dropped > 0));
    note(oracle, WRONG_SILENCE, lacks && scan->gaps == 0 && scan->dropped == 0 && !is_invisible);
    if (scan->complete && !lacks && reading->first.revolution < LINE_REVOLUTIONS) {
        oracle->delivered[reading->first.revolution] = true;
    }
}

static void say(const reading_t *reading, const line_t *line, const tmini_scan_t *scan)
{
    printf("scan of revolution %u: %u of %u points, %u packets, %u gaps, %u dropped%s\n",
           reading->first.revolution, scan->count, line->counts[reading->first.revolution],
           scan->packets, scan->gaps, scan->dropped, scan->complete ? ", complete" : "");
    if (reading->merged || reading->disorder) {
        printf("  point %u is sample %u of revolution %u\n", reading->odd_at, reading->odd.sample,
               reading->odd.revolution);
    }
}

/* True if a poll or a hand-over may come later than the longest pause allowed. */
static bool may_be_late(const host_config_t *config)
{
    const uint32_t pause_us = config->max_pause_ms * 1000u;
    return config->poll_us > pause_us || config->block_us > pause_us || config->hold_one_in > 0 ||
           (config->feed == FEED_BLOCKS && config->block_us == 0) || config->stall_one_in > 0 ||
           (config->handle_one_in > 0 && config->handler_us > pause_us);
}

/* The longest silence between two bytes that arrived in this time. */
static uint32_t longest_silence_us(const line_t *line, uint32_t from_us, uint32_t to_us)
{
    uint32_t longest = 0;
    for (uint32_t i = 1; i < line->size && line->at_us[i] <= to_us; i++) {
        const uint32_t silence_us = line->at_us[i] - line->at_us[i - 1];
        if (line->at_us[i] > from_us && silence_us > longest) {
            longest = silence_us;
        }
    }
    return longest;
}

/* Returns why one incomplete scan may have points of two revolutions: the library measures a
 * silence only by the times of polls and hand-overs. */
static mixed_t explain(const line_t *line, const host_config_t *config, const reading_t *reading)
{
    const uint32_t pause_us = config->max_pause_ms * 1040u + config->poll_us + config->preempt_us +
                              (config->feed == FEED_BLOCKS ? config->block_us : 0) + 10000u;
    const uint32_t from_us = sent_us(line, &reading->before);
    const uint32_t to_us = sent_us(line, &reading->odd);
    if (config->max_pause_ms == 0) {
        return MIXED_UNTIMED;
    }
    if (may_be_late(config)) {
        return MIXED_UNSEEN;
    }
    return longest_silence_us(line, from_us, to_us) < pause_us ? MIXED_DRIBBLE : MIXED_STRANGE;
}

static void judge_mixture(oracle_t *oracle, const host_t *host, const reading_t *reading,
                          const tmini_scan_t *scan)
{
    note(oracle, WRONG_MERGED_COMPLETE, scan->complete);
    if (!scan->complete) {
        const mixed_t mixed = explain(oracle->line, &host->config, reading);
        oracle->verdicts->mixed[mixed]++;
        note(oracle, WRONG_MERGED, mixed == MIXED_STRANGE);
        if (oracle->speaks) {
            printf("  mixed: %s\n", oracle_mixed_name(mixed));
        }
    }
}

void oracle_judge_scan(oracle_t *oracle, const host_t *host, const tmini_scan_t *scan)
{
    reading_t reading = read_points(oracle, scan);
    if (oracle->speaks) {
        say(&reading, oracle->line, scan);
    }
    oracle->verdicts->scans++;
    oracle->verdicts->points += scan->count;
    oracle->verdicts->complete += scan->complete ? 1 : 0;
    note(oracle, WRONG_POINT, reading.false_point);
    if (reading.merged) {
        judge_mixture(oracle, host, &reading, scan);
    }
    note(oracle, WRONG_ORDER, reading.disorder && !reading.merged);
    note(oracle, WRONG_TWICE, reading.again);
    if (!reading.merged && !reading.false_point) {
        read_end(&reading, oracle->line, scan);
        judge_completeness(oracle, &reading, scan);
    }
}

void oracle_judge_account(oracle_t *oracle, const host_t *host)
{
    tmini_counters_t counters;
    tmini_counters(&host->lidar, &counters);
    note(oracle, WRONG_ACCOUNT,
         host->reported != counters.bytes_in_packets + counters.bytes_in_replies +
                               counters.bytes_skipped + counters.bytes_overrun +
                               counters.bytes_pending);
}

/* A trial's first and last revolutions may be incomplete scans: with rare polls and a layer below,
 * the library cannot know how long the line was silent before the first bytes and after the last.
 * At the end, bytes that waited for room come after the line is silent. */
#define UNCERTAIN_US 250000u
#define WATCHED_US 30000u
#define BYTE_US 76u

static bool is_certain(const line_t *line, const host_config_t *config, uint32_t revolution)
{
    const uint32_t turn_us = 100000000u / line->config.frequency_chz;
    const uint32_t waits_us = config->asks_room ? config->block_size * BYTE_US : 0;
    const uint32_t look_us = config->poll_us > UNCERTAIN_US ? config->poll_us : UNCERTAIN_US;
    const bool is_watched = config->poll_us <= WATCHED_US && config->block_us > 0;
    return revolution > (is_watched ? 0 : look_us / turn_us + 2) &&
           revolution + 2 + (look_us + waits_us) / turn_us < line->config.revolutions;
}

static void judge_cost(oracle_t *oracle, const host_t *host)
{
    const line_t *const line = oracle->line;
    for (uint32_t i = 0; i < line->config.revolutions; i++) {
        if (!line->touched[i] && line->counts[i] <= host->config.max_points &&
            is_certain(line, &host->config, i)) {
            oracle->verdicts->untouched++;
            note(oracle, WRONG_COST, !oracle->delivered[i]);
        }
    }
}

/* How many points of the packet are in exactly one scan. */
static uint32_t in_one_scan(const oracle_t *oracle, const line_packet_t *packet)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < packet->samples; i++) {
        count += oracle->seen[packet->revolution][packet->first + i] == 1 ? 1 : 0;
    }
    return count;
}

/* While the program works on a scan, DMA may overwrite the packet that ended it and waits to be
 * added to the next one, which then has a gap. (14 bytes per millisecond, beside the packet.) */
static bool may_overwrite_a_packet(const host_config_t *config)
{
    return config->feed == FEED_DMA && config->handle_one_in > 0 &&
           config->handler_us / 1000u * 14u + 100u > config->rx_size / 2;
}

/* Each point of an intact packet after the first start packet must be in exactly one scan, unless
 * the library has withheld it, which it counts. The current, unfinished scan counts as one. */
static void judge_points(oracle_t *oracle, const host_t *host, uint32_t withheld)
{
    const line_t *const line = oracle->line;
    const tmini_builder_t *const builder = &host->lidar.decoder.builder;
    uint32_t lacking = 0;
    bool begun = false;
    if (builder->open) {
        note(oracle, WRONG_TWICE, read_points(oracle, &builder->scan).again);
    }
    for (uint32_t i = 0; i < line->packet_count; i++) {
        const line_packet_t *const packet = &line->packets[i];
        begun |= packet->is_start && packet->missing == 0;
        if (begun && packet->missing == 0) {
            const uint32_t in_one = in_one_scan(oracle, packet);
            oracle->verdicts->intact += packet->samples;
            oracle->verdicts->in_one += in_one;
            lacking += packet->samples - in_one;
            if (oracle->speaks && in_one < packet->samples) {
                printf("  packet of revolution %u, samples %u to %u, sent at %u ms\n",
                       packet->revolution, packet->first, packet->first + packet->samples - 1,
                       packet->sent_us / 1000);
            }
        }
    }
    note(oracle, WRONG_LOSS, lacking > withheld && !may_overwrite_a_packet(&host->config));
    oracle->verdicts->withheld += withheld;
}

void oracle_end(oracle_t *oracle, const host_t *host)
{
    tmini_counters_t counters;
    tmini_counters(&host->lidar, &counters);
    oracle->verdicts->bytes += host->reported;
    oracle->verdicts->overrun += counters.bytes_overrun;
    oracle->verdicts->gaps_reported += host->gaps_reported;
    oracle_judge_account(oracle, host);
    note(oracle, WRONG_REMAINDER, counters.bytes_pending > 0);
    /* It is not known here which bytes DMA has overwritten. */
    if (host->config.feed != FEED_DMA ||
        (counters.bytes_overrun == 0 && host->gaps_reported == 0)) {
        judge_cost(oracle, host);
        if (!host->was_lost && host->config.max_points == HOST_POINTS) {
            judge_points(oracle, host, counters.points_withheld);
        }
    }
}

const char *oracle_name(wrong_t wrong)
{
    static const char *const names[WRONG_KINDS] = {
        [WRONG_MERGED_COMPLETE] = "complete scans of two revolutions",
        [WRONG_MERGED] = "incomplete scans of two revolutions, unexplained",
        [WRONG_POINT] = "scans with points never sent",
        [WRONG_ORDER] = "scans out of order",
        [WRONG_COMPLETE] = "complete, but something is missing",
        [WRONG_SILENCE] = "something missing, but not reported",
        [WRONG_TWICE] = "scans with points of an earlier one",
        [WRONG_LOSS] = "trials with intact points in no scan, and not counted as withheld",
        [WRONG_ACCOUNT] = "counters that do not add up",
        [WRONG_REMAINDER] = "bytes still pending at the end",
        [WRONG_COST] = "whole revolutions not complete"};

    return names[wrong];
}

const char *oracle_mixed_name(mixed_t mixed)
{
    static const char *const names[MIXED_KINDS] = {[MIXED_UNTIMED] = "pauses are not judged",
                                                   [MIXED_UNSEEN] =
                                                       "a poll or a hand-over came late",
                                                   [MIXED_DRIBBLE] = "silences too short to count",
                                                   [MIXED_STRANGE] = "unexplained"};
    return names[mixed];
}
