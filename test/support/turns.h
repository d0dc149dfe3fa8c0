/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A lidar that turns at 6.08 Hz, packet by packet as real units send them (section 9.6), before a
 * driver on a port that notes what is written. A turn is a start packet at 0 degrees, 16 packets of
 * 40 samples, one of 11 and one of 6, 35/64 degree from sample to sample; a packet of 40 takes 10
 * ms. All samples of a turn have the same distance, so that a scan shows which turns it is of. */

#ifndef TURNS_H
#define TURNS_H

#include "encoder.h"

#include "tmini/tmini.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TURNS_PACKETS 19u /* Of a turn. */
#define TURNS_POINTS 658u /* Likewise. */
#define TURNS_STEP_Q6 35u /* From sample to sample. */
#define TURNS_RX_MAX 8192u
#define TURNS_PACKET_MAX 130u

typedef struct {
    tmini_t lidar;
    tmini_config_t config;
    uint32_t now_ms;
    uint8_t written[64]; /* The codes of the commands sent, in order, */
    unsigned writes;     /* and how many there were. */
    uint8_t rx[TURNS_RX_MAX];
    tmini_point_t points[800];
    size_t dma_position;
    bool ct_information; /* Of packets and of LastCRC. */
    uint8_t crc;
} turns_t;

extern turns_t turns;

/* A driver with a ring of this size, not yet started. */
void turns_open(size_t rx_size, bool dma);

/* The same, scanning: of the current turn only the last packet has come. */
void turns_open_scanning(size_t rx_size, bool dma);

/* Bytes come. */
void turns_feed(const uint8_t *bytes, size_t count);

/* Puts the packet with this index of a turn to `out`; returns its size. With CT information,
 * LastCRC is before the start packet. */
size_t turns_packet(uint8_t *out, unsigned index, uint16_t distance_mm);

/* The packets from `first` to `last` come, at the pace of the lidar. */
void turns_feed_packets(unsigned first, unsigned last, uint16_t distance_mm);

/* The same, and each is polled for as it comes; returns a bit for each event. */
unsigned turns_pass(unsigned first, unsigned last, uint16_t distance_mm);

/* Polls until nothing is left; returns a bit for each event. The scans delivered meanwhile are
 * looked at: */
unsigned turns_poll(void);

typedef struct {
    unsigned count;    /* Scans delivered so far, */
    unsigned mixed;    /* with points of two turns, */
    unsigned complete; /* and complete ones. */
    tmini_scan_t last; /* Its points may have gone. */
} turns_scans_t;

extern turns_scans_t turns_scans;

#endif
