/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "laser_scan.h"

#include <string.h>

static const int64_t NS_PER_SECOND = 1000000000;

static void set_stamp(builtin_interfaces__msg__Time *stamp, int64_t ns)
{
    stamp->sec = (int32_t)(ns / NS_PER_SECOND);
    stamp->nanosec = (uint32_t)(ns % NS_PER_SECOND);
}

static void use(rosidl_runtime_c__float__Sequence *sequence, float *data)
{
    sequence->data = data;
    sequence->size = LASER_SCAN_RAYS;
    sequence->capacity = LASER_SCAN_RAYS;
}

void laser_scan_init(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     char *frame_id)
{
    tmini_laser_config_t config = tmini_laser_default;
    config.rays = LASER_SCAN_RAYS;
    tmini_laser_init(&memory->laser, &config);
    memset(message, 0, sizeof *message);
    message->header.frame_id.data = frame_id;
    message->header.frame_id.size = strlen(frame_id);
    message->header.frame_id.capacity = strlen(frame_id) + 1;
    use(&message->ranges, memory->ranges);
    use(&message->intensities, memory->intensities);
}

bool laser_scan_fill(sensor_msgs__msg__LaserScan *message, laser_scan_memory_t *memory,
                     const tmini_scan_t *scan, int64_t end_ns)
{
    tmini_laser_fields_t fields;
    if (!tmini_laser_of_scan(&memory->laser, scan, memory->ranges, memory->intensities, &fields)) {
        return false;
    }
    set_stamp(&message->header.stamp, end_ns + (int64_t)fields.stamp_us * 1000);
    message->angle_min = fields.angle_min;
    message->angle_max = fields.angle_max;
    message->angle_increment = fields.angle_increment;
    message->time_increment = fields.time_increment;
    message->scan_time = fields.scan_time;
    message->range_min = fields.range_min;
    message->range_max = fields.range_max;
    return true;
}
