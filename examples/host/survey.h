/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests what the protocol leaves open. survey.c sends commands, survey_scan.c examines the scan
 * data, survey_table.c compares with docs/protocol.md (above all section 9) and writes the report,
 * which the simulated lidar accepts as its settings (test/simulator/like.c). */

#ifndef SURVEY_H
#define SURVEY_H

#include <stdio.h>

#include "tmini/parts/tmini_decoder.h"
#include "tmini/parts/tmini_reply.h"

/* The line to the unit, and the time. */
typedef struct {
    void *context;
    uint64_t (*now_us)(void *context);
    void (*send)(void *context, const uint8_t *bytes, size_t count);
    /* Returns how many bytes have come; waits for the first one until `until_us`. 0: none came. */
    size_t (*receive)(void *context, uint8_t *bytes, size_t max, uint64_t until_us);
    bool (*is_over)(void *context);               /* True after Ctrl-C, or when the port has
                                                   * failed. */
    void (*say)(void *context, const char *text); /* Prints what is done next. */
} survey_wire_t;

/* What came after a command; `bytes` holds the first ones of `count`. */
typedef struct {
    uint8_t bytes[32];
    size_t count;
    uint64_t after_us; /* When the first byte came. */
} survey_reply_t;

#define SURVEY_EARLY 1200u
#define SURVEY_SAMPLE 300u

/* What a unit sends from start to stop. */
typedef struct {
    uint16_t set_chz;
    survey_reply_t reply;
    uint64_t start_us;
    uint64_t first_us;  /* When the measurement of the first packet began. */
    uint64_t stop_us;   /* When the stop command was sent. */
    uint64_t last_us;   /* When the last byte came. */
    uint64_t steady_us; /* When the motor has certainly reached its speed. */
    uint32_t packets, start_packets, lone_packets;
    uint32_t last_crc_bytes, confirmed, refuted, last_crcs_aa, damages;
    uint32_t samples, flagged;
    bool has_ct, begins_with_start;
    uint8_t longest;
    uint32_t until_start_q6; /* The angle from the first packet to the first start packet. */
    uint16_t first_q6;
    uint16_t start_q6;    /* The first start packet's angle at full speed. */
    int32_t start_sum_q6; /* The sum of the other start packets' differences from it. */
    uint32_t turns;       /* Turns at full speed, their samples and the sum of the frequencies that
                           * they reported. */
    uint32_t turn_samples, turn_reported_dhz;
    uint32_t steady_samples; /* All samples at full speed, and the end of that time. */
    uint64_t steady_end_us;
    uint32_t before_error, after_error; /* How far the reported frequency is from that of the turn
                                         * before and after it. */
    uint32_t now_samples, before_samples, reported_dhz; /* 0 for a turn with a gap. */
    bool is_damaged;                                    /* This turn has a gap. */
    uint8_t crc, latest_count, latest_is_point;
    uint32_t early_count;
    struct {
        uint32_t us; /* Since first_us. */
        uint16_t chz;
    } early[SURVEY_EARLY];
    tmini_ct_info_t ct;
    tmini_ring_t ring;
    tmini_decoder_t decoder;
    uint8_t memory[4096];
    size_t sample_count; /* The first bytes, for a unit of which nothing can be decoded. */
    uint8_t sample[SURVEY_SAMPLE];
} survey_scan_t;

enum { SURVEY_SLOW, SURVEY_MEDIUM, SURVEY_FAST, SURVEY_SCANS };

typedef enum {
    SURVEY_UNKNOWN,
    SURVEY_STEPS_OBEYED,
    SURVEY_STEPS_REFUSED,
    SURVEY_STEPS_OTHER,
} survey_steps_t;

typedef struct {
    const survey_wire_t *wire;
    survey_reply_t info, health, frequency, stop;
    uint32_t frequency_chz; /* At the beginning; here and below, 0 means not reported. */
    uint32_t min_chz, max_chz;
    survey_steps_t steps;
    uint32_t boot_ms;
    uint32_t unasked_bytes; /* Bytes that the unit sends while it boots. */
    uint32_t changed_chz;   /* The frequency set before the reboot. */
    uint32_t kept_chz;      /* The frequency after the reboot. */
    survey_scan_t scans[SURVEY_SCANS];
} survey_t;

#define SURVEY_SECONDS 40u
#define SURVEY_SECONDS_MIN 10u

/* Tests everything. Scans for `seconds` at 6 Hz, and for at most 15 s each at 10 and 12 Hz. Returns
 * false if the wire has failed, or nothing was answered. The unit is left idle, at the frequency
 * that it had. */
bool survey_run(survey_t *survey, const survey_wire_t *wire, uint32_t seconds);

/* Stops the unit and gives it back the frequency that it had, also after survey_run() was
 * interrupted: then `is_over` must be false again. */
void survey_restore(survey_t *survey);

/* The first bytes of a reply's content; NULL if it is not of this type and size. */
const uint8_t *survey_content(const survey_reply_t *reply, uint8_t type, size_t size);

/* ---- survey_scan.c ---- */

void survey_scan_begin(survey_scan_t *scan, uint16_t set_chz, uint64_t now_us);
void survey_scan_feed(survey_scan_t *scan, const uint8_t *bytes, size_t count, uint64_t now_us);

/* The frequency in 0.01 Hz, computed from the samples of whole turns; 0: there are none. */
uint32_t survey_scan_measured_chz(const survey_scan_t *scan);

/* ---- survey_table.c ---- */

/* Prints a line per statement: whether the unit behaves as expected. */
void survey_print_table(const survey_t *survey, FILE *file, const char *before);

/* Prints the table as comments, and the results as `key = value`; the serial number only if
 * `with_serial`. */
void survey_print_report(const survey_t *survey, FILE *file, bool with_serial);

#endif
