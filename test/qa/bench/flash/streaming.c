/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program that streams without a scan buffer: an event for each packet, and its points. */

#include "board.h"

static uint8_t rx[512];
static tmini_point_t points[TMINI_MAX_SAMPLES_DEFAULT];

void bench_main(void)
{
    const tmini_config_t config = {.port = &board, .rx_buffer = rx, .rx_size = sizeof rx};
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        return;
    }
    (void)tmini_start(&lidar);
    for (;;) {
        if (tmini_poll(&lidar) == TMINI_EVENT_PACKET) {
            (void)tmini_packet_points(tmini_packet(&lidar), TMINI_FILTER_NONE, points,
                                      TMINI_MAX_SAMPLES_DEFAULT);
        }
    }
}
