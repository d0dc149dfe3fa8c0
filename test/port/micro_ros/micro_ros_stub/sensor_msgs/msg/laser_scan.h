/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* LaserScan as ROS's generator declares it for C: with the same names, types and order. */

#ifndef SENSOR_MSGS_MSG_LASER_SCAN_H
#define SENSOR_MSGS_MSG_LASER_SCAN_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    int32_t sec;
    uint32_t nanosec;
} builtin_interfaces__msg__Time;

typedef struct {
    char *data;
    size_t size;     /* Without the terminating null. */
    size_t capacity; /* With the terminating null. */
} rosidl_runtime_c__String;

typedef struct {
    builtin_interfaces__msg__Time stamp;
    rosidl_runtime_c__String frame_id;
} std_msgs__msg__Header;

typedef struct {
    float *data;
    size_t size;
    size_t capacity;
} rosidl_runtime_c__float__Sequence;

typedef struct {
    std_msgs__msg__Header header;
    float angle_min;
    float angle_max;
    float angle_increment;
    float time_increment;
    float scan_time;
    float range_min;
    float range_max;
    rosidl_runtime_c__float__Sequence ranges;
    rosidl_runtime_c__float__Sequence intensities;
} sensor_msgs__msg__LaserScan;

typedef struct {
    const char *name;
} rosidl_message_type_support_t;

const rosidl_message_type_support_t *laser_scan_type_support(void);

#define ROSIDL_GET_MSG_TYPE_SUPPORT(package, folder, name) \
    ROSIDL_TYPE_SUPPORT_OF_##package##_##folder##_##name()
#define ROSIDL_TYPE_SUPPORT_OF_sensor_msgs_msg_LaserScan() laser_scan_type_support()

#endif
