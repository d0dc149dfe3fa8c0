/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tape.h"
#include "tmini/tmini.h"
#include "tmini/tmini_mount.h"
#include "tmini/tmini_sectors.h"
#include "tmini/tmini_units.h"
#include "tmini_laser.h"
#include "witness.h"
#include "tmini_timed.h"

static void point_times_us(const tmini_scan_t *scan, uint32_t *times_us)
{
    for (size_t i = 0; i < scan->count; i++) {
        times_us[i] = tmini_point_time_us(scan, i);
    }
}

/* At the end of the recording, the last scan may be only a part. */
static int tape_next_scan(tape_t *tape)
{
    tape_next_t next = TAPE_PACKET;
    while (next == TAPE_PACKET) {
        next = tape_next(tape);
    }
    return next == TAPE_END && stream_end(&tape->stream) ? TAPE_SCAN : next;
}
