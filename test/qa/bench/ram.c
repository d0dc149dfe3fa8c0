/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Has the size of the object that a user declares per lidar; read from the compiled file. */

#include "tmini/tmini.h"

extern char ram_tmini_t[sizeof(tmini_t)];

char ram_tmini_t[sizeof(tmini_t)];
