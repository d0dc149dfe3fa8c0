/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The timing of the line: when bytes came, how long it has been silent, and where bytes may be
 * missing because it paused. */

#include "tmini_driver.h"

/* When bytes came is known only if polls are at most WATCHED_MS apart and the bytes are at most
 * FIFO_MS late (a UART's FIFO). */
#define WATCHED_MS 30u
#define FIFO_MS 9u

/* A layer below holds bytes for this long at most. */
#define LATE_MAX_MS 1000

/* Longer silence counts as this long. */
#define SILENCE_MAX_MS UINT16_MAX

/* A port holds at most this many bytes. If `held_to` seems to be farther ahead, it is in fact
 * before the bytes received: the port has fed bytes since its report. */
#define HELD_MAX (TMINI_RING_CLOSED / 2 < 65535u ? TMINI_RING_CLOSED / 2 : 65535u)

/* If the clock steps back by at most STEP_BACK_MAX_MS, no time passes until it has caught up.
 * Silence is not seen meanwhile, but only a step of more than STEP_BACK_FREE_MS can hide a turn. */
#define STEP_BACK_MAX_MS 1000u
#define STEP_BACK_FREE_MS 10u

/* How long a scanning lidar takes to send these bytes: 13.1 per millisecond (section 1). */
static uint32_t transit_ms(size_t bytes)
{
    return (uint32_t)bytes * 39u >> 9;
}

/* How many bytes wait in the port, or below it. */
static size_t held_by_port(const tmini_t *lidar)
{
    const size_t held_to = tmini_load(&lidar->held_to);
    const size_t held = tmini_ring_distance(lidar->line.received, held_to);
    return held_to != 0 && held <= HELD_MAX ? held : 0;
}

/* True if a silence may hide a turn: it is longer than max_pause_ms and than half a turn, at the
 * reported frequency or, while the motor is not up to speed, at 12 Hz. What a shorter silence hides
 * is visible in the angles, even if the true silence is half a turn longer. */
TMINI_NOINLINE static bool may_hide_turn(const tmini_t *lidar, int32_t silent_ms)
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

/* Bytes that need `due_ms` on the wire have come, `passed_ms` after the last look. True if a
 * silence was before them: the lidar does not scan yet, and all of them can have come since that
 * look. In other cases its place is unknown, because a delayed layer below may deliver late what
 * came before the silence. */
static bool is_silence_before(uint32_t due_ms, uint32_t passed_ms, bool is_scanning)
{
    return !is_scanning && passed_ms <= WATCHED_MS && due_ms <= passed_ms + FIFO_MS;
}

/* Notes by how much the newest bytes may be late. A larger delay of earlier bytes is kept until
 * those `are_parsed`. */
static void note_delay(tmini_line_t *line, int32_t late_ms, bool are_parsed)
{
    if (are_parsed) {
        line->late_ms = 0;
    }
    if (late_ms > line->late_ms && late_ms <= LATE_MAX_MS) {
        line->late_ms = (uint16_t)late_ms;
    }
}

/* Notes that bytes may be missing somewhere before `place`. */
static void doubt_to(tmini_line_t *line, size_t place)
{
    line->doubtful_to = place | TMINI_RING_CLOSED; /* The same distance, and never 0. */
}

/* The time since earlier bytes came, less `due_ms`, which the new ones need on the wire. */
static int32_t missing_ms(const tmini_line_t *line, uint32_t due_ms)
{
    const uint32_t pause_ms = line->now_ms - line->heard_ms;
    return (int32_t)((pause_ms < SILENCE_MAX_MS ? pause_ms : SILENCE_MAX_MS) - due_ms);
}

/* Notes `count` new bytes, `passed_ms` after the last look. With the `held` bytes that the port
 * still has, more have arrived; but those that it had before have been noted.
 * A scanning lidar never pauses for long. If the pause was longer than these bytes need on the
 * wire, bytes may be missing, or these may be late by the difference. The difference counts again
 * for the next bytes, because the silence may continue; after a doubt, only if the port may hold
 * what seemed to be missing.
 * More bytes than the ring holds mean a gap of DMA: their true number is unknown. */
static void note_bytes(tmini_t *lidar, size_t count, size_t held, uint32_t passed_ms,
                       bool is_scanning)
{
    tmini_line_t *const line = &lidar->line;
    const size_t fresh = count + held - line->held;
    const size_t arrived = line->received + held;
    line->held = (uint16_t)held;
    if (fresh == 0) {
        return;
    }
    const bool is_gap = count > lidar->ring.size;
    const uint32_t due_ms = transit_ms(fresh);
    int32_t late_ms = missing_ms(line, due_ms);
    line->heard_ms = line->now_ms;
    if (is_gap || may_hide_turn(lidar, late_ms + line->late_ms)) {
        const bool is_before = !is_gap && is_silence_before(due_ms, passed_ms, is_scanning);
        doubt_to(line, is_before ? arrived - fresh : arrived);
        if (tmini_load(&lidar->held_to) == 0) {
            late_ms = 0;
        }
    }
    note_delay(line, late_ms, line->busy_ms == 0);
}

static void note_silence(tmini_line_t *line, uint32_t passed_ms)
{
    const uint32_t seen_ms =
        passed_ms < TMINI_UNSEEN_SILENCE_MAX_MS ? passed_ms : TMINI_UNSEEN_SILENCE_MAX_MS;
    const uint32_t silent_ms = line->silent_ms + seen_ms;
    line->silent_ms = (uint16_t)(silent_ms < SILENCE_MAX_MS ? silent_ms : SILENCE_MAX_MS);
}

/* Counts the time since the first look after the driver had handled all that had come. The pause
 * before that look counts only if the port still holds bytes: then the ring did not last. */
static void note_work(tmini_line_t *line, uint32_t passed_ms)
{
    const bool counts = line->busy_ms > 0 || line->held > 0;
    const uint32_t busy_ms = counts ? line->busy_ms + passed_ms : 0;
    const uint32_t limited_ms = busy_ms < UINT8_MAX ? busy_ms : UINT8_MAX;
    line->busy_ms = (uint16_t)(limited_ms > 0 ? limited_ms : 1);
}

/* Returns how much time has passed since the last look. A step back may hide a turn among the bytes
 * up to `arrived`. */
static uint32_t follow_clock(tmini_line_t *line, uint32_t clock_ms, size_t arrived)
{
    const uint32_t passed_ms = clock_ms - line->now_ms;
    const uint32_t back_ms = line->now_ms - clock_ms;
    if (line->now_ms != 0 && back_ms <= STEP_BACK_MAX_MS) {
        if (back_ms > STEP_BACK_FREE_MS) {
            doubt_to(line, arrived);
        }
        return 0;
    }
    line->now_ms = clock_ms;
    if (clock_ms == 0 && passed_ms > 0) {
        line->now_ms = 1; /* 0 means: never looked. The clock catches up. */
    }
    return passed_ms;
}

bool tmini_line_look(tmini_t *lidar, bool is_scanning)
{
    tmini_line_t *const line = &lidar->line;
    const size_t head = tmini_ring_head(&lidar->ring);
    const size_t count = tmini_ring_distance(line->received, head);
    const uint32_t clock_ms = lidar->link.port->now_ms(lidar->link.port_context);
    line->received = head;
    const size_t held = held_by_port(lidar);
    const uint32_t passed_ms = follow_clock(line, clock_ms, head + held);
    if (line->held > count + held) {
        line->held = 0; /* The port has lost them. */
    }
    if (count > 0) {
        note_bytes(lidar, count, held, passed_ms, is_scanning);
    }
    note_work(line, passed_ms);
    if (count == 0 && !tmini_ring_is_full(&lidar->ring)) { /* It may have refused bytes. */
        note_silence(line, passed_ms);
        return false;
    }
    line->silent_ms = 0;
    return true;
}

uint32_t tmini_line_arrival_ms(const tmini_t *lidar)
{
    const size_t unparsed = tmini_ring_distance(tmini_position(lidar), lidar->line.received);
    const size_t after = unparsed + lidar->line.held;
    return lidar->line.heard_ms - transit_ms(after);
}

/* Packets may be missing before each packet that begins among doubtful bytes, and before the first
 * one after them. */
static bool is_in_doubt(tmini_t *lidar)
{
    tmini_line_t *const line = &lidar->line;
    const size_t left = tmini_ring_distance(tmini_ring_tail(&lidar->ring), line->doubtful_to);
    if (line->doubtful_to == 0) {
        return false;
    }
    if (left == 0 || left > TMINI_RING_CLOSED / 2) {
        line->doubtful_to = 0;
    }
    return true;
}

/* True if too much time has passed since the scan's last packet. Damaged packets of which only a
 * few bytes came cause neither a long silence nor many skipped bytes: only the time shows that they
 * are missing. */
static bool is_late(const tmini_t *lidar, uint32_t came_ms)
{
    const tmini_builder_t *const builder = &lidar->decoder.builder;
    if (!builder->open) {
        return false;
    }
    const uint32_t due_ms = transit_ms(tmini_parser_frame(&lidar->decoder.parser)->size);
    return may_hide_turn(lidar, (int32_t)(came_ms - due_ms - builder->scan.end_ms));
}

bool tmini_line_is_doubtful(tmini_t *lidar, uint32_t came_ms)
{
    if (is_in_doubt(lidar)) {
        return true;
    }
    return is_late(lidar, came_ms);
}
