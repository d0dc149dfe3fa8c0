/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar's packets, live or recorded, in the order in which they came: builds their scans, and
 * collects what they report about the unit and how much of the stream was damaged. */

#ifndef STREAM_H
#define STREAM_H

#include "tmini/parts/tmini_decoder.h"
#include "tmini/tmini_mount.h"

/* More points than any revolution has: 4000 per second at well below 1 Hz. */
#define STREAM_POINTS_MAX 8192

/* 64 bits at least: a recording may be long. */
typedef unsigned long long count_t;

typedef struct {
    tmini_scan_t scan; /* The latest scan, if there is one; its points stay valid until the next. */
    count_t number;    /* Its number: start packets up to and including its own. */
    count_t scans;     /* All scans so far, and how many of them were complete. */
    count_t complete;
    count_t packets;
    count_t start_packets;
    count_t points;
    count_t points_before;      /* Points before the first start packet. */
    count_t damaged;            /* Estimated number of packets lost in damaged bytes. */
    count_t stray_bytes;        /* Bytes between packets, without LastCRC. */
    count_t last_crc_bytes;     /* LastCRC bytes (section 7). */
    count_t confirmed;          /* Revolutions that LastCRC confirmed. */
    uint32_t packet_ms;         /* When the latest packet came. */
    uint32_t sent_ms;           /* The same, as the scan builder was told: see `is_late`. */
    unsigned frequency_chz;     /* As reported last; 0: not yet. */
    bool has_scan;              /* The latest packet has completed `scan`. */
    bool is_broken;             /* The next packet does not follow the latest one. */
    bool is_in_doubt;           /* According to the driver, bytes may be missing before it. */
    bool is_late;               /* May be set: packets come late and many at once, by a network. */
    const tmini_mount_t *mount; /* NULL: none. */
    tmini_decoder_t decoder;    /* Its `packet` is the latest, its builder has the next scan. */
    tmini_point_t *spare;       /* The buffer for the scan after that. */
    tmini_point_t points_of[2][STREAM_POINTS_MAX];
} stream_t;

/* With a mount, scans and points are in the robot's directions. The mount must last as long as the
 * stream. */
void stream_init(stream_t *stream, const tmini_mount_t *mount);

/* Takes the next packet, which came at `now_ms`. Returns true if it ends a scan: see `scan`. */
bool stream_take(stream_t *stream, const tmini_packet_t *packet, uint32_t now_ms);

/* No more packets will come: an unfinished scan becomes `scan`, incomplete. Returns false if there
 * is none. */
bool stream_end(stream_t *stream);

/* The stream was interrupted: forgets the unfinished scan, and counts nothing until the next packet
 * as damage. */
void stream_break(stream_t *stream);

/* A combination of tmini_fault_t, or TMINI_FAULTS_UNKNOWN. */
unsigned stream_faults(const stream_t *stream);

/* How many of a thousand packets were damaged. */
unsigned stream_damaged_permille(const stream_t *stream);

/* True once it is known that the unit sends no information within the stream: a revolution arrived
 * whole, and there was none. */
bool stream_reports_nothing(const stream_t *stream);

#endif
