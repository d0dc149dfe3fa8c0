/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The part of ROS's C client library that the example uses, written for the tests from the public
 * reference, and implemented by virtual_agent.c. As in the real library, callers must check
 * results. */

#ifndef RCL_RCL_H
#define RCL_RCL_H

#include <stdint.h>

#define MUST_LOOK __attribute__((warn_unused_result))

typedef int32_t rcl_ret_t;
typedef int32_t rmw_ret_t;

#define RCL_RET_OK 0
#define RCL_RET_ERROR 1
#define RMW_RET_OK 0

typedef struct {
    void *state;
} rcl_allocator_t;

typedef struct {
    int destroy_timeout_ms;
} rmw_context_t;

typedef struct {
    int session_timeout_ms;
} rmw_publisher_t;

typedef struct {
    rmw_context_t *impl;
} rcl_context_t;

typedef struct {
    void *impl;
} rcl_node_t;

typedef struct {
    rmw_publisher_t *impl;
} rcl_publisher_t;

typedef struct rmw_publisher_allocation rmw_publisher_allocation_t;

rcl_allocator_t rcl_get_default_allocator(void);
rcl_node_t rcl_get_zero_initialized_node(void);
rcl_publisher_t rcl_get_zero_initialized_publisher(void);
rmw_context_t *rcl_context_get_rmw_context(rcl_context_t *context);
rmw_publisher_t *rcl_publisher_get_rmw_handle(const rcl_publisher_t *publisher);
MUST_LOOK rcl_ret_t rcl_publish(const rcl_publisher_t *publisher, const void *message,
                                rmw_publisher_allocation_t *allocation);
MUST_LOOK rcl_ret_t rcl_publisher_fini(rcl_publisher_t *publisher, rcl_node_t *node);
MUST_LOOK rcl_ret_t rcl_node_fini(rcl_node_t *node);

#endif
