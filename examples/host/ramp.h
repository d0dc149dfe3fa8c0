/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Colours for intensities. */

#ifndef RAMP_H
#define RAMP_H

#include "sheet.h"

/* From blue for 0 over green to orange for 1; brighter means more, also without colour vision. */
paint_t ramp_colour(double share);

#endif
