/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the simulated lidar has sent, to compare scans with: for tests of ports. */

#ifndef TRUTH_H
#define TRUTH_H

#include <stdint.h>

#include "known_packets.h"
#include "simulator.h"
#include "tmini/tmini.h"

/* Tests cut the manual's packet here, with a loss in between that only the port can notice. */
#define PACKET_CUT 30u

/* Forgets everything; returns what the simulated lidar is to be observed with. */
sim_observer_t truth_begin(void);

uint32_t truth_packets(void);

/* The scan is this revolution, complete: every point, and no other. */
void truth_assert_revolution(const tmini_scan_t *scan, uint32_t revolution);

/* The scan is complete, and is some one revolution as in truth_assert_revolution(). */
void truth_assert_some_revolution(const tmini_scan_t *scan);

/* Every point was sent, in this order, later than those of the scan before. Some may be missing. */
void truth_assert_nothing_invented(const tmini_scan_t *scan);

#endif
