/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The time of the line: when bytes came, how long it has been silent, and where bytes may be
 * missing because it paused. Of packets it knows when the scan's last one came, and how long a turn
 * takes. */

#include "tmini_driver.h"

/* Silence that was not observed counts at most this long: bytes may wait in a layer below. */
#define UNSEEN_SILENCE_MAX_MS 50

/* Polled less often, or handed over more late than by a UART's FIFO, bytes do not show when they
 * came. */
#define WATCHED_MS 30u
#define FIFO_MS 9u

/* No layer below holds bytes for longer. */
#define LATE_MAX_MS 1000

/* Longer silence counts as this. */
#define SILENCE_MAX_MS UINT16_MAX

/* A port holds no more. A place that lies before what has been received, because bytes were fed and
 * this not reported again, seems farther ahead. */
#define HELD_MAX (TMINI_RING_CLOSED / 2 < 65535u ? TMINI_RING_CLOSED / 2 : 65535u)

/* A clock that steps back by no more than this shows no time until it has caught up. (0: it has not
 * been read yet.) */
#define STEP_BACK_MAX_MS 1000u

/* How long a lidar that scans takes to send them: 13.1 bytes per millisecond (section 1). */
static uint32_t transit_ms(size_t bytes)
{
    return (uint32_t)bytes * 39u >> 9;
}

/* Up to where bytes have arrived: in the ring, or in the port that feeds it. */
static size_t arrived_to(const tmini_t *lidar)
{
    const size_t received = lidar->line.received;
    const size_t held_to = tmini_load(&lidar->held_to);
    const bool are_held = held_to != 0 && tmini_ring_distance(received, held_to) <= HELD_MAX;
    return are_held ? held_to : received;
}

/* How long the bytes have taken that have arrived since it was asked last. */
static uint32_t take_arrived_ms(tmini_t *lidar)
{
    tmini_line_t *const line = &lidar->line;
    const size_t arrived = arrived_to(lidar);
    const size_t count = tmini_ring_distance(line->arrived, arrived);
    line->arrived = arrived;
    return count <= TMINI_RING_CLOSED / 2 ? transit_ms(count) : 0;
}

/* A silence that may hide a turn lasts half of one or more, as the lidar reports it, or at 12 Hz
 * while it is not up to speed. What a shorter one hides, the angles show, even if it is half a turn
 * longer than it seems. */
static bool may_hide_turn(const tmini_t *lidar, int32_t silent_ms)
{
    const int32_t max_pause_ms = lidar->link.timing->max_pause_ms;
    if (max_pause_ms == 0 || silent_ms <= max_pause_ms) {
        return false;
    }
    const uint32_t reported_chz = lidar->decoder.builder.scan.frequency_chz;
    const bool is_up = reported_chz >= TMINI_FREQUENCY_MIN_CHZ / 20 * 19;
    const uint32_t frequency_chz = is_up ? reported_chz : TMINI_FREQUENCY_MAX_CHZ;
    return (uint32_t)silent_ms * frequency_chz > 100000u / 2;
}

/* The bytes have come since the last look, and straight from the wire. */
static bool are_fresh(uint32_t due_ms, uint32_t passed_ms)
{
    return passed_ms <= WATCHED_MS && due_ms <= passed_ms + FIFO_MS;
}

/* The bytes that have come may be so late. As long as others are left from before, what holds for
 * those is not forgotten. */
static void note_delay(tmini_t *lidar, int32_t late_ms)
{
    tmini_line_t *const line = &lidar->line;
    if (lidar->is_settled) {
        line->late_ms = 0;
    }
    if (late_ms > line->late_ms && late_ms <= LATE_MAX_MS) {
        line->late_ms = (uint16_t)late_ms;
    }
}

/* Bytes have come, `passed_ms` after the last look. While the lidar scans they never pause for
 * long: if they are too few for the time since others came, then others may be missing. Where, is
 * not known: a layer below that was held up hands over late what came before the silence. So the
 * bytes may be as much older as they are too few, and that time counts for the next ones once more:
 * the silence may go on. Only before a lidar begins to scan, if the line was watched, it was before
 * them. And if there are more than the ring holds, a gap of DMA, their number is unknown. */
static void note_bytes(tmini_t *lidar, size_t count, uint32_t passed_ms)
{
    tmini_line_t *const line = &lidar->line;
    const uint32_t due_ms = take_arrived_ms(lidar);
    const uint32_t pause_ms = line->now_ms - line->heard_ms;
    const int32_t missing_ms =
        (int32_t)((pause_ms < SILENCE_MAX_MS ? pause_ms : SILENCE_MAX_MS) - due_ms);
    const bool is_gap = count > lidar->ring.size;
    const bool is_doubtful = is_gap || may_hide_turn(lidar, missing_ms + line->late_ms);
    if (is_doubtful) {
        const bool is_first = lidar->state != TMINI_STATE_SCANNING;
        const bool is_before = is_first && !is_gap && are_fresh(due_ms, passed_ms);
        line->doubt = true;
        line->doubtful_to = is_before ? line->received - count : line->received;
    }
    note_delay(lidar, is_doubtful ? 0 : missing_ms);
    line->silent_ms = 0;
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
    const size_t after = tmini_ring_distance(position, lidar->line.arrived);
    return lidar->line.heard_ms - transit_ms(after);
}

/* Others may be missing before each packet that begins among doubtful bytes, and before the first
 * one after them. */
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
    const uint32_t due_ms = transit_ms(tmini_parser_frame(&lidar->decoder.parser)->size);
    return builder->open &&
           may_hide_turn(lidar, (int32_t)(came_ms - due_ms - builder->scan.end_ms));
}

bool tmini_line_is_doubtful(tmini_t *lidar, uint32_t came_ms)
{
    return is_in_doubt(lidar) || is_late(lidar, came_ms);
}
