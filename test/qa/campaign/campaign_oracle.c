/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "campaign_oracle.h"

#include "judge_scan.h"

#include <stdio.h>
#include <string.h>

void oracle_begin(oracle_t *oracle, verdicts_t *verdicts, uint64_t trial, line_t *line, bool speaks)
{
    memset(oracle, 0, sizeof *oracle);
    oracle->verdicts = verdicts;
    oracle->trial = trial;
    oracle->line = line;
    oracle->speaks = speaks;
    verdicts->trials++;
}

static void note(oracle_t *oracle, unsigned wrong, bool is_so)
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

static uint32_t revolution_at(const oracle_t *oracle, uint32_t place)
{
    return sim_judge_sample(&oracle->line->judge, place)->turn;
}

static uint32_t sent_us(const line_t *line, uint32_t place)
{
    uint32_t packet = 0;
    while (place >= line->packets[packet].first + line->packets[packet].samples) {
        packet++;
    }
    return line->packets[packet].sent_us;
}

static void say(const oracle_t *oracle, const sim_reading_t *reading, const tmini_scan_t *scan)
{
    const uint32_t revolution = revolution_at(oracle, reading->first);
    printf("scan of revolution %u: %u of %u points, %u packets, %u gaps, %u dropped%s\n",
           revolution, scan->count, oracle->line->counts[revolution], scan->packets, scan->gaps,
           scan->dropped, scan->complete ? ", complete" : "");
    if (reading->odd_at > 0) {
        printf("  point %u is of revolution %u\n", reading->odd_at,
               revolution_at(oracle, reading->odd));
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
static mixed_t explain(const line_t *line, const host_config_t *config,
                       const sim_reading_t *reading)
{
    const uint32_t pause_us = config->max_pause_ms * 1040u + config->poll_us + config->preempt_us +
                              (config->feed == FEED_BLOCKS ? config->block_us : 0) + 10000u;
    const uint32_t from_us = sent_us(line, reading->before);
    const uint32_t to_us = sent_us(line, reading->odd);
    if (config->max_pause_ms == 0) {
        return MIXED_UNTIMED;
    }
    if (may_be_late(config)) {
        return MIXED_UNSEEN;
    }
    return longest_silence_us(line, from_us, to_us) < pause_us ? MIXED_DRIBBLE : MIXED_STRANGE;
}

static void explain_mixture(oracle_t *oracle, const host_t *host, const sim_reading_t *reading)
{
    const mixed_t mixed = explain(oracle->line, &host->config, reading);
    oracle->verdicts->mixed[mixed]++;
    note(oracle, WRONG_MERGED, mixed == MIXED_STRANGE);
    if (oracle->speaks) {
        printf("  mixed: %s\n", oracle_mixed_name(mixed));
    }
}

void oracle_judge_scan(oracle_t *oracle, const host_t *host, const tmini_scan_t *scan)
{
    verdicts_t *const verdicts = oracle->verdicts;
    const sim_reading_t reading = judge_scan(&oracle->line->judge, scan);
    unsigned lies = reading.lies;
    if (oracle->speaks) {
        say(oracle, &reading, scan);
    }
    verdicts->scans++;
    verdicts->points += scan->count;
    verdicts->complete += scan->complete ? 1 : 0;
    verdicts->invisible += scan->complete && reading.is_hidden ? 1 : 0;
    if ((lies & SIM_LIE(SIM_LIE_MIXED)) != 0 && !scan->complete) {
        explain_mixture(oracle, host, &reading);
        lies &= ~SIM_LIE(SIM_LIE_MIXED);
    }
    for (unsigned lie = 0; lie < SIM_LIES; lie++) {
        note(oracle, lie, (lies & SIM_LIE(lie)) != 0);
    }
    if (scan->complete && reading.missing == 0) {
        oracle->delivered[revolution_at(oracle, reading.first)] = true;
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

/* While the program works on a scan, DMA may overwrite the packet that ended it and waits to be
 * added to the next one, which then has a gap. (14 bytes per millisecond, beside the packet.) */
static bool may_overwrite_a_packet(const host_config_t *config)
{
    return config->feed == FEED_DMA && config->handle_one_in > 0 &&
           config->handler_us / 1000u * 14u + 100u > config->rx_size / 2;
}

/* Each point of an intact packet after the first start packet must be in exactly one scan, unless
 * the library has withheld it, which it counts. The current, unfinished scan counts as one. */
static void judge_intact(oracle_t *oracle, const host_t *host, uint32_t withheld)
{
    const line_t *const line = oracle->line;
    const tmini_builder_t *const builder = &host->lidar.decoder.builder;
    uint32_t lacking = 0;
    bool begun = false;
    if (builder->open) {
        const unsigned lies = judge_points(&oracle->line->judge, &builder->scan).lies;
        note(oracle, SIM_LIE_AGAIN, (lies & SIM_LIE(SIM_LIE_AGAIN)) != 0);
    }
    for (uint32_t i = 0; i < line->packet_count; i++) {
        const line_packet_t *const packet = &line->packets[i];
        begun |= packet->is_start && packet->missing == 0;
        if (begun && packet->missing == 0) {
            const uint32_t in_one = sim_judge_in_one(&line->judge, packet->first, packet->samples);
            oracle->verdicts->intact += packet->samples;
            oracle->verdicts->in_one += in_one;
            lacking += packet->samples - in_one;
            if (oracle->speaks && in_one < packet->samples) {
                printf("  packet of revolution %u, sent at %u ms\n", packet->revolution,
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
            judge_intact(oracle, host, counters.points_withheld);
        }
    }
}

const char *oracle_name(unsigned wrong)
{
    static const char *const names[WRONG_KINDS] = {
        [WRONG_MERGED] = "incomplete scans of two revolutions, unexplained",
        [WRONG_LOSS] = "trials with intact points in no scan, and not counted as withheld",
        [WRONG_ACCOUNT] = "counters that do not add up",
        [WRONG_REMAINDER] = "bytes still pending at the end",
        [WRONG_COST] = "whole revolutions not complete"};

    return wrong < SIM_LIES ? sim_lie_name((sim_lie_t)wrong) : names[wrong];
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
