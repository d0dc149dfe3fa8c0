/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The library by its name: #include <tmini.h>. */

#ifndef TMINI_ARDUINO_H
#define TMINI_ARDUINO_H

#include "TMiniLidar.h"

#endif
