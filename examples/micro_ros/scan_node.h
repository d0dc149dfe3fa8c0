/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A micro-ROS node that publishes the lidar's scans on the topic `scan`. It finds its agent,
 * notices when the agent disappears, and connects again when it is back; meanwhile the lidar
 * continues to scan. Nothing is allocated here; micro-ROS allocates from its own pools while it
 * connects.
 *
 * Before scan_node_init(), set up the transport to the agent (rmw_uros_set_custom_transport() or
 * your platform's equivalent), and initialise the lidar. */

#ifndef SCAN_NODE_H
#define SCAN_NODE_H

#include <rcl/rcl.h>
#include <rclc/rclc.h>
#include <stdbool.h>
#include <stdint.h>

#include "laser_scan.h"
#include "tmini/tmini.h"

typedef struct {
    uint32_t published; /* Scans handed over to micro-ROS. */
    uint32_t
        unpublished; /* Scans that it did not take, or that came without an agent or its clock. */
    uint32_t connections; /* Connections to an agent. */
    uint32_t unclosed;    /* Entities that micro-ROS failed to close. */
} scan_node_counters_t;

/* Treat the members as private, except `counters`. */
typedef struct {
    tmini_t *lidar;
    const tmini_port_t *port;
    void *port_context;
    sensor_msgs__msg__LaserScan message;
    laser_scan_memory_t memory;
    rcl_allocator_t allocator;
    rclc_support_t support;
    rcl_node_t node;
    rcl_publisher_t publisher;
    bool connected;
    bool synchronised;        /* The clock has been synchronised with the agent since the
                               * connection. */
    uint32_t synchronised_ms; /* When that was done last. */
    uint32_t looked_ms;       /* When the agent was last looked for. */
    scan_node_counters_t counters;
} scan_node_t;

/* Starts the lidar, which was initialised with `config`. The lidar, its port and `frame_id` must
 * outlive the node. */
void scan_node_init(scan_node_t *node, tmini_t *lidar, const tmini_config_t *config,
                    char *frame_id);

/* Does what is due; call it repeatedly, in the context that polls the lidar. It waits for the
 * agent, but never longer than SCAN_NODE_WAIT_MS at a time, and the lidar's receive buffer must
 * last that long: 2048 bytes last 83 ms. (Only connecting may take longer, up to seconds, depending
 * on micro-ROS's configuration.) */
void scan_node_step(scan_node_t *node);

#define SCAN_NODE_WAIT_MS 50

#endif
