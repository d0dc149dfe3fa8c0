/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program that only decodes: examples/decoder_only. */

#include "../../../../examples/decoder_only/lidar_points.c"

static volatile size_t points_seen;

void bench_main(void)
{
    lidar_points_init();
    for (;;) {
        const tmini_scan_t *const scan = lidar_points_next(0);
        if (scan != NULL) {
            points_seen = scan->count;
        }
    }
}

void bench_interrupt(uint8_t byte)
{
    lidar_points_byte(byte);
}
