/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Directions in words. */

#ifndef DIRECTION_H
#define DIRECTION_H

#include <stdint.h>

/* "ahead", "ahead to the right", "right", … for an angle in 1/64 degree, clockwise from the front. */
const char *direction_name(uint16_t angle_q6);

#endif
