/*
 * SPDX-License-Identifier: MIT
 * Copyright (c) 2026 The tmini authors
 *
 * Starts the installed port on a device that is not there.
 */
#include "tmini_posix.h"

static uint8_t rx[1024];
static tmini_t lidar;
static tmini_posix_t port;

int main(void)
{
    const tmini_config_t config = {
        .port = &tmini_posix_port, .port_context = &port, .rx_buffer = rx, .rx_size = sizeof rx};
    tmini_posix_init(&port, "/dev/no-lidar-here");
    if (tmini_init(&lidar, &config) != TMINI_OK) {
        return 1;
    }
    return tmini_posix_start(&port, &lidar) == TMINI_POSIX_OK;
}
