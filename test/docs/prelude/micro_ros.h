/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the code in examples/micro_ros/README.md needs: a lidar that has been set up. */

#include "board.h"
#include "scan_node.h"

extern tmini_t lidar;
extern const tmini_config_t config;
