/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* On a PC: decoder_only <RECORDING prints each scan of the lidar's bytes. */

#include "lidar_points.h"

#include <stdio.h>

#define BYTE_US 43.4 /* 230400 baud. */

static void print(const tmini_scan_t *scan)
{
    uint16_t nearest_mm = UINT16_MAX;
    double angle_deg = 0;
    for (size_t i = 0; i < scan->count; i++) {
        const tmini_point_t *const point = &scan->points[i];
        if (point->distance_mm > 0 && point->distance_mm < nearest_mm) {
            nearest_mm = point->distance_mm;
            angle_deg = point->angle_q6 / 64.0;
        }
    }
    printf("%u points, %s", (unsigned)scan->count, scan->complete ? "complete" : "incomplete");
    if (nearest_mm < UINT16_MAX) {
        printf(", nearest %u mm at %.2f degrees", (unsigned)nearest_mm, angle_deg);
    }
    printf("\n");
}

int main(void)
{
    double now_us = 0;
    int byte;

    lidar_points_init();
    while ((byte = getchar()) != EOF) { /* A microcontroller does this in its interrupt, */
        lidar_points_byte((uint8_t)byte);
        now_us += BYTE_US;
        const tmini_scan_t *scan; /* and this in its loop. */
        while ((scan = lidar_points_next((uint32_t)(now_us / 1000))) != NULL) {
            print(scan);
        }
    }
    return 0;
}
