/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Compares scans with what the simulated lidar has sent (sim_judge.h). */

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

/* The scan has nothing but points of one revolution, in this order and in no other scan. Some may
 * be missing, if it says so. */
void truth_assert_nothing_invented(const tmini_scan_t *scan);

#endif
