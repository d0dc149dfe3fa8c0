/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A line on which bytes arrive one after the other, at full speed. */

#ifndef LINE_H
#define LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tmini/tmini.h"

/* Empties the line and connects it to the model's USART. */
void line_open(void);

/* Adds bytes after those already on the line. */
void line_send(const uint8_t *bytes, size_t count);

/* The next byte added will arrive with these errors (MODEL_FE, MODEL_NE). */
void line_send_with(uint32_t errors);

bool line_is_empty(void);

#define LINE_PACKET_SIZE 13u

/* A packet of a real unit (section 9.14), and copies of it on the line. */
extern const uint8_t line_packet[LINE_PACKET_SIZE];
void line_send_packets(unsigned count);

/* Polls until there is no event. */
tmini_counters_t line_poll(tmini_t *lidar);

/* The same every `step_us`, until all bytes have arrived and the line is idle. */
tmini_counters_t line_run(tmini_t *lidar, uint32_t step_us);

#endif
