/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#ifndef RMW_MICROROS_RMW_MICROROS_H
#define RMW_MICROROS_RMW_MICROROS_H

#include <rcl/rcl.h>

rmw_ret_t rmw_uros_ping_agent(int timeout_ms, uint8_t attempts);
rmw_ret_t rmw_uros_sync_session(int timeout_ms);
int64_t rmw_uros_epoch_nanos(void);
rmw_ret_t rmw_uros_set_context_entity_destroy_session_timeout(rmw_context_t *context,
                                                              int timeout_ms);
rmw_ret_t rmw_uros_set_publisher_session_timeout(rmw_publisher_t *publisher, int timeout_ms);

#endif
