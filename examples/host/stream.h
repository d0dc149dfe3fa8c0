/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar's packets, live or recorded, in the order in which they came: the scans that they make,
 * what they tell about the unit, and how much of the stream was damaged. */

#ifndef STREAM_H
#define STREAM_H

#include "tmini/tmini_ct.h"
#include "tmini/tmini_scan.h"

/* More points than any revolution has: 4000 a second at well below 1 Hz. */
#define STREAM_POINTS_MAX 8192

#define FAULTS_UNKNOWN TMINI_FAULTS_UNKNOWN

typedef struct {
    tmini_scan_t scan; /* The latest one, if there is one; its points stay until the next. */
    uint64_t number;   /* Its number: start packets up to and including its own. */
    uint64_t scans;    /* How many there have been, and how many of them were complete. */
    uint64_t complete;
    uint64_t packets;
    uint64_t start_packets;
    uint64_t points;
    uint64_t points_before; /* The first start packet. */
    uint64_t damaged;       /* Packets that must have been where damaged bytes were. */
    uint64_t stray_bytes;   /* Between packets, LastCRC not counted, */
    uint64_t guard_bytes;   /* of which (section 7) there were so many. */
    uint64_t confirmed;     /* Revolutions that LastCRC confirmed. */
    uint32_t packet_ms;     /* When the latest packet came. */
    uint32_t longest_ms;    /* The longest pause between two packets. */
    unsigned frequency_chz; /* As told last; 0: not yet. */
    unsigned faults;        /* A combination of tmini_fault_t, or FAULTS_UNKNOWN. */
    bool has_scan;          /* The latest packet has completed `scan`. */
    bool is_open;
    uint64_t open_number;
    tmini_ct_t ct;
    tmini_scan_builder_t builder;
    tmini_point_t building[STREAM_POINTS_MAX];
    tmini_point_t kept[STREAM_POINTS_MAX];
} stream_t;

void stream_init(stream_t *stream);

/* Takes the next packet, which came at that time. Returns true if it ends a scan: see `scan`. */
bool stream_take(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms);

/* Nothing more comes: what is there of a scan becomes `scan`, incomplete. Returns false if there is
 * nothing. */
bool stream_end(stream_t *stream);

/* The stream was interrupted: forgets the scan under way. */
void stream_break(stream_t *stream);

/* How many of a thousand packets were damaged. */
unsigned stream_damaged_permille(const stream_t *stream);

/* Whether the unit sends information within the stream: a revolution of it would have to be
 * whole. */
typedef enum { TELLS, TELLS_NOTHING, TELLS_UNKNOWN } telling_t;
telling_t stream_telling(const stream_t *stream);

#endif
