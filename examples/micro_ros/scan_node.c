/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "scan_node.h"

#include <rmw_microros/rmw_microros.h>
#include <string.h>

/* How often the node checks whether the agent is there. */
static const uint32_t LOOK_EVERY_MS = 1000;

/* Two clocks drift apart by about 40 us per second. */
static const uint32_t SYNCHRONISE_EVERY_MS = 60000;

static const int64_t NS_PER_MS = 1000000;

static uint32_t now_ms(const scan_node_t *node)
{
    return node->port->now_ms(node->port_context);
}

static bool agent_answers(void)
{
    return rmw_uros_ping_agent(SCAN_NODE_WAIT_MS, 1) == RMW_RET_OK;
}

static bool open_support(scan_node_t *node)
{
    node->allocator = rcl_get_default_allocator();
    if (rclc_support_init(&node->support, 0, NULL, &node->allocator) != RCL_RET_OK) {
        return false;
    }
    /* If the agent has gone, closing must not wait for its answer. */
    (void)rmw_uros_set_context_entity_destroy_session_timeout(
        rcl_context_get_rmw_context(&node->support.context), 0);
    return true;
}

static bool open_node(scan_node_t *node)
{
    node->node = rcl_get_zero_initialized_node();
    return rclc_node_init_default(&node->node, "tmini", "", &node->support) == RCL_RET_OK;
}

static bool open_publisher(scan_node_t *node)
{
    /* Reliable, because best effort carries no message that is longer than one transport packet. */
    node->publisher = rcl_get_zero_initialized_publisher();
    if (rclc_publisher_init_default(&node->publisher, &node->node,
                                    ROSIDL_GET_MSG_TYPE_SUPPORT(sensor_msgs, msg, LaserScan),
                                    "scan") != RCL_RET_OK) {
        return false;
    }
    (void)rmw_uros_set_publisher_session_timeout(rcl_publisher_get_rmw_handle(&node->publisher),
                                                 SCAN_NODE_WAIT_MS);
    return true;
}

/* Entities that micro-ROS could not close stay in its pools, which are small. */
static void count_unclosed(scan_node_t *node, rcl_ret_t result)
{
    if (result != RCL_RET_OK) {
        node->counters.unclosed++;
    }
}

/* Opens all three entities, or none. */
static bool open_all(scan_node_t *node)
{
    if (!open_support(node)) {
        return false;
    }
    if (open_node(node)) {
        if (open_publisher(node)) {
            return true;
        }
        count_unclosed(node, rcl_node_fini(&node->node));
    }
    count_unclosed(node, rclc_support_fini(&node->support));
    return false;
}

static void close_all(scan_node_t *node)
{
    count_unclosed(node, rcl_publisher_fini(&node->publisher, &node->node));
    count_unclosed(node, rcl_node_fini(&node->node));
    count_unclosed(node, rclc_support_fini(&node->support));
}

/* Until this has succeeded once, the time would be in 1970. */
static void synchronise_if_due(scan_node_t *node)
{
    if (node->synchronised && now_ms(node) - node->synchronised_ms < SYNCHRONISE_EVERY_MS) {
        return;
    }
    if (rmw_uros_sync_session(SCAN_NODE_WAIT_MS) == RMW_RET_OK) {
        node->synchronised = true;
        node->synchronised_ms = now_ms(node);
    }
}

static void connect_if_possible(scan_node_t *node)
{
    node->connected = agent_answers() && open_all(node);
    if (node->connected) {
        node->counters.connections++;
        node->synchronised = false;
        synchronise_if_due(node);
    }
}

static void disconnect_if_gone(scan_node_t *node)
{
    if (!agent_answers()) {
        close_all(node);
        node->connected = false;
        return;
    }
    synchronise_if_due(node);
}

static void look_for_agent(scan_node_t *node)
{
    if (now_ms(node) - node->looked_ms < LOOK_EVERY_MS) {
        return;
    }
    node->looked_ms = now_ms(node);
    if (node->connected) {
        disconnect_if_gone(node);
    } else {
        connect_if_possible(node);
    }
}

/* When the scan ended, in the agent's clock. */
static int64_t end_ns(const scan_node_t *node, const tmini_scan_t *scan)
{
    const uint32_t age_ms = now_ms(node) - scan->end_ms;
    return rmw_uros_epoch_nanos() - (int64_t)age_ms * NS_PER_MS;
}

static bool publish(scan_node_t *node)
{
    const tmini_scan_t *const scan = tmini_scan(node->lidar);
    return node->connected && node->synchronised &&
           laser_scan_fill(&node->message, &node->memory, scan, end_ns(node, scan)) &&
           rcl_publish(&node->publisher, &node->message, NULL) == RCL_RET_OK;
}

static void handle(scan_node_t *node, tmini_event_t event)
{
    if (event == TMINI_EVENT_SCAN) {
        if (publish(node)) {
            node->counters.published++;
        } else {
            node->counters.unpublished++;
        }
    }
}

void scan_node_init(scan_node_t *node, tmini_t *lidar, const tmini_config_t *config, char *frame_id)
{
    memset(node, 0, sizeof *node);
    node->lidar = lidar;
    node->port = config->port;
    node->port_context = config->port_context;
    node->looked_ms = now_ms(node) - LOOK_EVERY_MS;
    laser_scan_init(&node->message, &node->memory, frame_id);
    (void)tmini_start(lidar);
}

void scan_node_step(scan_node_t *node)
{
    tmini_event_t event;
    look_for_agent(node);
    while ((event = tmini_poll(node->lidar)) != TMINI_EVENT_NONE) {
        handle(node, event);
    }
}
