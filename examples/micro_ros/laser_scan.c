/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "laser_scan.h"

#include <math.h>
#include <string.h>

#include "tmini/tmini_units.h"

static const int64_t NS_PER_SECOND = 1000000000;

static void set_stamp(builtin_interfaces__msg__Time *stamp, int64_t ns)
{
    stamp->sec = (int32_t)(ns / NS_PER_SECOND);
    stamp->nanosec = (uint32_t)(ns % NS_PER_SECOND);
}

static void set_times(sensor_msgs__msg__LaserScan *message, uint16_t frequency_chz)
{
    /* If the lidar has not reported its frequency yet: 0, which means unknown in ROS. */
    message->scan_time = frequency_chz != 0 ? 1.0f / tmini_hertz(frequency_chz) : 0.0f;
    message->time_increment = -message->scan_time / (float)LASER_SCAN_RAYS;
}

/* The library's bin 0 is at the back, but the message's ray 0 is ahead. */
static void set_rays(laser_scan_memory_t *memory)
{
    for (size_t ray = 0; ray < LASER_SCAN_RAYS; ray++) {
        const size_t bin = (ray + LASER_SCAN_RAYS / 2u) % LASER_SCAN_RAYS;
        memory->ranges[ray] = memory->bins_mm[bin] != 0 ? tmini_metres(memory->bins_mm[bin]) : NAN;
        memory->intensities[ray] = (float)memory->bin_intensities[bin];
    }
}

void laser_scan_init(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     char *frame_id)
{
    const float increment = tmini_ranges_increment(LASER_SCAN_RAYS);
    memset(message, 0, sizeof *message);
    message->header.frame_id.data = frame_id;
    message->header.frame_id.size = strlen(frame_id);
    message->header.frame_id.capacity = strlen(frame_id) + 1;
    message->angle_min = 0.0f;
    message->angle_max = increment * (float)(LASER_SCAN_RAYS - 1u);
    message->angle_increment = increment;
    message->range_min = tmini_metres(TMINI_RANGE_MIN_MM);
    message->range_max = tmini_metres(TMINI_RANGE_MAX_MM);
    message->ranges.data = memory->ranges;
    message->ranges.size = LASER_SCAN_RAYS;
    message->ranges.capacity = LASER_SCAN_RAYS;
    message->intensities.data = memory->intensities;
    message->intensities.size = LASER_SCAN_RAYS;
    message->intensities.capacity = LASER_SCAN_RAYS;
}

bool laser_scan_fill(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     const tmini_scan_t *scan, int64_t end_ns)
{
    if (tmini_ranges_of_scan(scan, memory->bins_mm, memory->bin_intensities, LASER_SCAN_RAYS) !=
        TMINI_OK) {
        return false;
    }
    set_stamp(&message->header.stamp, end_ns);
    set_times(message, scan->frequency_chz);
    set_rays(memory);
    return true;
}
