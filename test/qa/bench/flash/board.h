/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A board that does nothing: these programs are linked and measured, but never run. */

#ifndef BOARD_H
#define BOARD_H

#include "tmini/tmini.h"

static tmini_t lidar;

static int board_write(void *context, const uint8_t *bytes, size_t count)
{
    (void)context, (void)bytes;
    return (int)count;
}

static uint32_t board_now_ms(void *context)
{
    (void)context;
    return 0;
}

static const tmini_port_t board = {.write = board_write, .now_ms = board_now_ms};

void bench_interrupt(uint8_t byte)
{
    tmini_feed_byte(&lidar, byte);
}

#endif
