/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the lidar sends during one trial of the campaign: some revolutions as bytes, each with the
 * time at which its last bit is on the wire, and parts of them that never arrive.
 *
 * Every sample's distance, intensity and flag encode its revolution and its index within it. So
 * each point shows whether it was sent, where it belongs and what its angle is. Made with
 * test/support/encoder.c, from the protocol's document; shares no code with the library. */

#ifndef CAMPAIGN_LINE_H
#define CAMPAIGN_LINE_H

#include "random.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LINE_REVOLUTIONS 20u
#define LINE_SAMPLES 2048u /* Of one revolution, at most: 2.4 Hz have 1667. */
#define LINE_BYTES (LINE_REVOLUTIONS * 6000u)
#define LINE_PACKETS (LINE_REVOLUTIONS * 200u)
#define LINE_CUTS 4u

/* The largest packet that a receiver of up to 80 samples tries. */
#define LINE_MAX_SAMPLES 80u

typedef struct {
    uint32_t frequency_chz;
    uint32_t start_angle_q6; /* Where the start packets are (section 9.8). */
    uint32_t revolutions;    /* At most LINE_REVOLUTIONS; only the first is not whole. */
    bool ct_information;     /* With LastCRC (section 7), or neither (section 9.1). */
    bool spins_up;           /* Begins at 2.4 Hz. */
} line_config_t;

typedef struct {
    uint32_t from; /* Its first byte; LastCRC, if it has one, is before it. */
    uint32_t to;
    uint32_t sent_us;   /* When its last byte was on the wire. */
    uint16_t first;     /* Its first sample, of those of its revolution, */
    uint16_t samples;   /* and how many it has. */
    uint16_t missing;   /* Bytes that the library has not got. */
    uint64_t turned_q6; /* Of its first sample, since the beginning. */
    uint64_t ends_q6;   /* Of its last one. */
    uint16_t revolution;
    bool is_start;
} line_packet_t;

typedef struct {
    line_config_t config;
    uint32_t key; /* Of this trial's marks. */

    uint8_t bytes[LINE_BYTES];
    uint32_t at_us[LINE_BYTES]; /* Since the start command. */
    uint16_t owner[LINE_BYTES]; /* The packet that it is of, or before: */
    bool is_guard[LINE_BYTES];  /* LastCRC. */
    bool lost[LINE_BYTES];
    uint32_t size;

    line_packet_t packets[LINE_PACKETS];
    uint32_t packet_count;

    uint16_t counts[LINE_REVOLUTIONS]; /* Samples of each revolution. */
    uint16_t angles_q6[LINE_REVOLUTIONS][LINE_SAMPLES];
    bool touched[LINE_REVOLUTIONS]; /* Not all of it has come, or not the start packet after it. */
} line_t;

/* What a point was sent as. */
typedef struct {
    uint32_t revolution;
    uint32_t sample;
} line_mark_t;

/* The revolutions, beginning with the reply to the start command. */
void line_make(line_t *line, const line_config_t *config, random_t *random);

/* The bytes from `from` up to `to` do not reach the library: their revolutions are touched. */
void line_lose(line_t *line, uint32_t from, uint32_t to);

/* The line is silent for up to five turns, a few times, now and then twice in a row: from any byte
 * to any byte, often for nearly a whole number of turns, by angle or by time; or of each packet
 * some bytes come all the same; or it loses start packets only. What is left never happens to look
 * like a packet where two ends meet: one in 65536 would, and no receiver could tell it from a true
 * one. */
void line_interrupt(line_t *line, random_t *random);

/* Finds out what a point was sent as. Returns false if no such sample was sent. */
bool line_identify(const line_t *line, uint16_t distance_mm, uint8_t intensity, uint8_t flag,
                   line_mark_t *mark);

#endif
