/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A line on which bytes arrive one after the other, at full speed. */

#ifndef LINE_H
#define LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Empties the line and connects it to the model's USART. */
void line_open(void);

/* Adds bytes after those already on the line. */
void line_send(const uint8_t *bytes, size_t count);

/* The next byte added will arrive with these errors (MODEL_FE, MODEL_NE). */
void line_send_with(uint32_t errors);

bool line_is_empty(void);

#endif
