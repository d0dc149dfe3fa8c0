/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "sim_line.h"

/* Section 1: 230400 baud, ten bits per byte: 10^7 / 230400 = 3125 / 72 microseconds. */
#define BYTE_US_TIMES_72 3125u

static uint64_t duration_us(size_t bytes)
{
    return ((uint64_t)bytes * BYTE_US_TIMES_72 + 71u) / 72u;
}

uint64_t sim_byte_us(uint64_t start_us, size_t offset)
{
    return start_us + duration_us(offset + 1u);
}

static uint16_t bytes_left(const sim_frame_t *frame, uint64_t now_us)
{
    if (now_us <= frame->start_us) {
        return 0;
    }
    if (now_us - frame->start_us >= UINT32_C(50) * SIM_FRAME_MAX) {
        return frame->length;
    }
    const uint32_t count = (uint32_t)(now_us - frame->start_us) * 72u / BYTE_US_TIMES_72;
    return count < frame->length ? (uint16_t)count : frame->length;
}

static sim_frame_t *frame_at(sim_line_t *line, uint32_t place)
{
    return &line->frames[(line->first + place) % SIM_LINE_FRAMES];
}

sim_frame_t *sim_line_open(sim_line_t *line)
{
    if (sim_line_front(line) != NULL && line->count == SIM_LINE_FRAMES) {
        line->lost++;
        return NULL;
    }
    sim_frame_t *const frame = frame_at(line, line->count);
    frame->length = 0;
    frame->taken = 0;
    frame->packet_at = 0;
    frame->is_packet = false;
    frame->cut = false;
    return frame;
}

void sim_line_send(sim_line_t *line, uint64_t now_us)
{
    sim_frame_t *frame = frame_at(line, line->count);
    frame->start_us = now_us > line->free_us ? now_us : line->free_us;
    line->free_us = frame->start_us + duration_us(frame->length);
    line->count++;
}

sim_frame_t *sim_line_front(sim_line_t *line)
{
    while (line->count > 0) {
        sim_frame_t *frame = frame_at(line, 0);
        if (frame->taken < frame->length) {
            return frame;
        }
        line->first++;
        line->count--;
    }
    return NULL;
}

static void describe_packet(sim_frame_t *frame)
{
    frame->packet.bytes = frame->bytes + frame->packet_at;
    frame->packet.length = (uint16_t)(frame->length - frame->packet_at);
}

static void describe_run(const sim_frame_t *frame, size_t length, sim_run_t *run)
{
    run->bytes = frame->bytes + frame->taken;
    run->length = length;
    run->offset = frame->taken;
    run->frame_length = frame->length;
    run->packet_at = frame->packet_at;
    run->packet = frame->is_packet ? &frame->packet : NULL;
    run->start_us = frame->start_us;
    run->completes = frame->taken + length == frame->length && !frame->cut;
}

bool sim_line_take(sim_line_t *line, uint64_t now_us, size_t max, sim_run_t *run)
{
    sim_frame_t *frame = sim_line_front(line);
    size_t length;
    if (frame == NULL) {
        return false;
    }
    length = (size_t)(bytes_left(frame, now_us) - frame->taken);
    length = length < max ? length : max;
    if (length == 0u) {
        return false;
    }
    if (frame->taken == 0u && !frame->cut) {
        describe_packet(frame);
    }
    describe_run(frame, length, run);
    frame->taken = (uint16_t)(frame->taken + length);
    return true;
}

/* A frame that has been sent in part ends here, but its packet's description keeps the intended
 * length. Frames of which no byte has been sent are removed. */
void sim_line_cut(sim_line_t *line, uint64_t now_us)
{
    sim_frame_t *frame = sim_line_front(line);
    line->free_us = now_us;
    line->count = 0;
    if (frame == NULL || bytes_left(frame, now_us) == 0u) {
        return;
    }
    if (frame->taken == 0u) {
        describe_packet(frame);
    }
    line->count = 1;
    frame->cut = bytes_left(frame, now_us) < frame->length;
    frame->length = bytes_left(frame, now_us);
}
