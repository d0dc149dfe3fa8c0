/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a simulated lidar has sent, sample by sample, and whether the points of a scan are that:
 * each as it was sent, in order, none in two scans, none of another turn, none missing unreported.
 * Every test that compares scans with what was sent asks it. It includes nothing of lib/.
 *
 * Points are found by their values, so the lidar should be marked (sim_config_t). */

#ifndef SIM_JUDGE_H
#define SIM_JUDGE_H

#include "reference_decoder.h"
#include "simulator.h"

#define SIM_JUDGE_SAMPLES 131072u /* The latest ones are kept: 32 s. */

typedef struct {
    reference_point_t point;
    uint8_t seen; /* In how many scans. */
    bool starts;  /* It is a start packet's. */
    bool is_of_partial;
    uint32_t turn;
} sim_sample_t;

/* A sample's place is its number among all that were sent. */
typedef struct {
    sim_sample_t samples[SIM_JUDGE_SAMPLES];
    uint32_t sent;         /* Number of samples. */
    uint32_t next;         /* After the last one that was found. */
    bool begun_in_partial; /* The last start packet that was found began a partial turn. */
    bool is_guarded;       /* LastCRC comes before each start packet, undamaged (section 7). */
} sim_judge_t;

/* How a scan deceives: bits. */
typedef enum {
    SIM_LIE_INVENTED,   /* A point was never sent. */
    SIM_LIE_MIXED,      /* It has points of two turns. */
    SIM_LIE_DISORDERED, /* A point is not later than the one before it. */
    SIM_LIE_AGAIN,      /* A point was already in an earlier scan. */
    SIM_LIE_COMPLETE,   /* It is called complete, and points are missing. */
    SIM_LIE_SILENT,     /* Points are missing, and neither gaps nor dropped points are reported. */
    SIM_LIES
} sim_lie_t;

#define SIM_LIE(lie) (1u << (lie))

/* The points of one scan, as far as they have been read. Begins as {0}. */
typedef struct {
    uint32_t points;
    uint32_t first;     /* The place of the first point, */
    uint32_t last;      /* of the latest, */
    uint32_t odd;       /* of the first one of another turn or out of order, */
    uint32_t before;    /* and of the one before that. */
    uint32_t missing;   /* Samples; at the beginning any number counts as one. */
    uint32_t widest_q6; /* The widest hole that these left. */
    unsigned lies;
    bool is_hidden; /* Something is missing, and nothing can show it. */
} sim_reading_t;

void sim_judge_begin(sim_judge_t *judge);

/* The lidar has sent this packet. Returns the place of its first sample. */
uint32_t sim_judge_sent(sim_judge_t *judge, const sim_packet_t *packet);

/* The scan's next point. */
void sim_read_point(sim_judge_t *judge, sim_reading_t *reading, reference_point_t point);

/* The scan has no more points, and reports this. Returns its lies. */
unsigned sim_read_end(const sim_judge_t *judge, sim_reading_t *reading, bool complete,
                      unsigned gaps, unsigned dropped);

const sim_sample_t *sim_judge_sample(const sim_judge_t *judge, uint32_t place);

/* How many of these samples are in exactly one scan. */
uint32_t sim_judge_in_one(const sim_judge_t *judge, uint32_t place, uint32_t count);

/* Whether all packets that the reference decoder finds in these bytes were sent so. If not, damage
 * has left a checksum right, and nothing can show that. */
bool sim_judge_knows(const sim_judge_t *judge, const uint8_t *bytes, size_t count);

const char *sim_lie_name(sim_lie_t lie);

#endif
