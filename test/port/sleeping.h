/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What a port must do that has a function in which the polling task sleeps until the lidar must be
 * polled, or a byte comes. The tests in sleeping.c run for each way of receiving (every_port.h). */

#ifndef SLEEPING_H
#define SLEEPING_H

#include <stdint.h>

/* Defined by a port's test. */
void port_sleep(uint32_t due_ms);
extern const uint32_t port_tick_us;

#endif
