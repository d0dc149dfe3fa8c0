/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* micro-ROS and its agent, as the example sees them: one support, node and publisher at a time, in
 * that order; an agent that comes and goes; calls that wait. Wrong use fails the test. */

#ifndef VIRTUAL_AGENT_H
#define VIRTUAL_AGENT_H

#include <rclc/rclc.h>

typedef struct {
    /* What a test sets. */
    bool present;
    bool refuses_support;
    bool refuses_node;
    bool refuses_publisher;
    bool takes_nothing; /* rcl_publish() fails. */
    bool closes_badly;
    bool keeps_its_clock; /* Synchronising fails. */
    int64_t epoch_ns;
    void (*wait)(int ms); /* Called whenever a call of micro-ROS waits. */

    /* What it reads. */
    bool support_open;
    bool node_open;
    bool publisher_open;
    bool synchronised;
    unsigned synchronisations;
    int longest_wait_ms;
    unsigned published;
    char topic[16];
    sensor_msgs__msg__LaserScan message; /* The last one; its memory is the publisher's. */
} virtual_agent_t;

extern virtual_agent_t virtual_agent;

/* No agent, nothing open. */
void virtual_agent_reset(void (*wait)(int ms));

#endif
