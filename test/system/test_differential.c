/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The parser against the reference decoder, on seeded random streams: packets, replies and LastCRC
 * of the independent encoder, with samples that look like headers, with damage as on real lines, in
 * random chunks, through rings of all kinds. Frames, points and counters must be the same. */

#include "effort.h"
#include "encoder.h"
#include "receiver.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define STREAMS 40000u
#define STREAM_MAX 6000u

static uint8_t memory[4096];
static uint8_t bytes[STREAM_MAX];
static uint8_t accepted[STREAM_MAX];
static size_t size;
static receiver_t receiver;
static random_t dice;
static uint32_t seed;

void tearDown(void)
{
    if (Unity.CurrentTestFailed) {
        printf("Again with TMINI_TEST_SEED=%u\n", (unsigned)seed);
    }
}

static bool one_in(uint32_t times)
{
    return random_below(&dice, times) == 0;
}

/* ----------------------------------------------------------------------------- making streams */

/* More than half are bytes of headers, so that the parser meets many false ones. */
static uint8_t any_byte(void)
{
    static const uint8_t likely[] = {0xAA, 0x55, 0xAA, 0x55, 0xA5, 0x5A,
                                     0x00, 0x01, 0x02, 0x03, 0x28, 0x81};
    const uint32_t draw = random_below(&dice, 2u * sizeof likely);
    return draw < sizeof likely ? likely[draw] : (uint8_t)random_below(&dice, 256);
}

static void fill(size_t at, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        bytes[at + i] = any_byte();
    }
}

/* 1 to `most`, but no more than there is room for; 0 if `most` is 0. */
static size_t some(uint32_t most, size_t room)
{
    const size_t count = most > 0 ? random_between(&dice, 1, most) : 0;
    return count < room ? count : room;
}

/* As on a bad line: a bit flipped, or bytes lost, added or overwritten. */
static void damage_one_place(void)
{
    /* Lost and added. */
    static const uint8_t most[][2] = {{1, 0}, {200, 0}, {0, 1}, {0, 32}, {32, 32}};
    const size_t at = random_below(&dice, (uint32_t)size);
    const uint32_t kind = random_below(&dice, 1 + sizeof most / sizeof most[0]);
    if (kind == 0) {
        bytes[at] = (uint8_t)(bytes[at] ^ (1u << random_below(&dice, 8)));
        return;
    }
    const size_t left = size - at;
    const size_t lost = some(most[kind - 1][0], left);
    const size_t added = some(most[kind - 1][1], STREAM_MAX - (size - lost));
    memmove(&bytes[at + added], &bytes[at + lost], left - lost);
    fill(at, added);
    size = size - lost + added;
}

static encode_sample_t any_sample(bool lookalike)
{
    const uint32_t distance = lookalike ? any_byte() * 64u : random_u32(&dice);
    return (encode_sample_t){
        .distance_mm = (uint16_t)(distance & 0x3FFFu),
        .intensity = lookalike ? any_byte() : (uint8_t)random_u32(&dice),
        .flag = (uint8_t)random_below(&dice, 4),
    };
}

/* Puts a valid packet among the samples of a packet. */
static void put_packet_inside(uint8_t *packet, size_t lsn)
{
    uint8_t inner[13];
    const encode_sample_t sample = any_sample(false);
    const encode_packet_t start = {0x79, 1, 10, 10, &sample};
    const size_t length = encode_packet(inner, &start);
    if (3 * lsn > length) {
        memcpy(&packet[10 + random_below(&dice, (uint32_t)(3 * lsn - length))], inner, length);
        encode_seal(packet);
    }
}

static void add_packet(unsigned lsn, bool is_start)
{
    encode_sample_t samples[255];
    const bool lookalike = one_in(3);
    const encode_packet_t packet = {
        .ct = (uint8_t)((random_u32(&dice) & 0xFEu) | (is_start ? 1u : 0u)),
        .lsn = (uint8_t)lsn,
        .first_q6 = (uint16_t)random_below(&dice, 32768),
        .last_q6 = (uint16_t)random_below(&dice, 32768),
        .samples = samples,
    };
    for (unsigned i = 0; i < lsn; i++) {
        samples[i] = any_sample(lookalike);
    }
    if (STREAM_MAX - size >= ENCODE_PACKET_MAX) {
        const size_t at = size;
        size += encode_packet(&bytes[at], &packet);
        if (one_in(5)) {
            put_packet_inside(&bytes[at], lsn);
        }
    }
}

static void add_reply(void)
{
    static const encode_information_t information = {.model = 151, .serial = {2, 0, 2, 5}};
    if (STREAM_MAX - size < ENCODE_REPLY_MAX) {
        return;
    }
    switch (random_below(&dice, 4)) {
    case 0:
        size += encode_scan_reply(&bytes[size]);
        break;
    case 1:
        size += encode_information_reply(&bytes[size], &information);
        break;
    case 2:
        size += encode_health_reply(&bytes[size], 0x22, 0xAA55);
        break;
    default:
        size += encode_frequency_reply(&bytes[size], 600 + random_below(&dice, 600));
        break;
    }
}

static unsigned any_lsn(unsigned max_samples)
{
    const unsigned limit = max_samples < 254 ? max_samples + 1 : 255; /* Sometimes one too many. */
    return one_in(4) ? random_between(&dice, 1, limit)
                     : random_between(&dice, 1, limit < 12 ? limit : 12);
}

static void make_stream(unsigned max_samples)
{
    const bool with_replies = one_in(2);
    size = 0;
    for (unsigned left = random_between(&dice, 1, 60); left > 0; left--) {
        if (one_in(6)) {
            if (one_in(2) && size < STREAM_MAX) {
                bytes[size++] = any_byte();
            }
            add_packet(1, true);
        } else {
            add_packet(any_lsn(max_samples), false);
        }
        if (with_replies && one_in(8)) {
            add_reply();
        }
    }
    for (uint32_t faults = random_below(&dice, 12); faults > 0 && size > 0; faults--) {
        damage_one_place();
    }
}

/* ------------------------------------------------------------------------------------ the setup */

static const reference_reply_t *any_awaited(void)
{
    static const reference_reply_t shapes[] = {
        {1, 0x81, 0}, {0, 0x04, 20}, {0, 0x06, 3}, {0, 0x04, 4}};
    const uint32_t choice = random_below(&dice, 6);
    return choice < 4 ? &shapes[choice] : NULL;
}

/* The smallest ring that can hold packets and replies, or a larger one. Its indices often wrap
 * around soon. */
static void open_any_ring(unsigned max_samples, bool dma)
{
    size_t ring_size = dma ? 64 : 32;
    while (ring_size / (dma ? 2 : 1) < ENCODE_PACKET_HEADER + 3 * max_samples) {
        ring_size *= 2;
    }
    while (ring_size < sizeof memory && one_in(2)) {
        ring_size *= 2;
    }
    if (dma) {
        receiver_open_dma(&receiver, memory, ring_size, (uint8_t)max_samples);
    } else {
        receiver_open(&receiver, memory, ring_size, (uint8_t)max_samples);
    }
    receiver_age(&receiver, (size_t)0 - random_below(&dice, 8000));
}

static unsigned any_max_samples(void)
{
    static const uint8_t limits[] = {1, 2, 5, 40, 80, 80, 80, 82, 255};
    return limits[random_below(&dice, sizeof limits)];
}

/* ----------------------------------------------------------------------------------- the tests */

/* Plays this many streams, every second one with DMA; returns how many times `play` was true. */
static uint32_t each_stream(uint32_t count, bool (*play)(bool dma))
{
    uint32_t times = 0;
    for (uint32_t i = 0; i < count * effort(); i++) {
        seed = effort_seed() + i;
        random_seed(&dice, seed);
        times += play(i % 2 == 0) ? 1 : 0;
    }
    return times;
}

static bool compare_one_stream(bool dma)
{
    const unsigned max_samples = any_max_samples();
    const receiver_course_t course = {
        .chunk = one_in(3) ? random_between(&dice, 1, 5000) : 0,
        .random = &dice,
        .awaited = any_awaited(),
    };
    make_stream(max_samples);
    open_any_ring(max_samples, dma);
    return receiver_compare(&receiver, &course, bytes, size).packets > 0;
}

static bool compare_garbage(bool dma)
{
    const receiver_course_t course = {.random = &dice, .awaited = any_awaited()};
    const unsigned max_samples = any_max_samples();
    size = random_below(&dice, 3000);
    fill(0, size);
    open_any_ring(max_samples, dma);
    return receiver_compare(&receiver, &course, bytes, size).packets > 0;
}

void test_the_parser_finds_what_the_reference_decoder_finds(void)
{
    (void)each_stream(STREAMS, compare_one_stream);
}

void test_the_parser_finds_what_the_reference_decoder_finds_in_garbage(void)
{
    (void)each_stream(STREAMS / 4, compare_garbage);
}

/* ------------------------------------------------------------------------ a ring that overflows */

typedef struct {
    size_t offset; /* Among the bytes that the ring has accepted. */
    size_t length;
    bool is_packet;
} frame_t;

static frame_t frames[STREAM_MAX / 7];
static size_t frame_count;
static size_t matched;

/* Where bytes were refused, as offsets among the accepted bytes: no frame spans such a place. The
 * last entry is the end. */
static size_t gaps[STREAM_MAX + 1];
static size_t gap_count;

static void note_frame(tmini_frame_type_t frame)
{
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    const size_t end =
        counters.bytes_in_packets + counters.bytes_in_replies + counters.bytes_skipped;
    const size_t length =
        tmini_ring_unread(&receiver.ring) - tmini_parser_pending(&receiver.parser);
    frames[frame_count++] = (frame_t){end - length, length, frame == TMINI_FRAME_PACKET};
}

/* Feeds whether or not there is room, and reads sometimes. Returns how many bytes were accepted. */
static size_t feed_carelessly(void)
{
    size_t kept = 0;
    for (size_t fed = 0; fed < size;) {
        const size_t refused = tmini_ring_overrun(&receiver.ring);
        const size_t left = size - fed;
        size_t chunk = random_between(&dice, 1, 300);
        chunk = chunk < left ? chunk : left;
        receiver_feed(&receiver, &bytes[fed], chunk);
        const size_t taken = chunk - (tmini_ring_overrun(&receiver.ring) - refused);
        memcpy(&accepted[kept], &bytes[fed], taken);
        kept += taken;
        if (taken < chunk) {
            gaps[gap_count++] = kept;
        }
        fed += chunk;
        for (uint32_t reads = random_below(&dice, 4); reads > 0; reads--) {
            const tmini_frame_type_t frame = receiver_next(&receiver);
            if (frame != TMINI_FRAME_NONE) {
                note_frame(frame);
            }
        }
    }
    gaps[gap_count++] = kept;
    return kept;
}

/* `context`: the offset at which the decoded part between two gaps begins. */
static void expect_noted(void *context, const reference_item_t *item)
{
    const size_t from = *(const size_t *)context;
    TEST_ASSERT_TRUE(matched < frame_count);
    TEST_ASSERT_EQUAL_UINT(from + item->offset, frames[matched].offset);
    TEST_ASSERT_EQUAL_UINT(item->length, frames[matched].length);
    TEST_ASSERT_EQUAL(item->is_packet, frames[matched].is_packet);
    matched++;
}

static bool overflow_one_stream(bool is_even)
{
    const unsigned max_samples = any_max_samples();
    reference_options_t options = {max_samples, any_awaited()};
    (void)is_even;
    make_stream(max_samples);
    open_any_ring(max_samples, false);
    receiver_await(&receiver, options.awaited);
    frame_count = 0;
    matched = 0;
    gap_count = 0;
    const size_t kept = feed_carelessly();
    for (tmini_frame_type_t frame = receiver_next_at_end(&receiver); frame != TMINI_FRAME_NONE;
         frame = receiver_next_at_end(&receiver)) {
        note_frame(frame);
    }
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    uint32_t checksum_errors = 0;
    uint32_t bytes_skipped = 0;
    size_t from = 0;
    for (size_t i = 0; i < gap_count; from = gaps[i++]) {
        const size_t before = matched;
        const reference_counts_t counts =
            reference_decode(&accepted[from], gaps[i] - from, &options, expect_noted, &from);
        checksum_errors += counts.checksum_errors;
        bytes_skipped += counts.bytes_skipped;
        for (size_t frame = before; frame < matched; frame++) {
            options.awaited = frames[frame].is_packet ? options.awaited : NULL;
        }
    }
    TEST_ASSERT_EQUAL_UINT(frame_count, matched);
    TEST_ASSERT_EQUAL_UINT32(size - kept, counters.bytes_overrun);
    TEST_ASSERT_EQUAL_UINT32(checksum_errors, counters.checksum_errors);
    TEST_ASSERT_EQUAL_UINT32(bytes_skipped, counters.bytes_skipped);
    return counters.bytes_overrun > 0;
}

void test_a_ring_that_overflows_loses_the_refused_bytes_and_nothing_else(void)
{
    TEST_ASSERT_TRUE(each_stream(STREAMS / 4, overflow_one_stream) > STREAMS / 20);
}

/* ---------------------------------------------------------------------------- DMA that overruns */

/* The received bytes at the packet's offset are a valid packet with the same points. */
static void expect_as_received(void)
{
    const size_t offset = receiver_frame_offset(&receiver);
    const reference_options_t options = {receiver.parser.max_samples, NULL};
    tmini_point_t point;
    for (unsigned i = 0; i < receiver.packet.count; i++) {
        const reference_point_t expected = reference_point(&bytes[offset], i);
        if (!tmini_packet_point(&receiver.packet, i, &point)) {
            TEST_ASSERT_FALSE(tmini_frame_intact(tmini_parser_frame(&receiver.parser)));
            return;
        }
        TEST_ASSERT_EQUAL_UINT16(expected.angle_q6, point.angle_q6);
        TEST_ASSERT_EQUAL_UINT16(expected.distance_mm, point.distance_mm);
        TEST_ASSERT_EQUAL_UINT8(expected.intensity, point.intensity);
        TEST_ASSERT_EQUAL_UINT8(expected.flag, point.flag);
    }
    const size_t length = ENCODE_PACKET_HEADER + 3 * (size_t)receiver.packet.count;
    TEST_ASSERT_EQUAL_UINT(1,
                           reference_decode(&bytes[offset], length, &options, NULL, NULL).packets);
}

/* Feeds more while the packet is read: sometimes so much that the ring overruns. */
static size_t feed_some(size_t fed)
{
    const size_t left = size - fed;
    size_t chunk = random_between(&dice, 0, (uint32_t)receiver.size);
    chunk = chunk < left ? chunk : left;
    receiver_feed(&receiver, &bytes[fed], chunk);
    return fed + chunk;
}

static bool overrun_one_stream(bool is_even)
{
    const unsigned max_samples = any_max_samples();
    size_t fed = 0;
    (void)is_even;
    make_stream(max_samples);
    open_any_ring(max_samples, true);
    while (fed < size || tmini_parser_pending(&receiver.parser) > 0) {
        fed = feed_some(fed);
        const tmini_frame_type_t frame =
            fed < size ? receiver_next(&receiver) : receiver_next_at_end(&receiver);
        if (frame == TMINI_FRAME_PACKET) {
            if (one_in(4)) {
                fed = feed_some(fed);
            }
            expect_as_received();
        }
    }
    return receiver_counters(&receiver).bytes_overrun > 0;
}

void test_dma_that_overruns_the_reader_never_makes_a_wrong_point(void)
{
    TEST_ASSERT_TRUE(each_stream(STREAMS / 4, overrun_one_stream) > STREAMS / 20);
}
