/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the code in port/README.md needs. */

#include "board.h"
#include "tmini_port_template.h"

extern void *const uart;
extern tmini_t lidar;
extern const tmini_config_t config;
