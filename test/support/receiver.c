/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "receiver.h"

#include "unity.h"

typedef struct {
    receiver_t *receiver;
    const receiver_course_t *course;
    const uint8_t *bytes;
    size_t size;
    size_t fed;
} run_t;

tmini_parser_counters_t receiver_counters(const receiver_t *receiver)
{
    tmini_parser_counters_t counters;
    tmini_parser_counters(&receiver->parser, &counters);
    return counters;
}

void receiver_check_accounts(const receiver_t *receiver)
{
    const tmini_parser_counters_t counters = receiver_counters(receiver);
    TEST_ASSERT_EQUAL_UINT32(receiver->received,
                             counters.bytes_in_packets + counters.bytes_in_replies +
                                 counters.bytes_skipped + counters.bytes_overrun +
                                 (uint32_t)tmini_parser_pending(&receiver->parser));
}

static void open_receiver(receiver_t *receiver, uint8_t *memory, size_t size, uint8_t max_samples)
{
    receiver->memory = memory;
    receiver->size = size;
    receiver->position = 0;
    receiver->received = 0;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&receiver->ring, memory, size, receiver->dma));
    TEST_ASSERT_EQUAL_INT(TMINI_OK,
                          tmini_parser_init(&receiver->parser, &receiver->ring, max_samples));
}

void receiver_open(receiver_t *receiver, uint8_t *memory, size_t size, uint8_t max_samples)
{
    receiver->dma = false;
    open_receiver(receiver, memory, size, max_samples);
}

void receiver_open_dma(receiver_t *receiver, uint8_t *memory, size_t size, uint8_t max_samples)
{
    receiver->dma = true;
    open_receiver(receiver, memory, size, max_samples);
}

void receiver_age(receiver_t *receiver, size_t count)
{
    receiver->ring.head = count;
    receiver->ring.stop = count;
    receiver->ring.tail = count;
    receiver->position = count % receiver->size;
}

size_t receiver_room(const receiver_t *receiver)
{
    return receiver->ring.window - tmini_ring_unread(&receiver->ring);
}

static void feed_dma(receiver_t *receiver, const uint8_t *bytes, size_t count)
{
    const size_t quarter = receiver->size / 4;
    for (size_t i = 0; i < count; i++) {
        receiver->memory[receiver->position++] = bytes[i];
        if (receiver->position % quarter == 0) {
            tmini_ring_publish(&receiver->ring, receiver->position);
        }
        if (receiver->position == receiver->size) {
            receiver->position = 0;
        }
    }
    tmini_ring_publish(&receiver->ring, receiver->position);
}

void receiver_feed(receiver_t *receiver, const uint8_t *bytes, size_t count)
{
    receiver->received += (uint32_t)count;
    if (receiver->dma) {
        feed_dma(receiver, bytes, count);
    } else {
        tmini_ring_write(&receiver->ring, bytes, count);
    }
}

tmini_frame_type_t receiver_next(receiver_t *receiver)
{
    const bool had_work = tmini_parser_has_work(&receiver->parser);
    tmini_frame_type_t frame;
    do {
        frame = tmini_parser_next(&receiver->parser);
        receiver_check_accounts(receiver);
    } while (frame == TMINI_FRAME_MORE);
    TEST_ASSERT_TRUE(had_work || frame == TMINI_FRAME_NONE);
    TEST_ASSERT_FALSE(frame == TMINI_FRAME_NONE && tmini_parser_has_work(&receiver->parser));
    if (frame == TMINI_FRAME_PACKET) {
        tmini_packet_open(&receiver->packet, tmini_parser_frame(&receiver->parser));
    }
    return frame;
}

static size_t frame_size(const receiver_t *receiver)
{
    return tmini_ring_unread(&receiver->ring) - tmini_parser_pending(&receiver->parser);
}

size_t receiver_frame_offset(const receiver_t *receiver)
{
    return (size_t)receiver->received - tmini_ring_unread(&receiver->ring);
}

void receiver_abandon(receiver_t *receiver)
{
    tmini_parser_abandon(&receiver->parser);
    receiver_check_accounts(receiver);
}

tmini_frame_type_t receiver_next_at_end(receiver_t *receiver)
{
    tmini_frame_type_t frame = receiver_next(receiver);
    while (frame == TMINI_FRAME_NONE && tmini_parser_pending(&receiver->parser) > 0) {
        receiver_abandon(receiver);
        frame = receiver_next(receiver);
    }
    return frame;
}

void receiver_await(receiver_t *receiver, const reference_reply_t *awaited)
{
    if (awaited != NULL) {
        const tmini_reply_header_t header = {awaited->type, awaited->mode,
                                             (uint8_t)awaited->length};
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_parser_await(&receiver->parser, &header));
    }
}

/* ------------------------------------------------------------- comparison with the reference */

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

static size_t next_chunk(const run_t *run)
{
    size_t chunk = run->course->chunk;
    if (chunk == 0) {
        chunk = random_between(run->course->random, 1, 200);
    }
    return smaller(smaller(chunk, receiver_room(run->receiver)), run->size - run->fed);
}

static tmini_frame_type_t next_frame(run_t *run)
{
    tmini_frame_type_t frame = receiver_next(run->receiver);
    while (frame == TMINI_FRAME_NONE && run->fed < run->size) {
        const size_t chunk = next_chunk(run);
        TEST_ASSERT_TRUE(chunk > 0);
        receiver_feed(run->receiver, &run->bytes[run->fed], chunk);
        run->fed += chunk;
        frame = receiver_next(run->receiver);
    }
    return frame == TMINI_FRAME_NONE ? receiver_next_at_end(run->receiver) : frame;
}

static void expect_point(const uint8_t *packet, unsigned index, const tmini_point_t *point)
{
    const reference_point_t expected = reference_point(packet, index);
    TEST_ASSERT_EQUAL_UINT16(expected.angle_q6, point->angle_q6);
    TEST_ASSERT_EQUAL_UINT16(expected.distance_mm, point->distance_mm);
    TEST_ASSERT_EQUAL_UINT8(expected.intensity, point->intensity);
    TEST_ASSERT_EQUAL_UINT8(expected.flag, point->flag);
}

/* One point at a time and many at a time: both must give the same. */
static void expect_points(const tmini_packet_t *packet, const uint8_t *bytes)
{
    tmini_point_t points[80];
    tmini_point_t point;
    const size_t count = tmini_packet_points(packet, TMINI_FILTER_NONE, points, 80);
    bool has_range = false;
    TEST_ASSERT_EQUAL_UINT(smaller(packet->count, 80), count);
    for (unsigned i = 0; i < packet->count; i++) {
        TEST_ASSERT_TRUE(tmini_packet_point(packet, i, &point));
        expect_point(bytes, i, &point);
        if (i < count) {
            expect_point(bytes, i, &points[i]);
        }
        has_range = has_range || point.distance_mm > 0;
    }
    TEST_ASSERT_EQUAL(has_range, tmini_packet_has_range(packet));
}

static void expect_packet(const receiver_t *receiver, const reference_item_t *item)
{
    const tmini_packet_t *const packet = &receiver->packet;
    TEST_ASSERT_EQUAL_UINT8(item->ct, packet->ct);
    TEST_ASSERT_EQUAL_UINT8(item->lsn, packet->count);
    TEST_ASSERT_EQUAL_UINT16((item->fsa >> 1) % 23040u, packet->first_angle_q6);
    TEST_ASSERT_EQUAL_UINT16((item->lsa >> 1) % 23040u, packet->last_angle_q6);
    TEST_ASSERT_EQUAL(item->starts_revolution, tmini_packet_is_start(packet));
    TEST_ASSERT_TRUE(tmini_frame_intact(tmini_parser_frame(&receiver->parser)));
    expect_points(packet, item->bytes);
}

static void expect_reply(const receiver_t *receiver, const reference_item_t *item)
{
    uint8_t content[32];
    const size_t count = smaller(item->length - 7u, sizeof content);
    (void)tmini_frame_content(tmini_parser_frame(&receiver->parser), content, count);
    if (count > 0) {
        TEST_ASSERT_EQUAL_HEX8_ARRAY(&item->bytes[7], content, count);
    }
}

static void expect_item(void *context, const reference_item_t *item)
{
    run_t *const run = context;
    const receiver_t *const receiver = run->receiver;
    const tmini_frame_type_t frame = next_frame(run);
    TEST_ASSERT_EQUAL_INT(item->is_packet ? TMINI_FRAME_PACKET : TMINI_FRAME_REPLY, frame);
    TEST_ASSERT_EQUAL_UINT(item->length, frame_size(receiver));
    TEST_ASSERT_EQUAL_UINT(item->offset, run->fed - tmini_ring_unread(&receiver->ring));
    if (!item->is_packet) {
        expect_reply(receiver, item);
        return;
    }
    expect_packet(receiver, item);
    if (run->course->on_packet != NULL) {
        run->course->on_packet(&receiver->packet);
    }
}

static void expect_counters(const receiver_t *receiver, const reference_counts_t *expected)
{
    const tmini_parser_counters_t counters = receiver_counters(receiver);
    TEST_ASSERT_EQUAL_UINT32(expected->packets, counters.packets);
    TEST_ASSERT_EQUAL_UINT32(expected->checksum_errors, counters.checksum_errors);
    TEST_ASSERT_EQUAL_UINT32(expected->bytes_in_packets, counters.bytes_in_packets);
    TEST_ASSERT_EQUAL_UINT32(expected->bytes_in_replies, counters.bytes_in_replies);
    TEST_ASSERT_EQUAL_UINT32(expected->bytes_skipped, counters.bytes_skipped);
    TEST_ASSERT_EQUAL_UINT32(0, counters.bytes_overrun);
}

reference_counts_t receiver_compare(receiver_t *receiver, const receiver_course_t *course,
                                    const uint8_t *bytes, size_t size)
{
    const reference_options_t options = {receiver->parser.max_samples, course->awaited};
    run_t run = {receiver, course, bytes, size, 0};
    receiver_await(receiver, course->awaited);
    const reference_counts_t counts = reference_decode(bytes, size, &options, expect_item, &run);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, next_frame(&run));
    TEST_ASSERT_EQUAL_UINT(0, tmini_parser_pending(&receiver->parser));
    expect_counters(receiver, &counts);
    return counts;
}
