/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "reference_scans.h"

#define FULL 23040 /* In 1/64 degree, as all angles here. */
#define DEGREES(n) ((n)*64)

static int angle(uint16_t field)
{
    return (field >> 1) % FULL;
}

static int first_angle(const reference_item_t *packet)
{
    return angle(packet->fsa);
}

/* The last angle of a single sample means nothing (section 9.6). */
static int last_angle(const reference_item_t *packet)
{
    return packet->lsn == 1 ? angle(packet->fsa) : angle(packet->lsa);
}

/* The clockwise angle between the two, at least -4 degrees, because the encoder jitters. */
static int turn(int from, int to)
{
    const int clockwise = (to - from + FULL) % FULL;
    return clockwise > FULL - DEGREES(4) ? clockwise - FULL : clockwise;
}

/* Bytes skipped between an item and the one before it. */
static size_t bytes_before(const reference_item_t *items, size_t at)
{
    return at == 0 ? items[at].offset
                   : items[at].offset - (items[at - 1].offset + items[at - 1].length);
}

static size_t next_packet(const reference_item_t *items, size_t count, size_t at)
{
    while (at < count && !items[at].is_packet) {
        at++;
    }
    return at;
}

static void include(reference_scan_t *scan, const reference_item_t *packet)
{
    scan->points += packet->lsn;
    scan->packets++;
}

/* The last start packet among items[0] to items[at]; false if there is none. */
static bool last_start(const reference_item_t *items, size_t at, size_t *start)
{
    for (*start = at;; --*start) {
        if (items[*start].is_packet && items[*start].starts_revolution) {
            return true;
        }
        if (*start == 0) {
            return false;
        }
    }
}

/* Follows the scan from its first packet; false if nothing ends it. `start` is the start packet of
 * its revolution. */
static bool follow(const reference_item_t *items, size_t count, size_t start,
                   reference_scan_t *scan)
{
    size_t at = scan->first;
    int swept = (first_angle(&items[at]) - first_angle(&items[start]) + FULL) % FULL +
                turn(first_angle(&items[at]), last_angle(&items[at]));
    scan->decihertz = items[start].ct / 2;
    scan->gaps = start == at ? 0 : 1;
    include(scan, &items[at]);
    for (;;) {
        const size_t next = next_packet(items, count, at + 1);
        if (next == count) {
            return false;
        }
        const reference_item_t *const packet = &items[next];
        const int ahead = turn(last_angle(&items[at]), first_angle(packet));
        const int began = swept + ahead;
        const int ended = began + turn(first_angle(packet), last_angle(packet));
        const size_t skipped = bytes_before(items, next);
        if (packet->starts_revolution) {
            /* One byte before a start packet may be LastCRC. */
            scan->gaps += skipped > 1 || ahead > DEGREES(4) ? 1 : 0;
            scan->is_whole =
                scan->gaps == 0 && began >= FULL - DEGREES(4) && began <= FULL + DEGREES(4);
            scan->decihertz = packet->ct / 2;
            scan->end = next;
            return true;
        }
        if (skipped > 500 || ahead > FULL / 2 || ended > FULL + DEGREES(1) / 4 ||
            ended < -DEGREES(4)) {
            scan->gaps++;
            scan->end = next;
            return true;
        }
        scan->gaps += skipped > 0 || ahead > DEGREES(4) ? 1 : 0;
        include(scan, packet);
        swept = ended;
        at = next;
    }
}

bool reference_scan(const reference_item_t *items, size_t count, size_t from,
                    reference_scan_t *scan)
{
    for (size_t at = from; at < count; at++) {
        size_t start;
        if (items[at].is_packet && last_start(items, at, &start)) {
            *scan = (reference_scan_t){.first = at};
            return follow(items, count, start, scan);
        }
    }
    return false;
}
