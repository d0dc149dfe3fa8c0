/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "virtual_agent.h"

#include <rmw_microros/rmw_microros.h>
#include <string.h>

#include "unity.h"

virtual_agent_t virtual_agent;

static rmw_context_t context;
static rmw_publisher_t publisher_handle;
static const rosidl_message_type_support_t laser_scan = {"LaserScan"};

void virtual_agent_reset(void (*wait)(int ms))
{
    memset(&virtual_agent, 0, sizeof virtual_agent);
    virtual_agent.wait = wait;
    context = (rmw_context_t){1000};
    publisher_handle = (rmw_publisher_t){1000};
}

static void spend(int ms)
{
    if (ms > virtual_agent.longest_wait_ms) {
        virtual_agent.longest_wait_ms = ms;
    }
    virtual_agent.wait(ms);
}

static bool works(const char *function)
{
    return virtual_agent.failing == NULL || strcmp(virtual_agent.failing, function) != 0;
}

/* A present agent answers after 2 ms. */
static rcl_ret_t ask(const char *function, int timeout_ms)
{
    spend(virtual_agent.present ? 2 : timeout_ms);
    return virtual_agent.present && works(function) ? RCL_RET_OK : RCL_RET_ERROR;
}

rmw_ret_t rmw_uros_ping_agent(int timeout_ms, uint8_t attempts)
{
    TEST_ASSERT_EQUAL_UINT8(1, attempts);
    return ask("ping", timeout_ms);
}

rmw_ret_t rmw_uros_sync_session(int timeout_ms)
{
    TEST_ASSERT_TRUE(virtual_agent.support_open);
    const rmw_ret_t result = ask("sync", timeout_ms);
    virtual_agent.synchronisations += result == RMW_RET_OK;
    return result;
}

int64_t rmw_uros_epoch_nanos(void)
{
    return virtual_agent.epoch_ns;
}

rmw_ret_t rmw_uros_set_context_entity_destroy_session_timeout(rmw_context_t *of, int timeout_ms)
{
    TEST_ASSERT_EQUAL_PTR(&context, of);
    of->destroy_timeout_ms = timeout_ms;
    return RMW_RET_OK;
}

rmw_ret_t rmw_uros_set_publisher_session_timeout(rmw_publisher_t *publisher, int timeout_ms)
{
    TEST_ASSERT_EQUAL_PTR(&publisher_handle, publisher);
    publisher->session_timeout_ms = timeout_ms;
    return RMW_RET_OK;
}

rcl_allocator_t rcl_get_default_allocator(void)
{
    return (rcl_allocator_t){&virtual_agent};
}

rcl_node_t rcl_get_zero_initialized_node(void)
{
    return (rcl_node_t){NULL};
}

rcl_publisher_t rcl_get_zero_initialized_publisher(void)
{
    return (rcl_publisher_t){NULL};
}

rmw_context_t *rcl_context_get_rmw_context(rcl_context_t *of)
{
    return of->impl;
}

rmw_publisher_t *rcl_publisher_get_rmw_handle(const rcl_publisher_t *publisher)
{
    return publisher->impl;
}

const rosidl_message_type_support_t *laser_scan_type_support(void)
{
    return &laser_scan;
}

/* Objects are opened from the outer to the inner one, and closed in the reverse order. */
static rcl_ret_t open_one(const char *function, bool *is_open, bool outer_is_open)
{
    TEST_ASSERT_FALSE(*is_open);
    TEST_ASSERT_TRUE(outer_is_open);
    *is_open = works(function);
    return *is_open ? RCL_RET_OK : RCL_RET_ERROR;
}

rcl_ret_t rclc_support_init(rclc_support_t *support, int argc, char const *const *argv,
                            rcl_allocator_t *allocator)
{
    (void)argc, (void)argv;
    TEST_ASSERT_EQUAL_PTR(&virtual_agent, allocator->state);
    if (!virtual_agent.present) {
        return RCL_RET_ERROR;
    }
    context.destroy_timeout_ms = 1000;
    support->context.impl = &context;
    support->allocator = allocator;
    return open_one("support", &virtual_agent.support_open, true);
}

rcl_ret_t rclc_node_init_default(rcl_node_t *node, const char *name, const char *name_space,
                                 rclc_support_t *support)
{
    TEST_ASSERT_NULL(node->impl);
    TEST_ASSERT_EQUAL_PTR(&context, support->context.impl);
    TEST_ASSERT_EQUAL_STRING("tmini", name);
    TEST_ASSERT_EQUAL_STRING("", name_space);
    node->impl = &virtual_agent;
    return open_one("node", &virtual_agent.node_open, virtual_agent.support_open);
}

rcl_ret_t rclc_publisher_init_default(rcl_publisher_t *publisher, const rcl_node_t *node,
                                      const rosidl_message_type_support_t *type_support,
                                      const char *topic_name)
{
    TEST_ASSERT_NULL(publisher->impl);
    TEST_ASSERT_EQUAL_PTR(&virtual_agent, node->impl);
    TEST_ASSERT_EQUAL_PTR(&laser_scan, type_support);
    TEST_ASSERT_EQUAL_STRING("scan", topic_name);
    publisher_handle.session_timeout_ms = 1000;
    publisher->impl = &publisher_handle;
    return open_one("publisher", &virtual_agent.publisher_open, virtual_agent.node_open);
}

/* A reliable publisher waits for the agent's acknowledgement. */
rcl_ret_t rcl_publish(const rcl_publisher_t *publisher, const void *message,
                      rmw_publisher_allocation_t *allocation)
{
    TEST_ASSERT_TRUE(virtual_agent.publisher_open);
    TEST_ASSERT_NULL(allocation);
    const rcl_ret_t result = ask("publish", publisher->impl->session_timeout_ms);
    if (result == RCL_RET_OK) {
        virtual_agent.message = *(const sensor_msgs__msg__LaserScan *)message;
        virtual_agent.published++;
    }
    return result;
}

static rcl_ret_t close_one(bool *is_open, bool inner_is_open)
{
    TEST_ASSERT_TRUE(*is_open);
    TEST_ASSERT_FALSE(inner_is_open);
    *is_open = false;
    (void)ask("close", context.destroy_timeout_ms);
    return works("close") ? RCL_RET_OK : RCL_RET_ERROR;
}

rcl_ret_t rcl_publisher_fini(rcl_publisher_t *publisher, rcl_node_t *node)
{
    TEST_ASSERT_NOT_NULL(node->impl);
    publisher->impl = NULL;
    return close_one(&virtual_agent.publisher_open, false);
}

rcl_ret_t rcl_node_fini(rcl_node_t *node)
{
    node->impl = NULL;
    return close_one(&virtual_agent.node_open, virtual_agent.publisher_open);
}

rcl_ret_t rclc_support_fini(rclc_support_t *support)
{
    support->context.impl = NULL;
    return close_one(&virtual_agent.support_open, virtual_agent.node_open);
}
