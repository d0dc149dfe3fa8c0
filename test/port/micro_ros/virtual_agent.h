/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A model of micro-ROS and its agent: one support, node and publisher at a time, opened in this
 * order; an agent that may be absent; calls that wait. Wrong use fails the test. */

#ifndef VIRTUAL_AGENT_H
#define VIRTUAL_AGENT_H

#include <rclc/rclc.h>
#include <stdbool.h>

typedef struct {
    /* Set by a test. */
    bool present;
    const char *failing; /* The function that fails, in spite of a present agent. */
    int64_t epoch_ns;
    void (*wait)(int ms); /* Called whenever a micro-ROS function waits. */

    /* Read by a test. */
    bool support_open;
    bool node_open;
    bool publisher_open;
    unsigned synchronisations;
    int longest_wait_ms;
    unsigned published;
    sensor_msgs__msg__LaserScan message; /* The last message; its arrays belong to the publisher. */
} virtual_agent_t;

extern virtual_agent_t virtual_agent;

/* Resets the model: no agent is present, and nothing is open. */
void virtual_agent_reset(void (*wait)(int ms));

#endif
