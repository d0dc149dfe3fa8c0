/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Judges what the library delivers by what the line's samples themselves say. */

#ifndef CAMPAIGN_ORACLE_H
#define CAMPAIGN_ORACLE_H

#include "campaign_host.h"

typedef enum {
    WRONG_MERGED_COMPLETE, /* A scan has points of two revolutions, and says that it is complete; */
    WRONG_MERGED,          /* or does not, and nothing explains it. */
    WRONG_POINT,           /* A point that was not sent, or with another angle. */
    WRONG_ORDER,           /* A point that does not follow the one before it. */
    WRONG_COMPLETE,        /* Complete, though something of the revolution is missing. */
    WRONG_SILENCE,         /* Something is missing, and neither gaps nor dropped says so. */
    WRONG_TWICE,           /* A point that was in a scan before. */
    WRONG_ACCOUNT,         /* A byte too many or too few in the counters. */
    WRONG_REMAINDER,       /* Bytes still wait when none has come for long. */
    WRONG_LOSS,            /* A packet that has come whole is in no scan. */
    WRONG_COST,            /* A revolution that has come whole, not delivered as complete. */
    WRONG_KINDS
} wrong_t;

/* Reasons why an incomplete scan may have points of two revolutions without any sign of it. */
typedef enum {
    MIXED_UNTIMED, /* max_pause_ms is 0: pauses are not judged. */
    MIXED_UNSEEN,  /* Between the two there was a look or a hand-over that came late. */
    MIXED_DRIBBLE, /* Silences shorter than max_pause_ms, between remains of damaged packets. */
    MIXED_STRANGE, /* None of these. */
    MIXED_KINDS
} mixed_t;

typedef struct {
    uint64_t trials;
    uint64_t scans;
    uint64_t complete;
    uint64_t points;
    uint64_t bytes;
    uint64_t overrun;
    uint64_t gaps_told;
    uint64_t untouched; /* Revolutions that have come whole, in trials where that is known. */
    uint64_t invisible; /* Complete, but for a few samples that nothing can miss. */
    uint64_t intact;    /* Points of packets that have come whole, where that is known, */
    uint64_t in_one;    /* and those of them that are in exactly one scan. */
    uint64_t mixed[MIXED_KINDS];
    uint64_t wrongs[WRONG_KINDS];
    uint64_t first_trial[WRONG_KINDS]; /* In which each went wrong first. */
} verdicts_t;

typedef struct {
    verdicts_t *verdicts;
    uint64_t trial;
    const line_t *line;
    bool speaks;                                  /* Says what it finds wrong. */
    bool delivered[LINE_REVOLUTIONS];             /* As complete. */
    uint8_t seen[LINE_REVOLUTIONS][LINE_SAMPLES]; /* In how many scans it is. */
} oracle_t;

void oracle_begin(oracle_t *oracle, verdicts_t *verdicts, uint64_t trial, const line_t *line);

/* From now on prints each error. */
void oracle_speak(oracle_t *oracle);

void oracle_judge_scan(oracle_t *oracle, const host_t *host, const tmini_scan_t *scan);

/* Call it when a poll has found nothing, and nothing has come meanwhile. */
void oracle_judge_account(oracle_t *oracle, const host_t *host);

/* The line has been silent for long, and all that can be delivered has been. */
void oracle_end(oracle_t *oracle, const host_t *host);

const char *oracle_name(wrong_t wrong);
const char *oracle_mixed_name(mixed_t mixed);

#endif
