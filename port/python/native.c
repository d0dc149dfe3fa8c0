/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_builder.h"
#include "tmini/parts/tmini_ct.h"
#include "tmini/parts/tmini_parser.h"
#include "tmini/tmini.h"
#include "tmini/tmini_mount.h"
#include "tmini/tmini_units.h"

static void point_times_us(const tmini_scan_t *scan, uint32_t *times_us)
{
    for (size_t i = 0; i < scan->count; i++) {
        times_us[i] = tmini_point_time_us(scan, i);
    }
}
