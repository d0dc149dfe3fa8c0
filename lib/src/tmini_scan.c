/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_scan.h"

/* Samples are at most 1.08 degrees apart (12 Hz), and the encoder jitters by less than that. */
#define JUMP_Q6 256          /* 4 degrees: further than this, at least one packet is missing. */
#define FULL_CIRCLE_Q6 23168 /* 362 degrees: further than this, it is another revolution. */

/* More bytes than this may have been a whole turn: at 12 Hz it has about 1100 (section 9.7). */
#define HOLE_BYTES 1000

/* The angle turned from one direction to another, clockwise, or slightly back: a hair of jitter
 * backwards (section 9.6) is not nearly a whole turn forwards. */
static int32_t turned(uint16_t from, uint16_t to)
{
    const int32_t forwards = (int32_t)to - from + (to < from ? (int32_t)TMINI_TURN_Q6 : 0);
    return forwards > (int32_t)TMINI_TURN_Q6 - JUMP_Q6 ? forwards - (int32_t)TMINI_TURN_Q6
                                                       : forwards;
}

/* The LSA of a single sample is without meaning. */
static uint16_t end_of(const tmini_packet_t *packet)
{
    return packet->count > 1 ? packet->last_angle_q6 : packet->first_angle_q6;
}

/* The angle turned since the start packet when `packet` ends. */
static int32_t swept_with(const tmini_scan_builder_t *builder, const tmini_packet_t *packet)
{
    return builder->swept_q6 + turned(builder->previous_angle_q6, packet->first_angle_q6) +
           turned(packet->first_angle_q6, end_of(packet));
}

static bool is_missing_before(const tmini_scan_builder_t *builder, const tmini_packet_t *packet)
{
    /* One byte before a start packet is LastCRC (section 7). */
    const unsigned expected = tmini_packet_is_start(packet) ? 1 : 0;
    return packet->gap > expected ||
           turned(builder->previous_angle_q6, packet->first_angle_q6) > JUMP_Q6;
}

static void add_up(uint16_t *total, size_t amount)
{
    const size_t room = UINT16_MAX - (size_t)*total;
    *total = (uint16_t)(*total + (amount < room ? amount : room));
}

/* The scan ends with what has been received before `packet`. */
static void finish(tmini_scan_builder_t *builder, const tmini_packet_t *packet)
{
    tmini_scan_t *const scan = &builder->scan;
    const bool is_start = tmini_packet_is_start(packet);
    if (!is_start || is_missing_before(builder, packet)) {
        add_up(&scan->gaps, 1);
    }
    scan->checksum_errors =
        (uint16_t)(packet->parser->counters.checksum_errors - builder->errors_before);
    /* A start packet carries the frequency of the revolution before it (section 9.8). */
    scan->frequency_chz = (uint16_t)(is_start ? (packet->ct >> 1) * 10 : 0);
    scan->complete = scan->gaps == 0 && scan->dropped == 0;
    builder->open = false;
}

static void begin(tmini_scan_builder_t *builder, const tmini_packet_t *start, uint32_t now_ms)
{
    builder->scan = (tmini_scan_t){.points = builder->scan.points, .timestamp_ms = now_ms};
    builder->previous_angle_q6 = start->first_angle_q6;
    builder->swept_q6 = 0;
    builder->errors_before = (uint16_t)start->parser->counters.checksum_errors;
    builder->open = true;
}

static void append_points(tmini_scan_builder_t *builder, const tmini_packet_t *packet)
{
    tmini_scan_t *const scan = &builder->scan;
    const size_t count = tmini_packet_points(packet, builder->filter, &scan->points[scan->count],
                                             (size_t)builder->capacity - scan->count);
    if (!tmini_parser_frame_intact(packet->parser)) {
        add_up(&scan->gaps, 1);
        return;
    }
    scan->count = (uint16_t)(scan->count + count);
    add_up(&scan->dropped, packet->count - count);
    add_up(&scan->packets, 1);
}

tmini_status_t tmini_scan_init(tmini_scan_builder_t *builder, tmini_point_t *buffer,
                               size_t capacity, unsigned filter)
{
    if (builder == NULL || buffer == NULL || capacity == 0 || capacity > UINT16_MAX ||
        (filter & ~(unsigned)TMINI_FILTER_BOTH) != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    *builder = (tmini_scan_builder_t){
        .scan.points = buffer, .capacity = (uint16_t)capacity, .filter = (uint8_t)filter};
    return TMINI_OK;
}

void tmini_scan_discard(tmini_scan_builder_t *builder)
{
    builder->open = false;
}

bool tmini_scan_close(tmini_scan_builder_t *builder, const tmini_packet_t *packet)
{
    if (!builder->open) {
        return false;
    }
    if (!tmini_packet_is_start(packet) && packet->gap <= HOLE_BYTES &&
        swept_with(builder, packet) <= FULL_CIRCLE_Q6) {
        return false;
    }
    finish(builder, packet);
    return true;
}

void tmini_scan_add(tmini_scan_builder_t *builder, const tmini_packet_t *packet, uint32_t now_ms)
{
    if (tmini_packet_is_start(packet)) {
        begin(builder, packet, now_ms);
    } else if (!builder->open) {
        return;
    } else if (is_missing_before(builder, packet)) {
        add_up(&builder->scan.gaps, 1);
    }
    builder->swept_q6 = swept_with(builder, packet);
    builder->previous_angle_q6 = end_of(packet);
    append_points(builder, packet);
}
