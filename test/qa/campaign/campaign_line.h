/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The bytes that the lidar sends in one trial: some revolutions, with the arrival time of each
 * byte, and with parts that never arrive.
 *
 * The simulated lidar marks its samples, and the judge notes them. */

#ifndef CAMPAIGN_LINE_H
#define CAMPAIGN_LINE_H

#include "sim_judge.h"

#define LINE_REVOLUTIONS 20u
#define LINE_BYTES (LINE_REVOLUTIONS * 6000u)
#define LINE_PACKETS (LINE_REVOLUTIONS * 200u)
#define LINE_CUTS 4u

/* The largest packet that the library accepts. */
#define LINE_MAX_SAMPLES 80u

typedef struct {
    uint32_t frequency_chz;
    uint32_t start_angle_q6; /* Angle of the start packets (section 9.8). */
    uint32_t revolutions;    /* At most LINE_REVOLUTIONS; the first one is not whole. */
    bool ct_information;     /* Also LastCRC (section 7); false: neither (section 9.1). */
    bool spins_up;           /* The speed begins at 2.4 Hz. */
} line_config_t;

typedef struct {
    uint32_t from; /* Index of its first byte; a LastCRC is before this. */
    uint32_t to;
    uint32_t sent_us;   /* Time at which its last byte has arrived. */
    uint32_t first;     /* Place of its first sample (sim_judge.h). */
    uint16_t samples;   /* Number of its samples. */
    uint16_t missing;   /* Number of its bytes that have not reached the library. */
    uint64_t turned_q6; /* Angle of its first sample, counted from the beginning. */
    uint64_t ends_q6;   /* The same for its last sample. */
    uint16_t revolution;
    bool is_start;
} line_packet_t;

typedef struct {
    line_config_t config;
    sim_t lidar;
    sim_judge_t judge;
    uint64_t turned_q6; /* Since the beginning, and the latest angle. */
    uint16_t last_q6;

    uint8_t bytes[LINE_BYTES];
    uint32_t at_us[LINE_BYTES]; /* Time since the start command. */
    uint16_t owner[LINE_BYTES]; /* The byte's packet; LastCRC's is the one after it. */
    bool is_guard[LINE_BYTES];  /* True for LastCRC. */
    bool lost[LINE_BYTES];
    uint32_t size;

    line_packet_t packets[LINE_PACKETS];
    uint32_t packet_count;

    uint16_t counts[LINE_REVOLUTIONS]; /* Number of samples of each revolution. */
    bool touched[LINE_REVOLUTIONS];    /* A byte of it, or of the next start packet, is lost. */
} line_t;

/* Makes the reply to the start command, and the revolutions. */
void line_make(line_t *line, const line_config_t *config, random_t *random);

/* The bytes from `from` up to `to` do not reach the library: marks their revolutions. */
void line_lose(line_t *line, uint32_t from, uint32_t to);

/* Makes a few holes of up to five turns, sometimes two close together. Holes begin and end at any
 * byte, but often have nearly a whole number of turns, by angle or by time. Sometimes some bytes of
 * each packet in it arrive, or only a start packet is lost. The bytes on both sides never look like
 * a packet: one pair in 65536 would, and no receiver could notice that. */
void line_interrupt(line_t *line, random_t *random);

#endif
