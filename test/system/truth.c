/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "truth.h"

#include "reference_decoder.h"

#include <string.h>

void truth_init(truth_t *truth)
{
    memset(truth, 0, sizeof *truth);
}

/* ---- What was on the line ---- */

static truth_packet_t *entry(truth_t *truth, uint32_t place)
{
    return &truth->packets[(truth->first + place) % TRUTH_PACKETS];
}

static void pop(truth_t *truth)
{
    truth->first++;
    truth->count--;
}

void truth_sent(truth_t *truth, const sim_link_packet_t *packet)
{
    if (!packet->intact) {
        truth->small_damaged += packet->sent.bytes[3] <= TRUTH_SMALL_SAMPLES ? 1 : 0;
        return;
    }
    if (truth->count == TRUTH_PACKETS) {
        pop(truth);
        truth->overflows++;
    }
    *entry(truth, truth->count++) = (truth_packet_t){
        .offset = packet->offset,
        .length = packet->sent.length,
        .starts_revolution = packet->sent.starts_revolution,
        .is_of_partial = packet->sent.is_of_partial,
        .revolution = packet->sent.revolution,
        .number = packet->sent.number - truth->small_damaged,
    };
}

void truth_arrived(truth_t *truth, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        truth->history[truth->end++ % TRUTH_HISTORY] = bytes[i];
    }
}

void truth_fell_silent(truth_t *truth, uint64_t end)
{
    const uint32_t last = (truth->split_count + TRUTH_SPLITS - 1) % TRUTH_SPLITS;

    if (truth->split_count == 0 || truth->splits[last] != end) {
        truth->splits[truth->split_count++ % TRUTH_SPLITS] = end;
    }
}

static bool was_split(const truth_t *truth, const truth_packet_t *packet)
{
    for (uint32_t i = 0; i < TRUTH_SPLITS; i++) {
        if (truth->splits[i] > packet->offset &&
            truth->splits[i] < packet->offset + packet->length) {
            return true;
        }
    }
    return false;
}

static void copy(const truth_t *truth, uint64_t from, uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        bytes[i] = truth->history[(from + i) % TRUTH_HISTORY];
    }
}

/* ---- Missing packets ---- */

static bool is_excused(truth_t *truth, const truth_packet_t *packet)
{
    if (was_split(truth, packet)) {
        truth->split++;
        return true;
    }
    if (packet->offset < truth->delivered_end) {
        truth->eclipsed++;
        return true;
    }
    return false;
}

/* Removes all packets that begin before `offset`; they should have been delivered. */
static truth_verdict_t pop_missing(truth_t *truth, uint64_t offset)
{
    truth_verdict_t verdict = TRUTH_RIGHT;

    while (truth->count > 0 && entry(truth, 0)->offset < offset) {
        if (!is_excused(truth, entry(truth, 0))) {
            verdict = TRUTH_LOST;
        }
        pop(truth);
    }
    return verdict;
}

static void pop_until(truth_t *truth, uint64_t end)
{
    truth->compared = end;
    while (truth->count > 0 && entry(truth, 0)->offset + entry(truth, 0)->length <= end) {
        pop(truth);
    }
}

void truth_forget(truth_t *truth, uint64_t end)
{
    pop_until(truth, end);
    truth->has_start = false;
}

truth_verdict_t truth_must_be_empty(truth_t *truth, uint64_t end)
{
    truth_verdict_t verdict = TRUTH_RIGHT;

    while (truth->count > 0 && entry(truth, 0)->offset + entry(truth, 0)->length <= end) {
        if (!is_excused(truth, entry(truth, 0))) {
            verdict = TRUTH_LOST;
        }
        pop(truth);
    }
    return verdict;
}

/* ---- A packet ---- */

static bool is_point(const reference_point_t *expected, const tmini_point_t *point)
{
    return expected->angle_q6 == point->angle_q6 && expected->distance_mm == point->distance_mm &&
           expected->intensity == point->intensity && expected->flag == point->flag;
}

static bool is_valid(const uint8_t *bytes)
{
    return bytes[0] == 0xAA && bytes[1] == 0x55 &&
           encode_checksum(bytes) == (uint16_t)(bytes[8] | bytes[9] << 8);
}

static bool packet_is_as_on_the_line(truth_t *truth, uint64_t offset, const tmini_packet_t *packet)
{
    uint8_t bytes[ENCODE_PACKET_MAX];

    copy(truth, offset, bytes, TMINI_PACKET_SIZE(packet->count));
    if (!is_valid(bytes) || bytes[3] != packet->count || bytes[2] != packet->ct) {
        return false;
    }
    for (unsigned i = 0; i < packet->count; i++) {
        const reference_point_t expected = reference_point(bytes, i);
        tmini_point_t point;

        if (!tmini_packet_point(packet, i, &point) || !is_point(&expected, &point)) {
            return false;
        }
    }
    truth->points += packet->count;
    return true;
}

truth_verdict_t truth_compare_packet(truth_t *truth, uint64_t end, const tmini_packet_t *packet)
{
    const uint64_t offset = end - TMINI_PACKET_SIZE(packet->count);
    const truth_verdict_t before = pop_missing(truth, offset);
    const bool as_sent = truth->count > 0 && entry(truth, 0)->offset == offset;

    truth->delivered_end = end;
    if (!packet_is_as_on_the_line(truth, offset, packet)) {
        return TRUTH_WRONG;
    }
    if (as_sent) {
        pop(truth);
        truth->checked++;
    }
    if (before != TRUTH_RIGHT) {
        return before;
    }
    return as_sent ? TRUTH_RIGHT : TRUTH_BY_CHANCE;
}

/* ---- A scan ---- */

/* If the points of the packet at `offset` on the line are those of the scan from `index` on,
 * returns their number, otherwise 0. */
static unsigned points_of(const truth_t *truth, uint64_t offset, const tmini_scan_t *scan,
                          unsigned index)
{
    uint8_t bytes[ENCODE_PACKET_MAX];

    copy(truth, offset, bytes, ENCODE_PACKET_HEADER);
    copy(truth, offset, bytes, TMINI_PACKET_SIZE(bytes[3]));
    for (unsigned i = 0; i < bytes[3]; i++) {
        const reference_point_t expected = reference_point(bytes, i);

        if (index + i >= scan->count || !is_point(&expected, &scan->points[index + i])) {
            return 0;
        }
    }
    return bytes[3];
}

/* How far the comparison has come. */
typedef struct {
    const tmini_scan_t *scan;
    uint64_t at; /* Place on the line. */
    uint64_t to;
    unsigned index; /* Of the scan's next point; 0: its first packet has not been found yet. */
    unsigned packets;
    uint32_t revolution; /* Of the scan's first packet that arrived as it was sent. */
    bool has_revolution;
    bool mixed;
    bool by_chance;
} comparison_t;

static bool fits(const truth_t *truth, const comparison_t *comparison, uint64_t offset)
{
    return points_of(truth, offset, comparison->scan, comparison->index) > 0;
}

static void take(truth_t *truth, comparison_t *comparison, uint64_t offset)
{
    const unsigned count = points_of(truth, offset, comparison->scan, comparison->index);

    comparison->index += count;
    comparison->packets++;
    comparison->at = offset + TMINI_PACKET_SIZE(count);
    truth->delivered_end = comparison->at;
}

/* Only packets before the first start packet are in no scan. */
static bool may_be_next(const truth_t *truth, const comparison_t *comparison, bool is_start)
{
    return comparison->index > 0 || truth->has_start || is_start;
}

/* The scan may contain a damaged packet whose checksum happens to match. */
static bool take_by_chance(truth_t *truth, comparison_t *comparison, uint64_t to)
{
    uint8_t bytes[ENCODE_PACKET_MAX];

    for (uint64_t offset = comparison->at; offset < to; offset++) {
        copy(truth, offset, bytes, sizeof bytes);
        if (is_valid(bytes) && may_be_next(truth, comparison, (bytes[2] & 1u) != 0) &&
            fits(truth, comparison, offset)) {
            take(truth, comparison, offset);
            comparison->by_chance = true;
            return true;
        }
    }
    return false;
}

/* All points of a scan are from one revolution, with one exception. If the lidar began with a start
 * packet at any angle (section 9.8), nothing shows where revolutions begin until the next start
 * packet. Until then a scan is one turn from the first packet's angle on, and may have points of
 * two revolutions, but no angle twice. */
static void note_revolution(truth_t *truth, comparison_t *comparison, const truth_packet_t *sent)
{
    if (sent->starts_revolution) {
        truth->origin_is_partial = sent->is_of_partial;
    }
    if (!comparison->has_revolution) {
        comparison->has_revolution = true;
        comparison->revolution = sent->revolution;
    }
    const uint32_t later = sent->revolution - comparison->revolution;
    comparison->mixed |= later > (truth->origin_is_partial ? 1u : 0u);
}

/* The next intact packet must be next in the scan. Returns false if it is not and has no excuse. */
static bool take_sent(truth_t *truth, comparison_t *comparison)
{
    const truth_packet_t *const sent = entry(truth, 0);
    const bool belongs = may_be_next(truth, comparison, sent->starts_revolution);

    if (belongs && fits(truth, comparison, sent->offset)) {
        take(truth, comparison, sent->offset);
        note_revolution(truth, comparison, sent);
        truth->checked++;
    } else if (take_by_chance(truth, comparison, sent->offset)) {
        return true;
    } else if (belongs && !is_excused(truth, sent)) {
        return false;
    }
    pop(truth);
    return true;
}

static bool any_sent(truth_t *truth, const comparison_t *comparison)
{
    return truth->count > 0 && entry(truth, 0)->offset < comparison->to;
}

/* A complete scan has all packets that were sent, except small damaged ones. */
static bool is_consecutive(truth_t *truth, uint32_t number, const comparison_t *comparison)
{
    return !comparison->scan->complete || comparison->by_chance ||
           (truth->count > 0 && entry(truth, 0)->number == number + comparison->packets);
}

static truth_verdict_t compare(truth_t *truth, comparison_t *comparison)
{
    uint32_t number = 0;

    while (any_sent(truth, comparison)) {
        if (comparison->index == 0) {
            number = entry(truth, 0)->number;
        }
        if (!take_sent(truth, comparison)) {
            return TRUTH_LOST;
        }
    }
    while (take_by_chance(truth, comparison, comparison->to)) {
    }
    if (comparison->index != comparison->scan->count ||
        comparison->packets != comparison->scan->packets ||
        !is_consecutive(truth, number, comparison)) {
        return TRUTH_WRONG;
    }
    truth->points += comparison->index;
    if (comparison->mixed) {
        return TRUTH_MIXED;
    }
    return comparison->by_chance ? TRUTH_BY_CHANCE : TRUTH_RIGHT;
}

truth_verdict_t truth_compare_scan(truth_t *truth, uint64_t end, unsigned closing_length,
                                   const tmini_scan_t *scan)
{
    comparison_t comparison = {.scan = scan, .at = truth->compared, .to = end - closing_length};
    truth_verdict_t verdict = TRUTH_RIGHT;

    if (scan->dropped == 0) {
        verdict = compare(truth, &comparison);
    }
    pop_until(truth, comparison.to);
    truth->has_start = true;
    return verdict;
}
