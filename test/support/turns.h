/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar that turns at 6.08 Hz and sends packets as real units do (section 9.6), and a driver on a
 * port that records the commands. A turn is a start packet at 0 degrees, 16 packets of 40 samples,
 * one of 11 and one of 6, 35/64 degree from sample to sample; a packet of 40 takes 10 ms. All
 * samples of a turn have the same distance, which shows from which turns a scan's points are. */

#ifndef TURNS_H
#define TURNS_H

#include "encoder.h"

#include "tmini/tmini.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TURNS_PACKETS 19u /* Per turn. */
#define TURNS_POINTS 658u /* Per turn. */
#define TURNS_STEP_Q6 35u /* From sample to sample. */
#define TURNS_RX_MAX 8192u
#define TURNS_PACKET_MAX 130u

typedef struct {
    tmini_t lidar;
    tmini_config_t config;
    uint32_t now_ms;
    uint8_t written[64]; /* The codes of the commands sent, in order. */
    unsigned writes;     /* How many commands were sent. */
    uint8_t rx[TURNS_RX_MAX];
    tmini_point_t points[800];
    size_t dma_position;
    bool ct_information; /* Send it in the packets, and LastCRC after each turn. */
    uint8_t crc;
} turns_t;

extern turns_t turns;

/* A driver with a ring of this size, not yet started. */
void turns_open(size_t rx_size, bool dma);

/* The same, scanning: only the last packet of the current turn has come. */
void turns_open_scanning(size_t rx_size, bool dma);

void turns_feed(const uint8_t *bytes, size_t count);

/* Writes the packet with this index in its turn to `out`; returns its size. With CT information,
 * LastCRC precedes the start packet. */
size_t turns_packet(uint8_t *out, unsigned index, uint16_t distance_mm);

/* Feeds the packets from `first` to `last`, at the pace of the lidar. */
void turns_feed_packets(unsigned first, unsigned last, uint16_t distance_mm);

/* The same, with polls after each packet; returns a bit for each event. */
unsigned turns_pass(unsigned first, unsigned last, uint16_t distance_mm);

/* Polls until nothing is left; returns a bit for each event. Counts the scans in turns_scans. */
unsigned turns_poll(void);

typedef struct {
    unsigned count;    /* All scans delivered so far. */
    unsigned mixed;    /* Those with points of several turns. */
    unsigned complete; /* Those that were complete. */
    tmini_scan_t last; /* Its points may be overwritten by now. */
} turns_scans_t;

extern turns_scans_t turns_scans;

#endif
