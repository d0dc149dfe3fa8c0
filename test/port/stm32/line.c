/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "line.h"

#include <string.h>

#include "stm32_model.h"

#define LINE_BYTES 8192u

static struct {
    model_byte_t bytes[LINE_BYTES];
    size_t first;
    size_t count;
    uint64_t free_ns; /* Time at which the last byte has arrived. */
    uint32_t errors;
} line;

static bool next(model_byte_t *byte)
{
    if (line.first == line.count) {
        return false;
    }
    *byte = line.bytes[line.first];
    return true;
}

static void take(void)
{
    line.first++;
}

bool line_is_empty(void)
{
    return line.first == line.count;
}

void line_send(const uint8_t *bytes, size_t count)
{
    if (line_is_empty()) {
        line.first = 0;
        line.count = 0;
        line.free_ns = model.now_ns > line.free_ns ? model.now_ns : line.free_ns;
    }
    for (size_t i = 0; i < count && line.count < LINE_BYTES; i++) {
        line.free_ns += MODEL_BYTE_NS;
        line.bytes[line.count++] =
            (model_byte_t){.at_ns = line.free_ns, .byte = bytes[i], .errors = line.errors};
        line.errors = 0;
    }
}

void line_send_with(uint32_t errors)
{
    line.errors = errors;
}

void line_open(void)
{
    memset(&line, 0, sizeof line);
    model.next = next;
    model.take = take;
}
