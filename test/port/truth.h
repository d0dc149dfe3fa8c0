/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A record of the points that the simulated lidar has sent, to compare scans with. */

#ifndef TRUTH_H
#define TRUTH_H

#include <stdint.h>

#include "known_packets.h"
#include "simulator.h"
#include "tmini/tmini.h"

/* Tests split the manual's packet here. Only the port can notice a loss in between. */
#define PACKET_CUT 30u

/* Clears the record; returns the observer to give to the simulated lidar. */
sim_observer_t truth_begin(void);

uint32_t truth_packets(void);

/* The scan is complete and has exactly the points of this revolution. */
void truth_assert_revolution(const tmini_scan_t *scan, uint32_t revolution);

/* The scan is complete and has exactly the points of some later revolution. */
void truth_assert_some_revolution(const tmini_scan_t *scan);

/* All points were sent, in this order and later than the previous scan's. Some may be missing. */
void truth_assert_nothing_invented(const tmini_scan_t *scan);

#endif
