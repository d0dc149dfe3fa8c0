/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The time of the line: when bytes came, how long it has been silent, and where bytes may be
 * missing because it paused. Nothing here knows packets or commands. */

#include "tmini_driver.h"

/* Silence that was not observed counts at most this long: bytes may wait in a layer below. */
#define UNSEEN_SILENCE_MAX_MS 50

/* More bytes at a look than the wire can have brought since the last one, and in a UART's FIFO,
 * come from a layer that holds them back. */
#define HELD_MS 16u

/* A clock that steps back by no more than this shows no time until it has caught up. At the first
 * look nothing is known of it: 0. */
#define STEP_BACK_MAX_MS 1000u

/* How long a lidar that scans takes to send them: 13.1 bytes a millisecond (section 1), less some
 * because clocks differ: 12.5. */
static uint32_t transit_ms(size_t bytes)
{
    return (uint32_t)bytes * 41u >> 9;
}

/* How long they take on the wire at least: 23 bytes a millisecond. */
static uint32_t wire_ms(size_t bytes)
{
    return (uint32_t)bytes * 45u >> 10;
}

/* Bytes have come, `passed_ms` after the last look. While the lidar scans they never pause for
 * long: if they are too few for the time since others came, then others may be missing, before
 * or among them. If they do not come straight from the wire, but a layer below has held them
 * back, the pause may as well be after them, or go on: what is left of the time counts for the
 * next ones. And if there are more than the ring holds, a gap of DMA, their number is unknown. */
static void note_bytes(tmini_t *lidar, size_t count, uint32_t passed_ms)
{
    tmini_line_t *const line = &lidar->line;
    const uint16_t max_pause_ms = lidar->link.timing->max_pause_ms;
    const uint32_t due_ms = transit_ms(count);
    const uint32_t pause_ms = line->now_ms - line->heard_ms;
    const bool is_gap = count > lidar->ring.size;
    if (is_gap || wire_ms(count) > passed_ms + HELD_MS) {
        line->are_held = true;
    }
    const bool are_held = line->are_held;
    line->silent_ms = 0;
    line->are_held = false;
    if (is_gap || (max_pause_ms > 0 && pause_ms > max_pause_ms + due_ms)) {
        line->doubt = true;
        line->doubtful_to = line->received;
    } else if (are_held && pause_ms > due_ms) {
        line->heard_ms += due_ms;
        return;
    }
    line->heard_ms = line->now_ms;
}

static void note_silence(tmini_line_t *line, uint32_t passed_ms)
{
    const uint32_t seen_ms = passed_ms < UNSEEN_SILENCE_MAX_MS ? passed_ms : UNSEEN_SILENCE_MAX_MS;
    const uint32_t silent_ms = line->silent_ms + seen_ms;
    line->silent_ms = (uint16_t)(silent_ms < UINT16_MAX ? silent_ms : UINT16_MAX);
}

bool tmini_line_look(tmini_t *lidar)
{
    tmini_line_t *const line = &lidar->line;
    const size_t head = tmini_ring_head(&lidar->ring);
    const size_t count = tmini_ring_distance(line->received, head);
    const uint32_t clock_ms = lidar->link.port->now_ms(lidar->link.port_context);
    const bool is_back = line->now_ms != 0 && line->now_ms - clock_ms <= STEP_BACK_MAX_MS;
    const uint32_t now_ms = is_back ? line->now_ms : clock_ms;
    const uint32_t passed_ms = now_ms - line->now_ms;
    line->now_ms = now_ms;
    line->received = head;
    if (passed_ms > lidar->link.timing->max_pause_ms) {
        line->are_held = true;
    }
    if (count > 0) {
        note_bytes(lidar, count, passed_ms);
    } else if (tmini_ring_is_full(&lidar->ring)) {
        line->silent_ms = 0; /* There was no room: what came is unknown. */
    } else {
        note_silence(line, passed_ms);
        return false;
    }
    return true;
}

uint32_t tmini_line_arrival_ms(const tmini_t *lidar)
{
    const size_t position = tmini_parser_position(&lidar->decoder.parser);
    return lidar->line.now_ms - transit_ms(tmini_ring_distance(position, lidar->line.received));
}

/* Bytes are doubtful if the line has paused at them, or their number is unknown. Whether it paused
 * before, among or after them cannot be known: a receiver that was held up hands over late what
 * came before the pause. So others may be missing before each packet that begins among them, and
 * before the first one after them. */
static bool is_in_doubt(tmini_t *lidar)
{
    tmini_line_t *const line = &lidar->line;
    const size_t left = tmini_ring_distance(tmini_ring_tail(&lidar->ring), line->doubtful_to);
    const bool is_doubtful = line->doubt;
    line->doubt = is_doubtful && left > 0 && left <= TMINI_RING_CLOSED / 2;
    return is_doubtful;
}

/* Since the last packet of the scan, damaged ones may have come instead of others, a few bytes of
 * each: neither silence nor many bytes, but too long. */
static bool is_late(const tmini_t *lidar, uint32_t came_ms)
{
    const tmini_builder_t *const builder = &lidar->decoder.builder;
    const uint16_t max_pause_ms = lidar->link.timing->max_pause_ms;
    const uint32_t due_ms = transit_ms(tmini_parser_frame(&lidar->decoder.parser)->size);
    const int32_t since_ms = (int32_t)(came_ms - builder->scan.end_ms);
    return builder->open && max_pause_ms > 0 && since_ms > (int32_t)(max_pause_ms + due_ms);
}

bool tmini_line_is_doubtful(tmini_t *lidar, uint32_t came_ms)
{
    return is_in_doubt(lidar) || is_late(lidar, came_ms);
}
