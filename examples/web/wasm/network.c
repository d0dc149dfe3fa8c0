/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A timed stream from a network. Times are JavaScript's: microseconds, as a double. */

#include "web.h"

#include <stdbool.h>
#include <string.h>

static tmini_timed_t stream;

EXPORTED void network_begin(void)
{
    tmini_timed_begin(&stream);
}

/* Takes the first of the `count` bytes in `transfer`; returns how many it took. */
EXPORTED uint32_t network_put(uint32_t count)
{
    size_t room = 0;
    uint8_t *const place = tmini_timed_room(&stream, &room);
    const size_t taken = count < room ? count : room;
    memcpy(place, web_transfer, taken);
    tmini_timed_put(&stream, taken);
    return (uint32_t)taken;
}

/* Copies the lidar's next bytes to `transfer`, and returns their number; or NETWORK_GAP. */
EXPORTED uint32_t network_take(double now_us)
{
    const uint8_t *bytes = NULL;
    bool is_gap = false;
    const size_t count =
        tmini_timed_take(&stream, (int64_t)now_us, WEB_TRANSFER_SIZE, &bytes, &is_gap);
    memcpy(web_transfer, bytes, count);
    return is_gap ? NETWORK_GAP : (uint32_t)count;
}

EXPORTED uint32_t network_now_ms(double now_us)
{
    return (uint32_t)(tmini_timed_now_us(&stream, (int64_t)now_us) / 1000);
}
