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
        .revolution = packet->sent.revolution,
        .number = packet->sent.number,
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
        if (truth->splits[i] > packet->offset && truth->splits[i] < packet->offset + packet->length) {
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

/* ---- Packets that are not where they should be ---- */

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

/* Pops all that begin before `offset`; they should have been delivered. */
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

void truth_forget(truth_t *truth, uint64_t end)
{
    while (truth->count > 0 && entry(truth, 0)->offset + entry(truth, 0)->length <= end) {
        pop(truth);
    }
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

    copy(truth, offset, bytes, TMINI_PACKET_SIZE_MAX(packet->count));
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
    const uint64_t offset = end - TMINI_PACKET_SIZE_MAX(packet->count);
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

/* How many points of the packet on the line at `offset` are those of the scan from `index` on: all of
 * them, or 0. */
static unsigned points_of(const truth_t *truth, uint64_t offset, const tmini_scan_t *scan,
                          unsigned index)
{
    uint8_t bytes[ENCODE_PACKET_MAX];

    copy(truth, offset, bytes, ENCODE_PACKET_HEADER);
    copy(truth, offset, bytes, TMINI_PACKET_SIZE_MAX(bytes[3]));
    for (unsigned i = 0; i < bytes[3]; i++) {
        const reference_point_t expected = reference_point(bytes, i);

        if (index + i >= scan->count || !is_point(&expected, &scan->points[index + i])) {
            return 0;
        }
    }
    return bytes[3];
}

typedef struct {
    const tmini_scan_t *scan;
    unsigned index;
    bool differs;
} comparison_t;

static void compare_item(void *context, const reference_item_t *item)
{
    comparison_t *const comparison = context;

    for (unsigned i = 0; i < item->lsn; i++) {
        const reference_point_t expected = reference_point(item->bytes, i);

        if (comparison->index >= comparison->scan->count ||
            !is_point(&expected, &comparison->scan->points[comparison->index])) {
            comparison->differs = true;
            return;
        }
        comparison->index++;
    }
}

/* Whether the scan is what a decoder finds on the line, whatever was sent. */
static bool is_on_the_line(const truth_t *truth, uint64_t from, uint64_t to,
                           const tmini_scan_t *scan)
{
    static uint8_t bytes[TRUTH_HISTORY];
    const reference_options_t options = { TMINI_MAX_SAMPLES_DEFAULT, NULL };
    comparison_t comparison = { scan, 0, false };

    if (to - from > TRUTH_HISTORY) {
        return false;
    }
    copy(truth, from, bytes, (size_t)(to - from));
    (void)reference_decode(bytes, (size_t)(to - from), &options, compare_item, &comparison);
    return !comparison.differs && comparison.index == scan->count;
}

/* The start packet with which the scan begins: the first one that has its first point. */
static bool find_start(truth_t *truth, uint64_t to, const tmini_scan_t *scan)
{
    while (truth->count > 0 && entry(truth, 0)->offset < to) {
        if (entry(truth, 0)->starts_revolution) {
            if (points_of(truth, entry(truth, 0)->offset, scan, 0) > 0) {
                return true;
            }
            if (!is_excused(truth, entry(truth, 0))) {
                return false;
            }
        }
        pop(truth);
    }
    return false;
}

/* A complete scan misses no packet of all that were sent. */
static bool is_consecutive(truth_t *truth, uint32_t number, const tmini_scan_t *scan)
{
    return !scan->complete || (truth->count > 0 && entry(truth, 0)->number == number);
}

static truth_verdict_t compare_packets(truth_t *truth, uint64_t to, const tmini_scan_t *scan)
{
    const uint32_t number = entry(truth, 0)->number;
    unsigned index = 0;
    unsigned packets = 0;

    while (truth->count > 0 && entry(truth, 0)->offset < to) {
        const unsigned count = points_of(truth, entry(truth, 0)->offset, scan, index);

        if (count == 0 && !is_excused(truth, entry(truth, 0))) {
            return TRUTH_LOST;
        }
        index += count;
        packets += count > 0 ? 1 : 0;
        pop(truth);
    }
    if (index != scan->count || packets != scan->packets ||
        !is_consecutive(truth, number + packets, scan)) {
        return TRUTH_WRONG;
    }
    truth->checked += packets;
    truth->points += index;
    return TRUTH_RIGHT;
}

truth_verdict_t truth_compare_scan(truth_t *truth, uint64_t end, unsigned closing_length,
                                   const tmini_scan_t *scan)
{
    const uint64_t to = end - closing_length;

    if (scan->dropped > 0) {
        truth_forget(truth, to);
        return TRUTH_RIGHT;
    }
    if (!find_start(truth, to, scan)) {
        truth_forget(truth, to);
        return TRUTH_WRONG;
    }
    const uint64_t from = entry(truth, 0)->offset;
    const truth_verdict_t verdict = compare_packets(truth, to, scan);
    if (verdict != TRUTH_RIGHT) {
        truth_forget(truth, to);
        return is_on_the_line(truth, from, to, scan) ? TRUTH_BY_CHANCE : verdict;
    }
    return TRUTH_RIGHT;
}
