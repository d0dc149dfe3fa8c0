/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Checks the library's scans against the samples on the line (sim_judge.h), and its counters. */

#ifndef CAMPAIGN_ORACLE_H
#define CAMPAIGN_ORACLE_H

#include "campaign_host.h"

/* Each lie of a scan (of those of two revolutions, the complete ones), and: */
typedef enum {
    WRONG_MERGED = SIM_LIES, /* An incomplete scan is of two revolutions: nothing explains it. */
    WRONG_ACCOUNT,           /* The counters have a byte too many or too few. */
    WRONG_REMAINDER,         /* Bytes are still pending after a long silence. */
    WRONG_LOSS,              /* Intact points are in no scan, and were not withheld. */
    WRONG_COST,              /* A revolution without losses is not delivered as complete. */
    WRONG_KINDS
} wrong_t;

/* Reasons why an incomplete scan may have points of two revolutions. */
typedef enum {
    MIXED_UNTIMED, /* max_pause_ms is 0: pauses are not judged. */
    MIXED_UNSEEN,  /* A poll or a hand-over between the two may have come late. */
    MIXED_DRIBBLE, /* Remains of damaged packets: each silence was shorter than max_pause_ms. */
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
    uint64_t gaps_reported;
    uint64_t untouched; /* Revolutions certainly without losses. */
    uint64_t invisible; /* Scans reported complete whose missing samples cannot be noticed. */
    uint64_t intact;    /* Points of packets certainly without losses. */
    uint64_t in_one;    /* Those of them that are in exactly one scan. */
    uint64_t withheld;  /* Points that the library withheld, because the program was behind. */
    uint64_t mixed[MIXED_KINDS];
    uint64_t wrongs[WRONG_KINDS];
    uint64_t first_trial[WRONG_KINDS]; /* The first trial with this error. */
} verdicts_t;

typedef struct {
    verdicts_t *verdicts;
    uint64_t trial;
    line_t *line;
    bool speaks;                      /* Prints each scan and each error. */
    bool delivered[LINE_REVOLUTIONS]; /* Revolutions delivered as complete. */
} oracle_t;

/* `speaks`: prints each scan and each error. */
void oracle_begin(oracle_t *oracle, verdicts_t *verdicts, uint64_t trial, line_t *line,
                  bool speaks);

void oracle_judge_scan(oracle_t *oracle, const host_t *host, const tmini_scan_t *scan);

/* Call it after a poll without an event, if no byte has arrived meanwhile. */
void oracle_judge_account(oracle_t *oracle, const host_t *host);

/* Call it after a long silence, when the library has delivered everything. */
void oracle_end(oracle_t *oracle, const host_t *host);

const char *oracle_name(unsigned wrong);
const char *oracle_mixed_name(mixed_t mixed);

#endif
