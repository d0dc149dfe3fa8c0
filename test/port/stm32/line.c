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

const uint8_t line_packet[LINE_PACKET_SIZE] = {0xAA, 0x55, 0x75, 0x01, 0x3F, 0x00, 0x3F,
                                               0x00, 0x9E, 0x56, 0x15, 0x54, 0x02};

void line_send_packets(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        line_send(line_packet, sizeof line_packet);
    }
}

tmini_counters_t line_poll(tmini_t *lidar)
{
    tmini_counters_t counters;
    while (tmini_poll(lidar) != TMINI_EVENT_NONE) {
    }
    tmini_counters(lidar, &counters);
    return counters;
}

tmini_counters_t line_run(tmini_t *lidar, uint32_t step_us)
{
    while (!line_is_empty()) {
        model_pass(step_us);
        (void)line_poll(lidar);
    }
    model_pass(1000);
    return line_poll(lidar);
}
