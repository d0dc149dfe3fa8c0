/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Obstacles for a flight controller or a rover: HEARTBEAT once per second, and after each scan, at
 * most ten times per second, OBSTACLE_DISTANCE: 72 sectors of 5 degrees, clockwise, the first one
 * centred on the front. In centimetres; 65535 where nothing is known, 1201 where the nearest thing
 * is beyond 12 m. No function waits. */

#ifndef PROXIMITY_H
#define PROXIMITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini_sectors.h"

#define PROXIMITY_SECTORS 72u
#define PROXIMITY_MESSAGE_MAX 280u

/* Sends some of the bytes to the flight controller and returns how many, 0 if its UART is busy. */
typedef int (*proximity_write_t)(void *context, const uint8_t *bytes, size_t count);

typedef struct {
    proximity_write_t write;
    void *context;
    uint8_t system_id; /* The vehicle's: SYSID_THISMAV, MAV_SYS_ID. */
    bool has_news;     /* The sectors have not been sent. */
    uint32_t seen_ms;
    uint32_t sent_ms;
    uint32_t heartbeat_ms;
    size_t length; /* Of the message in `bytes`. */
    size_t taken;  /* How many of them the UART has taken. */
    uint8_t bytes[PROXIMITY_MESSAGE_MAX];
    tmini_sectors_t sectors;
    tmini_sector_t memory[PROXIMITY_SECTORS];
} proximity_t;

void proximity_init(proximity_t *proximity, proximity_write_t write, void *context,
                    uint8_t system_id);

/* Takes a scan, complete or not: what is missing in it is unknown. Leave scans out while
 * tmini_faults() is not 0: without messages for half a second the flight controller knows that it
 * has no sensor. */
void proximity_see(proximity_t *proximity, const tmini_scan_t *scan);

/* Sends what is due. Call it as often as tmini_poll(). `now_ms`: the clock of the driver's port. */
void proximity_poll(proximity_t *proximity, uint32_t now_ms);

#endif
