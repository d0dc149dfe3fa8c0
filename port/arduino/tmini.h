/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * The library by its name, which is what Arduino looks for. */

#ifndef TMINI_ARDUINO_H
#define TMINI_ARDUINO_H

#include "TMiniLidar.h"

#endif
