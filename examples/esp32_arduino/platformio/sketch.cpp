/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* PlatformIO looks for sketches in one folder only; the Arduino IDE wants each in its own. */

#include <Arduino.h>

#include SKETCH
