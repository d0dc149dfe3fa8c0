/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* An object as large as what a user declares per lidar; compiled, and its size read. */

#include "tmini/tmini.h"

extern char ram_tmini_t[sizeof(tmini_t)];

char ram_tmini_t[sizeof(tmini_t)];
