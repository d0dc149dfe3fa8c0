/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* For the driver's unit tests: a driver on a port that records what is sent, with a clock that the
 * test sets, and bytes from the independent encoder. Tests tell it what to do in words (tale.h). */

#ifndef RIG_H
#define RIG_H

#include "encoder.h"
#include "tmini/tmini.h"

#include "unity.h"

#define RIG_RX_SIZE 256
#define RIG_POINTS 60
#define RIG_SENT_MAX 16

typedef struct {
    tmini_t lidar;
    tmini_config_t config;
    tmini_timing_t timing; /* The default, except that pauses of the line are not judged. */
    tmini_port_t port;
    uint32_t now_ms;            /* Time of the port's clock. */
    uint8_t sent[RIG_SENT_MAX]; /* Bytes that the port has taken. */
    unsigned sent_count;
    int takes; /* How many bytes the port takes per call. */
    uint32_t port_restarts;
    uint8_t rx[RIG_RX_SIZE];
    size_t position; /* How many bytes DMA has written. */
    tmini_point_t points[RIG_POINTS];
    uint8_t crc;  /* Of the turn fed last. */
    bool in_turn; /* A turn with CT information has begun. */
} rig_t;

extern rig_t rig;

/* A clock at 1000 ms, a configuration with a scan buffer; the lidar is set up. */
void rig_open(void);

/* Sets the lidar up again, with rig.config as it is now. */
void rig_init(void);

/* ---- Bytes from the lidar ---- */

/* By the receive interrupt, byte by byte or as a block, or by DMA if it is configured. */
void rig_feed(const uint8_t *bytes, size_t count);
void rig_feed_byte(uint8_t byte);

void rig_feed_scan_reply(void);
void rig_feed_info(void); /* T-mini Plus, firmware 1.2, hardware 1. */
void rig_feed_health(uint8_t status, uint16_t error_code);
void rig_feed_frequency(uint32_t frequency_chz);

/* A packet of `lsn` samples, all of this distance, half a degree apart from 10 degrees on. */
void rig_feed_packet(uint8_t ct, uint8_t lsn, uint16_t distance_mm);
void rig_feed_start_packet(uint16_t distance_mm); /* 6.0 Hz. */
void rig_feed_point_packet(uint16_t distance_mm); /* 4 samples. */

/* A start packet and four point packets, as from a unit without CT information. */
void rig_feed_plain_turn(uint16_t distance_mm);

/* The same from a unit with CT information that reports this health. The LastCRC of the turn before
 * comes first: that turn is now complete, and is judged. */
void rig_feed_turn(uint8_t health, uint16_t distance_mm);

#endif
