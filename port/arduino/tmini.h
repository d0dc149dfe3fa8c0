/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * A header with the library's name, because Arduino looks for one. */

#ifndef TMINI_ARDUINO_H
#define TMINI_ARDUINO_H

#include "TMiniLidar.h"

#endif
