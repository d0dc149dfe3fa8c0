/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* One robot on the bed (test/system/bed.h), with fields, in a hall of 8 m by 8 m. Some points may
 * be random, as in dust or beside other lidars. */

#ifndef ROVER_H
#define ROVER_H

#include "bed.h"

#include "tmini/tmini_fields.h"
#include "tmini/tmini_steps.h"

typedef struct {
    uint16_t frequency_chz;
    unsigned random_percent; /* Points with a random distance, 50 to 12000 mm. */
    uint64_t seed;
} rover_config_t;

/* What stands in the hall. */
typedef struct {
    double wall_mm;   /* A wall across, this far ahead; 0: none. */
    double pillar_mm; /* A pillar at this distance; 0: none. */
    double pillar_wide_mm;
    double pillar_deg; /* Clockwise from ahead. */
} rover_hall_t;

extern random_t rover_random;

/* Sets up fields and driver, and starts the lidar. All of it stays the caller's. */
void rover_init(const rover_config_t *config, const tmini_fields_t *fields);

void rover_furnish(const rover_hall_t *hall);

/* A millisecond passes. Returns true if a scan has come. */
bool rover_pass(void);

/* By the driver's clock. */
uint32_t rover_now_ms(void);

#endif
