/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: when each point of a scan was measured, in integers, and the library's integers as
 * floats in degrees, radians, hertz and metres. The only place with floats; nothing else includes
 * it, and it needs neither a C library nor an FPU. All functions: any context; no waiting.
 *
 * How well it is known: a scan's start_ms and end_ms are when its start packet and the next one
 * came, less what the bytes after them took on the line. Compared with when their samples were
 * measured they are late, by up to 6 ms at polls every 1 ms (a start packet waits until the packet
 * before it has been sent), 11 ms at 10 and 38 (where packets are lost, 12 and 22), and by the time
 * that bytes waited where nothing counts them (a UART's FIFO, a task's queue, a USB adapter: some
 * milliseconds). From point to point of a scan, or of a part of one, times are good to 1.5 ms at 6
 * Hz and 1 ms at 12 Hz, however rare the polls: the rotor turns evenly, and the clock is not
 * asked. */

#ifndef TMINI_UNITS_H
#define TMINI_UNITS_H

#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How long the revolution took, in milliseconds: of a complete scan by its number of samples, 4000
 * in a second (section 1), where that agrees with the reported frequency; else by that, which has
 * steps of 0.1 Hz. The clock is not asked. 0 if neither is known. */
uint32_t tmini_scan_period_ms(const tmini_scan_t *scan);

/** When point `index` (below scan->count) was measured, in microseconds after the scan's first
 * point: by its angle, however the scan is mounted; or, when the period is not known, by its place
 * at 4000 samples a second (section 1). Two divisions, and a look at each point between it and the
 * last one before it that is 4 degrees from the first: at most some twenty in a true scan. */
uint32_t tmini_point_time_us(const tmini_scan_t *scan, size_t index);

/** The circle's constant, as a float. */
#define TMINI_PI 3.14159265358979f

/** An angle of the lidar, clockwise from its front, in degrees: 0 to 359.98. Exact. */
static inline float tmini_degrees(uint16_t angle_q6)
{
    return (float)angle_q6 / 64.0f;
}

/** An angle of the lidar in radians, still clockwise: 0 to 2 pi. */
static inline float tmini_radians(uint16_t angle_q6)
{
    return (float)angle_q6 * (2.0f * TMINI_PI / (float)TMINI_FULL_CIRCLE_Q6);
}

/** An angle of the lidar as ROS counts: counter-clockwise from straight ahead, in radians, -pi to
 * pi. Then x = range * cos(angle) points ahead and y = range * sin(angle) to the left. */
static inline float tmini_ros_radians(uint16_t angle_q6)
{
    const uint16_t half = (uint16_t)(TMINI_FULL_CIRCLE_Q6 / 2u);
    return angle_q6 <= half ? -tmini_radians(angle_q6)
                            : tmini_radians((uint16_t)(TMINI_FULL_CIRCLE_Q6 - angle_q6));
}

/** A frequency of the library, in 0.01 Hz, in hertz. */
static inline float tmini_hertz(uint16_t frequency_chz)
{
    return (float)frequency_chz / 100.0f;
}

/** A distance of the library, in millimetres, in metres. 0 stays 0: no valid range. */
static inline float tmini_metres(uint16_t distance_mm)
{
    return (float)distance_mm / 1000.0f;
}

/** For ranges from tmini_ranges.h: the angle of bin 0 in radians; a LaserScan's angle_min. */
static inline float tmini_ranges_angle_min(void)
{
    return -TMINI_PI;
}

/** For ranges from tmini_ranges.h: the angle from bin to bin in radians, of `count` bins (not 0); a
 * LaserScan's angle_increment. */
static inline float tmini_ranges_increment(size_t count)
{
    return 2.0f * TMINI_PI / (float)count;
}

/** A LaserScan's scan_time, in seconds; 0 if it is not known. */
static inline float tmini_ranges_scan_time(const tmini_scan_t *scan)
{
    return (float)tmini_scan_period_ms(scan) / 1000.0f;
}

/** A LaserScan's time_increment, in seconds from bin to bin: negative, because the bins run
 * counter-clockwise and the rotor clockwise. Of a scan that begins at 0 degrees bin 0, behind the
 * lidar, is measured half a period after the scan's start_ms, bin count / 2 at its beginning; the
 * bins beyond, on the left, a period later than this says: at its end. */
static inline float tmini_ranges_time_increment(const tmini_scan_t *scan, size_t count)
{
    return -tmini_ranges_scan_time(scan) / (float)count;
}

/** A LaserScan's range_min, in metres (section 1). */
static inline float tmini_range_min(void)
{
    return (float)TMINI_RANGE_MIN_MM / 1000.0f;
}

/** A LaserScan's range_max, in metres (section 1). */
static inline float tmini_range_max(void)
{
    return (float)TMINI_RANGE_MAX_MM / 1000.0f;
}

/** Writes `count` ranges in metres to `ranges_m`; where nothing was measured, `missing`: in ROS
 * INFINITY or NAN. */
static inline void tmini_ranges_metres(const uint16_t *ranges_mm, size_t count, float missing,
                                       float *ranges_m)
{
    for (size_t i = 0; i < count; i++) {
        ranges_m[i] = ranges_mm[i] != 0 ? tmini_metres(ranges_mm[i]) : missing;
    }
}

#ifdef __cplusplus
}
#endif

#endif
