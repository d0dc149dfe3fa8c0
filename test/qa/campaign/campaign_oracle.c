/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign_oracle.h"

#include <stdio.h>

/* Without LastCRC and without a trace on the line, a hole of less than 4 degrees between two
 * packets cannot be told from jitter by whom it has only angles to go by. */
#define INVISIBLE_Q6 256u

/* What the points of one scan come to. */
typedef struct {
    line_mark_t first;
    line_mark_t odd;    /* The point that first does not belong, */
    uint32_t odd_at;    /* and its index. */
    uint32_t next;      /* The sample expected. */
    uint32_t missing;   /* Samples skipped so far, */
    uint32_t widest_q6; /* and the widest hole that they left. */
    uint16_t angle_q6;  /* Of the point before. */
    bool merged;
    bool false_point;
    bool disorder;
} reading_t;

void oracle_begin(oracle_t *oracle, verdicts_t *verdicts, uint64_t trial, const line_t *line)
{
    *oracle = (oracle_t){.verdicts = verdicts, .trial = trial, .line = line};
    verdicts->trials++;
}

void oracle_speak(oracle_t *oracle)
{
    oracle->speaks = true;
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
        reading->odd = *mark;
        reading->odd_at = index;
    }
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

static reading_t read_points(const line_t *line, const tmini_scan_t *scan)
{
    reading_t reading = {0};

    for (uint32_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        line_mark_t mark;

        if (!line_identify(line, point->distance_mm, point->intensity, point->flag, &mark) ||
            line->angles_q6[mark.revolution][mark.sample] != point->angle_q6) {
            reading.false_point = true;
            continue;
        }
        if (i == 0) {
            reading.first = mark;
            reading.missing = mark.sample; /* Scans begin with the start packet. */
            reading.widest_q6 = mark.sample > 0 ? UINT32_MAX : 0;
            reading.angle_q6 = point->angle_q6;
            reading.next = mark.sample;
        }
        follow(&reading, i, point, &mark);
    }
    return reading;
}

/* Samples missing at the end, up to the next start packet, or in between. */
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

void oracle_judge_scan(oracle_t *oracle, const tmini_scan_t *scan)
{
    reading_t reading = read_points(oracle->line, scan);

    if (oracle->speaks) {
        say(&reading, oracle->line, scan);
    }
    oracle->verdicts->scans++;
    oracle->verdicts->points += scan->count;
    oracle->verdicts->complete += scan->complete ? 1 : 0;
    note(oracle, WRONG_POINT, reading.false_point);
    note(oracle, WRONG_MERGED, reading.merged);
    note(oracle, WRONG_MERGED_COMPLETE, reading.merged && scan->complete);
    note(oracle, WRONG_ORDER, reading.disorder && !reading.merged);
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
         host->told != counters.bytes_in_packets + counters.bytes_in_replies +
                           counters.bytes_skipped + counters.bytes_overrun +
                           counters.bytes_pending);
}

/* The first revolution begins before its start packet, and the next one may be in the first bytes
 * that come at all: nobody knows how long the line was silent before those. Who holds bytes for 250
 * ms does not know it of the first 250 ms, nor of the last. */
#define UNCERTAIN_REVOLUTIONS 4u

static uint32_t first_certain(const host_t *host)
{
    const bool holds = host->config.feed == FEED_BLOCKS && host->config.block_us == 0;

    return holds ? UNCERTAIN_REVOLUTIONS : 2;
}

static void judge_cost(oracle_t *oracle, const host_t *host)
{
    const line_t *const line = oracle->line;

    for (uint32_t i = first_certain(host); i + UNCERTAIN_REVOLUTIONS < line->config.revolutions;
         i++) {
        if (!line->touched[i] && line->counts[i] <= host->config.max_points) {
            oracle->verdicts->untouched++;
            note(oracle, WRONG_COST, !oracle->delivered[i]);
        }
    }
}

void oracle_end(oracle_t *oracle, const host_t *host)
{
    tmini_counters_t counters;

    tmini_counters(&host->lidar, &counters);
    oracle->verdicts->bytes += host->told;
    oracle->verdicts->overrun += counters.bytes_overrun;
    oracle->verdicts->gaps_told += host->gaps_told;
    oracle_judge_account(oracle, host);
    note(oracle, WRONG_REMAINDER, counters.bytes_pending > 0);
    /* What an overflow has cost cannot be known from outside. */
    if (counters.bytes_overrun == 0 && (host->gaps_told == 0 || host->config.feed != FEED_DMA)) {
        judge_cost(oracle, host);
    }
}

const char *oracle_name(wrong_t wrong)
{
    static const char *const names[WRONG_KINDS] = {
        [WRONG_MERGED] = "scans of two revolutions",
        [WRONG_MERGED_COMPLETE] = "  of which complete",
        [WRONG_POINT] = "scans with points never sent",
        [WRONG_ORDER] = "scans out of order",
        [WRONG_COMPLETE] = "complete, but something is missing",
        [WRONG_SILENCE] = "something missing, without a word",
        [WRONG_ACCOUNT] = "accounts that do not balance",
        [WRONG_REMAINDER] = "bytes left for ever",
        [WRONG_COST] = "whole revolutions not complete"};

    return names[wrong];
}
