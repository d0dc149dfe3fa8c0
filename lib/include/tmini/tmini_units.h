/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * Optional: the time at which each point of a scan was measured, in integers; and conversions to
 * floats in degrees, radians, hertz and metres. Floats occur only here. No other header includes
 * this one, and it needs neither a C library nor an FPU. All functions: any context; no waiting.
 *
 * Accuracy. start_ms and end_ms are the arrival times of a scan's start packet and of the next one,
 * corrected for the bytes that came after them. They are later than the measurement: by up to 8 ms
 * if you poll every 1 ms (a start packet waits until the packet before it has been sent), and by up
 * to 11 ms if you poll every 10 or 38 ms (where packets are lost, 13 and 24 ms). Add the time that
 * bytes wait in a UART's FIFO, a task's queue or a USB adapter, or in memory before DMA's position
 * is published: some milliseconds.
 * Within a scan, or a part of one, the times of points are accurate to 1.5 ms at 6 Hz and 1 ms at
 * 12 Hz by the lidar's clock, however rare the polls, because they follow the rotor's even turning
 * and not the port's clock. If the two clocks differ by 3 %, add 3 %: 5 ms at the end of a turn at
 * 6 Hz. */

#ifndef TMINI_UNITS_H
#define TMINI_UNITS_H

#include <stddef.h>
#include <stdint.h>

#include "tmini_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The duration of the revolution, in milliseconds; 0: unknown. For a complete scan it follows from
 * the number of samples, at 4000 per second (section 1), if that agrees with the reported
 * frequency. Otherwise it follows from the reported frequency, which has steps of 0.1 Hz. The clock
 * is not used. */
uint32_t tmini_scan_period_ms(const tmini_scan_t *scan);

/** When point `index` (below scan->count) was measured, in microseconds after the scan's first
 * point. It follows from the point's angle, also in a scan that was turned over; if the period is
 * unknown, from its index at 4000 samples per second (section 1). Two divisions. For a point within
 * 4 degrees of the first one it also searches back for a point that is farther away: at most about
 * twenty steps in a real scan. */
uint32_t tmini_point_time_us(const tmini_scan_t *scan, size_t index);

/** Pi, as a float. */
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

/** An angle of the lidar in the ROS convention: counter-clockwise from straight ahead, in radians,
 * -pi to pi. Then x = range * cos(angle) points ahead, and y = range * sin(angle) to the left. */
static inline float tmini_ros_radians(uint16_t angle_q6)
{
    const uint16_t half = (uint16_t)(TMINI_FULL_CIRCLE_Q6 / 2u);
    return angle_q6 <= half ? -tmini_radians(angle_q6)
                            : tmini_radians((uint16_t)(TMINI_FULL_CIRCLE_Q6 - angle_q6));
}

/** Converts a frequency from 0.01 Hz to hertz. */
static inline float tmini_hertz(uint16_t frequency_chz)
{
    return (float)frequency_chz / 100.0f;
}

/** Converts a distance from millimetres to metres. 0 stays 0: no valid range. */
static inline float tmini_metres(uint16_t distance_mm)
{
    return (float)distance_mm / 1000.0f;
}

/** For ranges from tmini_ranges.h: the angle of bin 0 in radians; a LaserScan's angle_min. */
static inline float tmini_ranges_angle_min(void)
{
    return -TMINI_PI;
}

/** For ranges from tmini_ranges.h: the angle from bin to bin in radians, for `count` bins (not 0);
 * a LaserScan's angle_increment. */
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
 * counter-clockwise and the rotor clockwise. In a scan that begins at 0 degrees, bin count / 2
 * (ahead) is measured first, and bin 0 (behind the lidar) half a period later. The bins above count
 * / 2 (on the left) are measured last: one period later than this increment gives for them. `count`
 * is not 0. */
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

/** Writes `count` ranges in metres to `ranges_m`; where nothing was measured it writes `missing`,
 * which is INFINITY or NAN in ROS. */
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
