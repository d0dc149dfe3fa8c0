/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* PlatformIO compiles one folder, but the Arduino IDE needs a folder for each sketch: so this
 * includes the sketch. */

#include <Arduino.h>

#include SKETCH
