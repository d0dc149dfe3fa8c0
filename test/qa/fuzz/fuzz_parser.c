/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Fuzz target: parser, packets and scans decode any bytes, in any chunks. They must find the same
 * frames, points (receiver.h) and scans as the reference decoder. Random bytes are hardly ever a
 * packet: the mutator below makes packets. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "encoder.h"
#include "invariants.h"
#include "receiver.h"
#include "reference_scans.h"
#include "tmini/parts/tmini_builder.h"
#include "unity.h"

#define FRAMES_MAX 4096
#define SCAN_POINTS 200 /* Fewer than a scan may have, to test the overflow as well. */
#define SETUP_SIZE 4u   /* The first bytes of the input choose the set-up. */

static reference_item_t expected[FRAMES_MAX];
static size_t expected_count;
static size_t seen;
static size_t scanned; /* Number of frames before the next scan. */
static receiver_t receiver;
static tmini_builder_t builder;

void setUp(void) {}

void tearDown(void) {}

static void demand(int condition)
{
    if (!condition) {
        abort();
    }
}

static void expect(void *context, const reference_item_t *item)
{
    (void)context;
    demand(expected_count < FRAMES_MAX);
    expected[expected_count++] = *item;
}

/* Compares the points that fit in the scan. */
static void compare_points(const tmini_scan_t *scan, const reference_scan_t *wanted)
{
    size_t at = 0;
    for (size_t i = wanted->first; i < wanted->end; i++) {
        const reference_item_t *const item = &expected[i];
        for (unsigned j = 0; item->is_packet && j < item->lsn && at < scan->count; j++, at++) {
            const reference_point_t point = reference_point(item->bytes, j);
            const tmini_point_t *const got = &scan->points[at];
            demand(got->angle_q6 == point.angle_q6 && got->flag == point.flag);
            demand(got->distance_mm == (point.flag >= 2 ? 0 : point.distance_mm));
            demand(got->intensity == point.intensity);
        }
    }
    demand(at == scan->count);
}

/* The last packet has ended this scan. */
static void compare_scan(const tmini_scan_t *scan)
{
    reference_scan_t wanted;
    demand(reference_scan(expected, expected_count, scanned, &wanted));
    demand(wanted.end == seen - 1);
    scanned = wanted.end;
    demand(scan->packets == wanted.packets && scan->gaps == wanted.gaps);
    demand(scan->count == (wanted.points < SCAN_POINTS ? wanted.points : SCAN_POINTS));
    demand((size_t)scan->count + scan->dropped == wanted.points);
    demand(scan->complete == (wanted.is_whole && scan->dropped == 0));
    demand(scan->frequency_chz == 10 * wanted.decihertz);
    compare_points(scan, &wanted);
}

static void gather(const tmini_packet_t *packet)
{
    while (!expected[seen++].is_packet) { /* Replies. */
    }
    if (tmini_builder_add(&builder, packet, 0)) {
        compare_scan(&builder.scan);
        demand(!tmini_builder_add(&builder, packet, 0));
    }
    demand(parser_is_sound(&receiver.parser) && builder_is_sound(&builder));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The first four bytes choose the set-up; the rest is the stream. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t memory[1024];
    static tmini_point_t points[SCAN_POINTS];
    if (size < SETUP_SIZE) {
        return 0;
    }
    const uint8_t max_samples = data[0] == 0 ? 80 : data[0];
    const reference_reply_t reply = {.mode = 0, .type = 0x04, .length = data[3] % 21u};
    const receiver_course_t course = {.chunk = 1u + data[1] % 200u,
                                      .awaited = data[2] % 2 != 0 ? &reply : NULL,
                                      .on_packet = gather};
    const reference_options_t options = {max_samples, course.awaited};
    if (!TEST_PROTECT()) {
        abort(); /* An assertion of the receiver's has failed. */
    }
    expected_count = 0;
    seen = 0;
    scanned = 0;
    (void)reference_decode(data + SETUP_SIZE, size - SETUP_SIZE, &options, expect, NULL);
    demand(tmini_builder_init(&builder, points, SCAN_POINTS, TMINI_FILTER_BOTH) == TMINI_OK);
    receiver_open(&receiver, memory, sizeof memory, max_samples);
    (void)receiver_compare(&receiver, &course, data + SETUP_SIZE, size - SETUP_SIZE);
    demand(!reference_scan(expected, expected_count, scanned, &(reference_scan_t){0}));
    return 0;
}

/* ---- The mutator ---- */

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

static random_t chance;

/* Makes most byte sequences that look like a packet valid packets. */
static void seal(uint8_t *data, size_t size)
{
    for (size_t at = SETUP_SIZE; at + ENCODE_PACKET_HEADER <= size; at++) {
        uint8_t *const packet = &data[at];
        if (packet[0] == 0xAA && packet[1] == 0x55 && random_below(&chance, 8) != 0) {
            packet[4] |= 1;
            packet[6] |= 1;
            packet[3] = (packet[2] & 1) != 0 ? 1 : packet[3];
            if (packet[3] > 0 && at + 10u + 3u * packet[3] <= size) {
                encode_seal(packet);
                at += 9u + 3u * packet[3];
            }
        }
    }
}

/* Appends a packet with `lsn` samples from angle `from` to `from` + `width`; with `lsn` 0 a start
 * packet. Returns the new size. */
static size_t append(uint8_t *data, size_t size, size_t max_size, uint8_t lsn, uint16_t from,
                     uint16_t width)
{
    encode_sample_t samples[255];
    const encode_packet_t packet = {.ct =
                                        (uint8_t)(lsn == 0 ? 121 : random_below(&chance, 128) * 2),
                                    .lsn = lsn == 0 ? 1 : lsn,
                                    .first_q6 = from % ENCODE_FULL_TURN_Q6,
                                    .last_q6 = (uint16_t)((from + width) % ENCODE_FULL_TURN_Q6),
                                    .samples = samples};
    if (size + 10u + 3u * packet.lsn > max_size) {
        return size;
    }
    for (unsigned i = 0; i < packet.lsn; i++) {
        const uint32_t any = random_u32(&chance);
        samples[i] = (encode_sample_t){any & 0x3FFF, (uint8_t)(any >> 16), any >> 30};
    }
    return size + encode_packet(&data[size], &packet);
}

/* Appends about a revolution: 360 degrees in a few packets, some of which may be missing. */
static size_t append_turn(uint8_t *data, size_t size, size_t max_size)
{
    const uint32_t packets = 1 + random_below(&chance, 12);
    const uint16_t width = (uint16_t)(ENCODE_FULL_TURN_Q6 / packets);
    uint32_t from = random_below(&chance, ENCODE_FULL_TURN_Q6);
    size = append(data, size, max_size, 0, (uint16_t)from, 0);
    for (uint32_t i = 0; i < packets; i++, from += width) {
        if (random_below(&chance, 16) != 0) {
            const uint16_t swept = (uint16_t)(width - random_below(&chance, 300) % width);
            size = append(data, size, max_size, (uint8_t)(2 + random_below(&chance, 6)),
                          (uint16_t)(from % ENCODE_FULL_TURN_Q6), swept);
        }
    }
    return size;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    random_seed(&chance, seed);
    const uint32_t kind = random_below(&chance, 8);
    if (size >= SETUP_SIZE && kind == 0) {
        return append_turn(data, size, max_size);
    }
    if (size >= SETUP_SIZE && kind == 1) {
        return append(data, size, max_size, (uint8_t)random_below(&chance, 9),
                      (uint16_t)random_below(&chance, 32768),
                      (uint16_t)random_below(&chance, 9999));
    }
    size = LLVMFuzzerMutate(data, size, max_size);
    if (kind < 6) {
        seal(data, size);
    }
    return size;
}
