/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/parts/tmini_builder.h"

#define CIRCLE_Q6 ((int32_t)TMINI_FULL_CIRCLE_Q6)

/* Samples are at most 1.08 degrees apart (12 Hz), and the encoder jitters by less than that. */
#define JUMP_Q6 256 /* 4 degrees: after a larger jump at least one packet is missing. */
#define SWEPT_MAX_Q6 (CIRCLE_Q6 + 16) /* 360.25 degrees: beyond it, another revolution has begun. */

/* No start packet has come. */
#define NO_ORIGIN UINT16_MAX

/* More bytes than this may have been half a turn: at 12 Hz a turn has about 1100 (section 9.7). */
#define GAP_MAX 500

/* A sample takes 250 us to measure (section 1) and 130 us on the wire: 0.38 ms in 1/65536 ms. */
#define SAMPLE_SENT_Q16_MS 24904u

/* The angle swept clockwise from one direction to another. A small jitter backwards (section 9.6)
 * is a small negative angle, not almost a whole turn. */
static int32_t swept(uint16_t from, uint16_t to)
{
    const int32_t angle = (int32_t)to - from;
    if (angle <= -JUMP_Q6) {
        return angle + CIRCLE_Q6;
    }
    return angle > CIRCLE_Q6 - JUMP_Q6 ? angle - CIRCLE_Q6 : angle;
}

/* The LSA of a packet with one sample has no meaning. */
static uint16_t end_of(const tmini_packet_t *packet)
{
    return packet->count > 1 ? packet->last_angle_q6 : packet->first_angle_q6;
}

/* True if the packet may continue the revolution. It begins `ahead` of the last packet's end and
 * ends at `angle`, counted from the start packet. It does not continue the revolution if half a
 * turn or more may be missing before it, by bytes or by angle, or if it leaves the circle at either
 * end, which shows a lost start packet. */
static bool continues(const tmini_packet_t *packet, int32_t ahead, int32_t angle)
{
    return packet->gap <= GAP_MAX && ahead <= CIRCLE_Q6 / 2 && angle <= SWEPT_MAX_Q6 &&
           angle >= -JUMP_Q6;
}

/* Counts one more, unless that would wrap to 0. */
static void count_one(uint16_t *total)
{
    const uint16_t next = (uint16_t)(*total + 1);
    if (next > 0) {
        *total = next;
    }
}

/* True if the scan took more than one and a half turns at the reported frequency, if there is
 * one. */
static bool took_too_long(const tmini_builder_t *builder)
{
    const tmini_scan_t *const scan = &builder->scan;
    const uint32_t took_ms = scan->end_ms - scan->start_ms + builder->late_ms;
    return scan->frequency_chz > 0 && took_ms > 150000u / scan->frequency_chz;
}

/* True if all of the scan has come, as far as bytes and angles show. */
static bool is_whole(const tmini_scan_t *scan)
{
    return (scan->gaps | scan->dropped) == 0;
}

/* The scan ends before `packet`, which begins `ahead` of the scan's end and came at `now_ms`. A
 * scan that took too long has a gap somewhere. A scan is complete when a start packet comes a full
 * circle after its beginning, and nothing is missing. A gap that only the caller reports, without
 * missing bytes or angles, means a late scan. */
static void finish(tmini_builder_t *builder, const tmini_packet_t *packet, int32_t ahead,
                   uint32_t now_ms)
{
    tmini_scan_t *const scan = &builder->scan;
    const int32_t beyond = builder->swept_q6 + ahead - CIRCLE_Q6;
    const int32_t took_ms = (int32_t)(now_ms - scan->start_ms);
    scan->checksum_errors = (uint16_t)(packet->frame->checksum_errors - scan->checksum_errors);
    scan->end_ms = scan->start_ms + (took_ms > 0 ? (uint32_t)took_ms : 0);
    const bool is_long = is_whole(scan) && took_too_long(builder);
    if (is_long) {
        scan->gaps = 1; /* It was 0. */
    }
    if (is_long || (packet->gap == TMINI_GAP_UNKNOWN && ahead <= JUMP_Q6 &&
                    !tmini_packet_misses(packet, packet->frame->gap))) {
        builder->late_scans++;
    }
    if (is_whole(scan) && beyond >= -JUMP_Q6 && beyond <= JUMP_Q6) {
        scan->complete = true; /* It was false. */
    }
    builder->open = false;
    builder->ended = true;
}

/* A start packet carries the frequency of the revolution before it (section 9.8), which that scan
 * gets, too. */
static void note_start(tmini_builder_t *builder, const tmini_packet_t *start)
{
    builder->origin_q6 = start->first_angle_q6;
    builder->scan.frequency_chz = tmini_packet_frequency_chz(start);
}

/* Begins a scan and returns the angle that its revolution has already turned. A scan that does not
 * begin with a start packet has a gap there. Its time is that of the packet's first sample. */
static int32_t begin_scan(tmini_builder_t *builder, const tmini_packet_t *first, uint32_t now_ms)
{
    tmini_scan_t *const scan = &builder->scan;
    const uint32_t intervals = first->count - 1u;
    scan->count = 0;
    scan->dropped = 0;
    scan->packets = 0;
    scan->complete = false;
    scan->upside_down = false;
    scan->gaps = tmini_packet_is_start(first) ? 0 : 1;
    scan->start_ms = now_ms - (intervals * SAMPLE_SENT_Q16_MS >> 16);
    scan->checksum_errors = first->frame->checksum_errors; /* finish() subtracts this. */
    builder->late_ms = builder->next_late_ms;
    builder->open = true;
    builder->ended = false;
    return tmini_clockwise(builder->origin_q6, first->first_angle_q6);
}

static void append_points(tmini_builder_t *builder, const tmini_packet_t *packet)
{
    tmini_scan_t *const scan = &builder->scan;
    const size_t count = tmini_packet_points(packet, builder->filter, &scan->points[scan->count],
                                             (size_t)builder->capacity - scan->count);
    if (!tmini_frame_intact(packet->frame)) {
        tmini_builder_refute(builder);
        if (scan->packets == 0) { /* No scan is empty. */
            builder->open = false;
        }
        return;
    }
    scan->count = (uint16_t)(scan->count + count);
    count_one(&scan->packets);
    for (size_t dropped = packet->count - count; dropped > 0; dropped--) {
        count_one(&scan->dropped);
    }
}

tmini_status_t tmini_builder_init(tmini_builder_t *builder, tmini_point_t *buffer, size_t capacity,
                                  unsigned filter)
{
    if (builder == NULL || buffer == NULL || capacity == 0 || capacity > UINT16_MAX ||
        (filter & ~(unsigned)TMINI_FILTER_BOTH) != 0) {
        return TMINI_ERROR_ARGUMENT;
    }
    *builder = (tmini_builder_t){.scan.points = buffer,
                                 .capacity = (uint16_t)capacity,
                                 .filter = (uint8_t)filter,
                                 .origin_q6 = NO_ORIGIN};
    return TMINI_OK;
}

void tmini_builder_discard(tmini_builder_t *builder)
{
    builder->open = false;
    builder->ended = false;
    builder->origin_q6 = NO_ORIGIN;
}

TMINI_NOINLINE void tmini_builder_refute(tmini_builder_t *builder)
{
    count_one(&builder->scan.gaps);
}

bool tmini_builder_add(tmini_builder_t *builder, const tmini_packet_t *packet, uint32_t now_ms)
{
    const bool is_start = tmini_packet_is_start(packet);
    const uint16_t end_q6 = end_of(packet);
    int32_t angle = swept(packet->first_angle_q6, end_q6);
    if (is_start) {
        note_start(builder, packet);
    }
    if (builder->open) {
        const int32_t ahead = swept(builder->previous_angle_q6, packet->first_angle_q6);
        angle += builder->swept_q6 + ahead;
        const bool goes_on = !is_start && continues(packet, ahead, angle);
        if (tmini_packet_misses(packet, packet->gap) || ahead > JUMP_Q6 || !(goes_on || is_start)) {
            tmini_builder_refute(builder);
        }
        if (!goes_on) {
            finish(builder, packet, ahead, now_ms);
            return true;
        }
    } else if (builder->origin_q6 != NO_ORIGIN) {
        angle += begin_scan(builder, packet, now_ms);
    } else {
        return false; /* Before the first start packet. */
    }
    builder->swept_q6 = (int16_t)(angle < INT16_MAX ? angle : INT16_MAX);
    builder->previous_angle_q6 = end_q6;
    builder->scan.end_ms = now_ms;
    append_points(builder, packet);
    return false;
}
