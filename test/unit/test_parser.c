/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The packets and replies that the parser finds in a stream, whatever the chunks and the damage.
 * receiver.c asserts at every step that each byte is accounted for. */

#include "known_packets.h"
#include "receiver.h"
#include "rows.h"
#include "stream.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static uint8_t memory[1024];
static uint8_t bytes[900];
static stream_t stream;
static receiver_t receiver;

/* Replies from section 4 and from real units. */
static const uint8_t start_reply[7] = {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
static const uint8_t health_reply[10] = {0xA5, 0x5A, 0x03, 0, 0, 0, 0x06, 0x20, 0x11, 0x22};
static const uint8_t frequency_reply[11] = {0xA5, 0x5A, 0x04, 0, 0, 0, 0x04, 0x58, 0x02, 0, 0};
static const uint8_t info_reply[27] = {0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, 0x97, 2, 1, 1, 2, 0, 2,
                                       5,    0,    4,    2, 4, 0, 0,    0,    9, 0, 1, 9, 4};

void setUp(void)
{
    stream = (stream_t){bytes, 0, sizeof bytes};
    memset(memory, 0, sizeof memory);
    receiver_open(&receiver, memory, 256, 0);
}

void tearDown(void) {}

static void feed(const uint8_t *more, size_t count)
{
    receiver_feed(&receiver, more, count);
}

static void feed_byte(uint8_t byte)
{
    receiver_feed(&receiver, &byte, 1);
}

static void expect_frame(tmini_frame_type_t expected)
{
    TEST_ASSERT_EQUAL_INT(expected, receiver_next(&receiver));
}

/* The next frame is a packet of `count` samples that began at `offset`. */
static void expect_packet(uint8_t count, size_t offset)
{
    expect_frame(TMINI_FRAME_PACKET);
    TEST_ASSERT_EQUAL_UINT8(count, receiver.packet.count);
    TEST_ASSERT_EQUAL_UINT(offset, receiver_frame_offset(&receiver));
}

static void expect_packet_after_gap(uint16_t gap)
{
    expect_frame(TMINI_FRAME_PACKET);
    TEST_ASSERT_EQUAL_UINT16(gap, receiver.packet.gap);
}

static void expect_nothing(void)
{
    expect_frame(TMINI_FRAME_NONE);
}

static void expect_skipped(uint32_t count)
{
    TEST_ASSERT_EQUAL_UINT32(count, receiver_counters(&receiver).bytes_skipped);
}

static void expect_pending(size_t count)
{
    TEST_ASSERT_EQUAL_UINT(count, tmini_parser_pending(&receiver.parser));
}

static void expect_reply(size_t offset, const uint8_t *reply, size_t content)
{
    uint8_t copy[21];
    memset(copy, 0xEE, sizeof copy);
    expect_frame(TMINI_FRAME_REPLY);
    TEST_ASSERT_EQUAL_UINT(offset, receiver_frame_offset(&receiver));
    (void)tmini_frame_content(tmini_parser_frame(&receiver.parser), copy, content);
    if (content > 0) {
        TEST_ASSERT_EQUAL_HEX8_ARRAY(&reply[7], copy, content);
    }
    TEST_ASSERT_EQUAL_HEX8(0xEE, copy[content]);
    TEST_ASSERT_EQUAL_UINT32(7 + content, receiver_counters(&receiver).bytes_in_replies);
    expect_skipped((uint32_t)offset);
}

/* ---------------------------------------------------------------------------------------- init */

static tmini_status_t init_with(size_t ring_size, bool dma, uint8_t max_samples)
{
    tmini_ring_t ring;
    tmini_parser_t parser;
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, ring_size, dma));
    return tmini_parser_init(&parser, &ring, max_samples);
}

void test_null_pointers_are_an_argument_error(void)
{
    tmini_parser_t parser;
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_parser_init(NULL, &receiver.ring, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_parser_init(&parser, NULL, 0));
}

void test_a_ring_that_failed_to_initialise_is_an_argument_error(void)
{
    tmini_parser_t parser;
    tmini_ring_t ring;
    (void)tmini_ring_init(&ring, memory, 0, false);
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_parser_init(&parser, &ring, 1));
}

void test_the_ring_must_hold_the_largest_packet(void)
{
    /* The default, 80 samples, needs 250 bytes. */
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(128, false, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(256, false, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(256, false, 82)); /* 256 bytes. */
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(256, false, 83));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(512, false, 255)); /* 775 bytes. */
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(1024, false, 255));
}

/* Otherwise an awaited reply could never be complete: device information has 27 bytes. */
void test_the_ring_must_hold_the_longest_reply(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(16, false, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(32, false, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(32, true, 1));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(64, true, 1));
}

void test_half_a_dma_ring_must_hold_the_largest_packet(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(256, true, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(512, true, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, init_with(64, true, 7)); /* 31 bytes. */
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, init_with(64, true, 8));
}

/* ------------------------------------------------------------------------------- refused bytes */

static void next_is_a_packet_after_a_gap_of(uint16_t gap)
{
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, tmini_parser_next(&receiver.parser));
    tmini_packet_t packet;
    tmini_packet_open(&packet, tmini_parser_frame(&receiver.parser));
    TEST_ASSERT_EQUAL_UINT16(gap, packet.gap);
}

/* Ten packets of 25 bytes and 6 other bytes fill the ring, so the eleventh packet is refused. The
 * twelfth is also refused although there is room, because the eleventh is missing before it. */
void test_refused_bytes_leave_a_gap_where_they_are_missing(void)
{
    static const uint8_t others[6] = {0};
    static const encode_sample_t samples[5] = {{1000, 50, 0}};
    const encode_packet_t packet = {0, 5, 640, 1280, samples};
    uint8_t one[25];
    TEST_ASSERT_EQUAL_UINT(25, encode_packet(one, &packet));
    receiver_open(&receiver, memory, 256, 0);
    tmini_ring_write(&receiver.ring, others, sizeof others);
    for (unsigned i = 0; i < 11; i++) {
        tmini_ring_write(&receiver.ring, one, sizeof one);
    }
    next_is_a_packet_after_a_gap_of(6);
    for (unsigned i = 1; i < 10; i++) {
        tmini_ring_write(&receiver.ring, one, i == 3 ? sizeof one : 0);
        next_is_a_packet_after_a_gap_of(0);
    }
    TEST_ASSERT_EQUAL_UINT32(50, receiver_counters(&receiver).bytes_overrun);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, tmini_parser_next(&receiver.parser));
    tmini_ring_write(&receiver.ring, one, sizeof one);
    next_is_a_packet_after_a_gap_of(65535);
    TEST_ASSERT_EQUAL_UINT32(50, receiver_counters(&receiver).bytes_overrun);
}

/* ------------------------------------------------------------------------------------- packets */

void test_a_packet_is_delivered_with_its_last_byte_and_not_before(void)
{
    for (size_t i = 0; i < 66; i++) {
        feed_byte(manual_packet[i]);
        expect_nothing();
        expect_pending(i + 1);
    }
    feed_byte(manual_packet[66]);
    expect_packet(19, 0);
    expect_pending(0);
}

/* There is work after the first byte, the packet header AA 55, the whole header and the last
 * byte. */
void test_a_candidate_is_no_work_until_it_can_be_looked_at_further(void)
{
    size_t moments[4] = {0};
    size_t count = 0;
    for (size_t i = 0; i < sizeof start_packet; i++) {
        feed_byte(start_packet[i]);
        if (tmini_parser_has_work(&receiver.parser)) {
            moments[count++] = i + 1;
            (void)receiver_next(&receiver);
        }
    }
    TEST_ASSERT_EQUAL_UINT(4, count);
    TEST_ASSERT_EQUAL_UINT(1, moments[0]);
    TEST_ASSERT_EQUAL_UINT(2, moments[1]);
    TEST_ASSERT_EQUAL_UINT(10, moments[2]);
    TEST_ASSERT_EQUAL_UINT(13, moments[3]);
}

/* Feeds garbage in pieces that fit into the ring together with an earlier frame. */
static void skip_garbage(uint32_t count)
{
    const uint32_t skipped = receiver_counters(&receiver).bytes_skipped;
    memset(bytes, 0, 200);
    for (uint32_t left = count; left > 0;) {
        const size_t piece = left < 200 ? (size_t)left : 200;
        feed(bytes, piece);
        expect_nothing();
        left -= (uint32_t)piece;
    }
    expect_skipped(skipped + count);
}

void test_a_gap_is_counted_up_to_65535(void)
{
    skip_garbage(65534);
    feed(start_packet, 13);
    expect_packet(1, 65534);
    TEST_ASSERT_EQUAL_UINT16(65534, receiver.packet.gap);
    skip_garbage(65535);
    feed(start_packet, 13);
    expect_packet_after_gap(65535);
    skip_garbage(65537);
    feed(start_packet, 13);
    expect_packet_after_gap(65535);
}

/* -------------------------------------------------------------------------- invalid packets */

/* The packet in `bytes` is rejected, but the next packet is found. */
static void expect_rejected(uint32_t checksum_errors)
{
    receiver_open(&receiver, memory, 256, 0);
    feed(bytes, stream.size);
    feed(start_packet, 13);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next_at_end(&receiver));
    TEST_ASSERT_EQUAL_UINT(stream.size, receiver_frame_offset(&receiver));
    TEST_ASSERT_EQUAL_UINT32(checksum_errors, receiver_counters(&receiver).checksum_errors);
    expect_skipped((uint32_t)stream.size);
}

void test_a_wrong_checksum_costs_one_byte_and_is_counted(void)
{
    stream_add(&stream, manual_packet, 67);
    bytes[8] ^= 0x01;
    expect_rejected(1);
    bytes[8] ^= 0x01;
    bytes[9] ^= 0x80;
    expect_rejected(1);
}

void test_each_part_of_a_packet_counts_in_its_checksum(void)
{
    static const uint8_t places[] = {2, 5, 7, 10, 11, 12, 64, 65, 66};
    for (size_t i = 0; i < sizeof places; i++) {
        stream.size = 0;
        stream_add(&stream, manual_packet, 67);
        bytes[places[i]] ^= 0x40;
        expect_rejected(1);
    }
}

void test_a_packet_without_samples_is_not_taken(void)
{
    const encode_packet_t packet = {0x20, 0, 100, 100, NULL};
    stream.size = encode_packet(bytes, &packet);
    TEST_ASSERT_EQUAL_UINT(10, stream.size);
    expect_rejected(0);
}

void test_a_check_bit_of_0_makes_no_packet_even_with_a_right_checksum(void)
{
    (void)stream_add_packet(&stream, 0, 3, 100, 200);
    bytes[4] &= 0xFE;
    encode_seal(bytes);
    expect_rejected(0);
    bytes[4] |= 1;
    bytes[6] &= 0xFE;
    encode_seal(bytes);
    expect_rejected(0);
}

void test_a_start_packet_of_two_samples_is_not_taken(void)
{
    (void)stream_add_packet(&stream, 0x79, 2, 100, 200);
    expect_rejected(0);
}

static bool accepts(uint8_t max_samples, uint8_t samples)
{
    stream.size = 0;
    (void)stream_add_packet(&stream, 0, samples, 0, 1000);
    receiver_open(&receiver, memory, 1024, max_samples);
    feed(bytes, stream.size);
    return receiver_next_at_end(&receiver) == TMINI_FRAME_PACKET;
}

void test_packets_may_have_up_to_the_configured_number_of_samples(void)
{
    TEST_ASSERT_TRUE(accepts(1, 1));
    TEST_ASSERT_FALSE(accepts(1, 2));
    TEST_ASSERT_TRUE(accepts(40, 40));
    TEST_ASSERT_FALSE(accepts(40, 41));
    TEST_ASSERT_TRUE(accepts(80, 80));
    TEST_ASSERT_FALSE(accepts(80, 81));
    TEST_ASSERT_TRUE(accepts(254, 254));
    TEST_ASSERT_FALSE(accepts(254, 255));
    TEST_ASSERT_TRUE(accepts(255, 255));
    TEST_ASSERT_TRUE(accepts(0, 80)); /* The default is 80. */
    TEST_ASSERT_FALSE(accepts(0, 81));
}

void test_a_packet_that_fills_the_ring_is_found(void)
{
    receiver_open(&receiver, memory, 256, 82);
    (void)stream_add_packet(&stream, 0, 82, 0, 5000);
    feed(bytes, 255);
    expect_nothing();
    TEST_ASSERT_EQUAL_UINT(1, receiver_room(&receiver));
    feed(&bytes[255], 1);
    expect_packet(82, 0);
}

/* ----------------------------------------------------------------------------------- corruption */

/* A short stream with everything that occurs in a revolution: start packets, LastCRC, a point
 * packet of one sample with FSA > LSA. These are the offsets and sizes of its packets. */
#define PACKETS 6
static const uint8_t places[PACKETS] = {0, 13, 32, 49, 62, 75};
static const uint8_t sizes[PACKETS] = {13, 19, 16, 13, 13, 16};

static void make_turn(void)
{
    stream.size = 0;
    (void)stream_add_packet(&stream, 0x79, 1, 0, 0);
    (void)stream_add_packet(&stream, 0x40, 3, 34, 102);
    (void)stream_add_packet(&stream, 0x00, 2, 22900, 17);
    stream_add_byte(&stream, 0xAA); /* LastCRC. */
    (void)stream_add_packet(&stream, 0x7B, 1, 17, 17);
    (void)stream_add_packet(&stream, 0x40, 1, 57, 50);
    (void)stream_add_packet(&stream, 0x00, 2, 81, 115);
    TEST_ASSERT_EQUAL_UINT(91, stream.size);
}

/* Returns a bit for each packet of the turn that is found at its place. Places at or after `from`
 * are expected to have moved by `moved`. */
static unsigned found_packets(size_t from, int moved)
{
    unsigned found = 0;
    receiver_open(&receiver, memory, 256, 0);
    feed(bytes, stream.size);
    while (receiver_next_at_end(&receiver) != TMINI_FRAME_NONE) {
        for (unsigned i = 0; i < PACKETS; i++) {
            const size_t place = places[i] + (size_t)(places[i] >= from ? moved : 0);
            found |= (unsigned)(receiver_frame_offset(&receiver) == place) << i;
        }
    }
    return found;
}

/* A bit for each packet (0x3F: all), without the packet that contains the byte at `place`. */
static unsigned all_but_hit(size_t place)
{
    unsigned found = 0x3F;
    for (unsigned i = 0; i < PACKETS; i++) {
        if (place >= places[i] && place < (size_t)places[i] + sizes[i]) {
            found &= ~(1u << i);
        }
    }
    return found;
}

/* Frames, points and counters are those of the reference decoder, with chunks of this size. */
static void expect_like_reference(size_t chunk)
{
    const receiver_course_t course = {.chunk = chunk};
    receiver_open(&receiver, memory, 256, 0);
    (void)receiver_compare(&receiver, &course, bytes, stream.size);
}

void test_a_changed_byte_costs_no_packet_but_its_own(void)
{
    static const uint8_t values[] = {0x00, 0x01, 0x02, 0x50, 0x55, 0xA5, 0xAA, 0xFF};
    make_turn();
    for (size_t place = 0; place < stream.size; place++) {
        const uint8_t original = bytes[place];
        for (size_t i = 0; i < sizeof values; i++) {
            if (values[i] != original) {
                bytes[place] = values[i];
                TEST_ASSERT_EQUAL_HEX(all_but_hit(place), found_packets(0, 0));
            }
        }
        expect_like_reference(1 + place % 40); /* Only with the last value; test/system has all. */
        bytes[place] = original;
    }
}

void test_a_lost_byte_costs_no_packet_but_its_own(void)
{
    for (size_t place = 0; place < 91; place++) {
        make_turn();
        memmove(&bytes[place], &bytes[place + 1], stream.size - place - 1);
        stream.size--;
        TEST_ASSERT_EQUAL_HEX(all_but_hit(place), found_packets(place + 1, -1));
        expect_like_reference(7);
    }
}

void test_an_extra_byte_costs_no_packet_but_the_one_it_comes_into(void)
{
    static const uint8_t values[] = {0x00, 0x01, 0x55, 0xA5, 0xAA, 0xFF};
    for (size_t place = 0; place <= 91; place++) {
        for (size_t i = 0; i < sizeof values; i++) {
            make_turn();
            memmove(&bytes[place + 1], &bytes[place], stream.size - place);
            bytes[place] = values[i];
            stream.size++;
            unsigned expected = 0x3F;
            for (unsigned k = 0; k < PACKETS; k++) {
                if (place > places[k] && place < (size_t)places[k] + sizes[k]) {
                    expected &= ~(1u << k);
                }
            }
            TEST_ASSERT_EQUAL_HEX(expected, found_packets(place, 1));
        }
        expect_like_reference(5);
    }
}

void test_a_stream_cut_anywhere_keeps_its_whole_packets(void)
{
    for (size_t size = 0; size <= 91; size++) {
        unsigned expected = 0;
        make_turn();
        stream.size = size;
        for (unsigned i = 0; i < PACKETS; i++) {
            expected |= (unsigned)(places[i] + (size_t)sizes[i] <= size) << i;
        }
        TEST_ASSERT_EQUAL_HEX(expected, found_packets(0, 0));
    }
}

void test_a_packet_cut_anywhere_costs_no_other_packet(void)
{
    for (size_t size = 1; size < 67; size++) {
        stream.size = 0;
        stream_add(&stream, start_packet, 13);
        stream_add(&stream, manual_packet, size);
        stream_add(&stream, start_packet, 13);
        stream_add(&stream, manual_packet, 67);
        receiver_open(&receiver, memory, 256, 0);
        feed(bytes, stream.size);
        expect_packet(1, 0);
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next_at_end(&receiver));
        TEST_ASSERT_EQUAL_UINT(13 + size, receiver_frame_offset(&receiver));
        expect_packet(19, 26 + size);
        expect_skipped((uint32_t)size);
    }
}

/* The LSN of a packet of 19 samples is damaged to every other value. */
void test_a_corrupted_length_does_not_cost_the_next_packet(void)
{
    for (unsigned lsn = 0; lsn < 512; lsn++) {
        if (lsn % 256 == 19) {
            continue;
        }
        stream.size = 0;
        stream_add(&stream, manual_packet, 67);
        bytes[3] = (uint8_t)lsn;
        stream_add(&stream, start_packet, 13);
        stream_add(&stream, manual_packet, 67);
        receiver_open(&receiver, memory, 1024,
                      lsn < 256 ? 0 : 255); /* At most 80 samples, or 255. */
        feed(bytes, stream.size);
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next_at_end(&receiver));
        TEST_ASSERT_EQUAL_UINT(67, receiver_frame_offset(&receiver));
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next_at_end(&receiver));
        TEST_ASSERT_EQUAL_UINT(80, receiver_frame_offset(&receiver));
        expect_skipped(67);
    }
}

/* A packet whose samples contain the header of a packet of 40 samples, then a whole packet. */
static void make_packet_with_packet_inside(void)
{
    static const uint8_t false_header[12] = {0xAA, 0x55, 0x00, 0x28, 0x01, 0x00,
                                             0x41, 0x01, 0x00, 0x00, 0x00, 0x00};
    const encode_packet_t outer = {0x20, 9, 100, 900, NULL};
    encode_packet_header(bytes, &outer);
    memcpy(&bytes[10], false_header, 12);
    memcpy(&bytes[22], start_packet, 13);
    memset(&bytes[35], 0x33, 2);
    encode_seal(bytes);
    stream.size = 37;
}

void test_headers_and_packets_inside_a_valid_packet_are_its_samples(void)
{
    make_packet_with_packet_inside();
    feed(bytes, 37);
    feed(start_packet, 13);
    expect_packet(9, 0);
    expect_packet(1, 37);
    expect_nothing();
    expect_skipped(0);
}

void test_inside_a_damaged_packet_a_false_header_hides_nothing(void)
{
    make_packet_with_packet_inside();
    bytes[8] ^= 1;
    feed(bytes, 37);
    expect_nothing();
    expect_pending(27); /* The false header needs 130 bytes. */
    feed(manual_packet, 67);
    feed(manual_packet, 67);
    expect_packet(1, 22);
    TEST_ASSERT_EQUAL_UINT32(2, receiver_counters(&receiver).checksum_errors);
    expect_packet(19, 37);
    expect_packet(19, 104);
}

/* -------------------------------------------------------------------------------- chunking */

void test_the_same_frames_are_found_whatever_the_chunks(void)
{
    make_turn();
    bytes[16] ^= 4; /* One packet damaged, and garbage at the end. */
    stream_add(&stream, manual_packet, 30);
    stream_add(&stream, start_packet, 13);
    for (size_t chunk = 1; chunk <= stream.size; chunk++) {
        expect_like_reference(chunk);
    }
}

void test_the_same_frames_are_found_wherever_they_lie_in_the_ring(void)
{
    const receiver_course_t course = {.chunk = 11};
    make_turn();
    for (size_t start = 0; start < 256; start++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_age(&receiver, start);
        (void)receiver_compare(&receiver, &course, bytes, stream.size);
    }
}

void test_the_same_frames_are_found_while_the_rings_indices_wrap(void)
{
    const receiver_course_t course = {.chunk = 9};
    make_turn();
    for (size_t before = 0; before <= 92; before++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_age(&receiver, (size_t)0 - before);
        (void)receiver_compare(&receiver, &course, bytes, stream.size);
    }
}

/* ------------------------------------------------------------------------------------- replies */

void test_a_reply_is_delivered_with_its_last_byte_and_not_before(void)
{
    receiver_await(&receiver, 0, 0x04, 20);
    for (size_t i = 0; i < 26; i++) {
        feed_byte(info_reply[i]);
        expect_nothing();
        expect_pending(i + 1);
    }
    feed_byte(info_reply[26]);
    expect_reply(0, info_reply, 20);
    expect_pending(0);
}

void test_a_reply_lies_anywhere_in_the_ring(void)
{
    for (size_t start = 220; start <= 256; start++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_age(&receiver, start);
        receiver_await(&receiver, 0, 0x04, 20);
        feed(info_reply, 27);
        expect_reply(0, info_reply, 20);
    }
}

static void expect_no_reply(const uint8_t *reply, size_t size)
{
    feed(reply, size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next_at_end(&receiver));
    TEST_ASSERT_EQUAL_UINT32(0, receiver_counters(&receiver).bytes_in_replies);
}

void test_every_bit_of_the_length_is_compared(void)
{
    for (unsigned bit = 0; bit < 30; bit++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_await(&receiver, 0, 0x06, 3);
        memcpy(bytes, health_reply, 10);
        bytes[2 + bit / 8] ^= (uint8_t)(1u << bit % 8);
        expect_no_reply(bytes, 10);
    }
}

void test_an_awaited_shape_is_copied(void)
{
    tmini_reply_header_t shape = {.type = 0x06, .mode = 0, .length = 3};
    tmini_parser_await(&receiver.parser, &shape);
    shape.type = 0x04;
    feed(health_reply, 10);
    expect_frame(TMINI_FRAME_REPLY);
}

void test_a_packet_inside_an_awaited_reply_is_its_content(void)
{
    receiver_await(&receiver, 0, 0x04, 20);
    memcpy(bytes, info_reply, 27);
    memcpy(&bytes[10], start_packet, 13);
    feed(bytes, 27);
    expect_reply(0, bytes, 20);
    expect_nothing();
}

/* ------------------------------------------------------------------------------------- abandon */

/* The header is that of a packet of 100 samples, 310 bytes. */
static void feed_256_bytes_of_310(void)
{
    receiver_open(&receiver, memory, 512, 100);
    memset(bytes, 0, 256);
    memcpy(bytes, manual_packet, 10);
    bytes[3] = 100;
    feed(bytes, 256);
    expect_nothing();
    expect_pending(256);
}

void test_a_candidate_of_256_bytes_can_be_abandoned_or_cut_off_by_a_gap(void)
{
    feed_256_bytes_of_310();
    receiver_abandon(&receiver);
    expect_skipped(256);
    feed_256_bytes_of_310();
    tmini_ring_gap(&receiver.ring);
    expect_nothing();
    expect_skipped(256);
}

/* ----------------------------------------------------------------------------------------- DMA */

static void open_dma(void)
{
    receiver_open_dma(&receiver, memory, 512, 0);
}

void test_a_dma_ring_gives_the_same_frames_wherever_they_lie(void)
{
    const receiver_course_t course = {.chunk = 23};
    make_turn();
    for (size_t start = 0; start < 512; start += 3) {
        open_dma();
        receiver_age(&receiver, start);
        (void)receiver_compare(&receiver, &course, bytes, stream.size);
    }
}

void test_a_dma_ring_gives_the_same_frames_while_its_indices_wrap(void)
{
    const receiver_course_t course = {.chunk = 23};
    make_turn();
    for (size_t before = 0; before <= 92; before++) {
        open_dma();
        receiver_age(&receiver, (size_t)0 - before);
        (void)receiver_compare(&receiver, &course, bytes, stream.size);
    }
}

/* ------------------------------------------------------------------------------------ counters */

void test_counters_wrap_around_modulo_2_to_the_32(void)
{
    receiver.parser.counters.packets = UINT32_MAX;
    receiver.parser.counters.bytes_in_packets = UINT32_MAX - 10;
    receiver.received = UINT32_MAX - 10;
    feed(start_packet, 13);
    expect_frame(TMINI_FRAME_PACKET);
    TEST_ASSERT_EQUAL_UINT32(0, receiver_counters(&receiver).packets);
    TEST_ASSERT_EQUAL_UINT32(2, receiver_counters(&receiver).bytes_in_packets);
}

void test_a_reply_longer_than_the_ring_is_not_awaited(void)
{
    const tmini_reply_header_t header = {.type = 0x04, .mode = 0, .length = 250};
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_parser_await(&receiver.parser, &header));
    static const uint8_t reply[] = {0xA5, 0x5A, 250, 0x00, 0x00, 0x00, 0x04};
    feed(reply, sizeof reply);
    expect_nothing();
    expect_pending(0);
    const tmini_reply_header_t longest = {.type = 0x04, .mode = 0, .length = 249};
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_parser_await(&receiver.parser, &longest));
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows below:
 *
 *     <start <manual <info <health <frequency <scan    these bytes come; <manual:40: the first 40;
 *                     <manual+40: what follows them
 *     <x:AA55 <zeros:300      these bytes
 *     !19@0           the next frame is a packet of 19 samples, which began at this offset
 *     !health@4       the next frame is this reply; 4 bytes before it have been skipped
 *     !none           there is no frame; !end: nor will there be, if no more bytes come
 *     await:0:06:3    a reply of this mode, type and length is awaited; await:none
 *     skipped:9 pending:0 …   see number_named() */

static const struct {
    const char *name;
    const uint8_t *bytes;
    size_t size;
} sources[] = {
    {"start", start_packet, sizeof start_packet},
    {"manual", manual_packet, sizeof manual_packet},
    {"info", info_reply, sizeof info_reply},
    {"health", health_reply, sizeof health_reply},
    {"frequency", frequency_reply, sizeof frequency_reply},
    {"scan", start_reply, sizeof start_reply},
};

static unsigned source_named(const char *word)
{
    const size_t length = strcspn(word, ":+@");
    unsigned i = 0;
    while (strncmp(sources[i].name, word, length) != 0 || sources[i].name[length] != '\0') {
        i++;
        TEST_ASSERT_TRUE_MESSAGE(i < sizeof sources / sizeof sources[0], word);
    }
    return i;
}

static void tell_feed(const char *word)
{
    const char *const at = word + strcspn(word, ":+");
    const size_t number = at[0] != '\0' ? (size_t)strtoul(at + 1, NULL, 10) : 0;
    if (strncmp(word, "x:", 2) == 0) {
        for (const char *digits = at + 1; digits[0] != '\0'; digits += 2) {
            const char pair[3] = {digits[0], digits[1], '\0'};
            feed_byte((uint8_t)strtoul(pair, NULL, 16));
        }
    } else if (strncmp(word, "zeros:", 6) == 0) {
        memset(bytes, 0, number);
        feed(bytes, number);
    } else {
        const unsigned i = source_named(word);
        const size_t from = at[0] == '+' ? number : 0;
        feed(sources[i].bytes + from, (at[0] == ':' ? number : sources[i].size) - from);
    }
}

static void tell_frame(const char *word)
{
    const char *const at = strchr(word, '@');
    const size_t offset = at != NULL ? (size_t)strtoul(at + 1, NULL, 10) : 0;
    if (strcmp(word, "none") == 0) {
        expect_nothing();
    } else if (strcmp(word, "end") == 0) {
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next_at_end(&receiver));
    } else if (strcmp(word, "reply") == 0) {
        expect_frame(TMINI_FRAME_REPLY);
    } else if (at == NULL) {
        expect_frame(TMINI_FRAME_PACKET);
        TEST_ASSERT_EQUAL_UINT8(strtoul(word, NULL, 10), receiver.packet.count);
    } else if (word[0] >= '0' && word[0] <= '9') {
        expect_packet((uint8_t)strtoul(word, NULL, 10), offset);
    } else {
        const unsigned i = source_named(word);
        const bool is_continuous = sources[i].bytes == start_reply;
        expect_reply(offset, sources[i].bytes, is_continuous ? 0 : sources[i].size - 7);
    }
}

static void tell_await(const char *word)
{
    char *rest;
    if (strcmp(word, "none") == 0) {
        (void)tmini_parser_await(&receiver.parser, NULL);
        return;
    }
    const unsigned long mode = strtoul(word, &rest, 10);
    const unsigned long type = strtoul(rest + 1, &rest, 16);
    receiver_await(&receiver, (uint8_t)mode, (uint8_t)type, (uint8_t)strtoul(rest + 1, NULL, 10));
}

static size_t number_named(const char *word)
{
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    const tmini_frame_t *const frame = tmini_parser_frame(&receiver.parser);
    const struct {
        const char *name;
        size_t number;
    } numbers[] = {
        {"skipped:", counters.bytes_skipped},
        {"pending:", tmini_parser_pending(&receiver.parser)},
        {"packets:", counters.packets},
        {"in-packets:", counters.bytes_in_packets},
        {"in-replies:", counters.bytes_in_replies},
        {"errors:", counters.checksum_errors},
        {"overrun:", counters.bytes_overrun},
        {"unread:", tmini_ring_unread(&receiver.ring)},
        {"room:", receiver_room(&receiver)},
        {"work:", tmini_parser_has_work(&receiver.parser)},
        {"intact:", tmini_frame_intact(frame)},
        {"gap:", receiver.packet.gap},
        {"last:", frame->last_skipped},
    };
    unsigned i = 0;
    while (strncmp(numbers[i].name, word, strlen(numbers[i].name)) != 0) {
        i++;
        TEST_ASSERT_TRUE_MESSAGE(i < sizeof numbers / sizeof numbers[0], word);
    }
    return numbers[i].number;
}

static void tell_word(char *word)
{
    if (word[0] == '<') {
        tell_feed(word + 1);
    } else if (word[0] == '!') {
        tell_frame(word + 1);
    } else if (strcmp(word, "dma") == 0) {
        receiver_open_dma(&receiver, memory, 512, 0);
    } else if (strcmp(word, "lap") == 0) { /* Was perhaps missed; it counts 512 bytes. */
        tmini_ring_gap(&receiver.ring);
        receiver.received += 512;
    } else if (strcmp(word, "gap") == 0) {
        tmini_ring_gap(&receiver.ring);
    } else if (strcmp(word, "abandon") == 0) {
        receiver_abandon(&receiver);
    } else if (strcmp(word, "skip-all") == 0) {
        tmini_parser_skip_all(&receiver.parser);
    } else if (strcmp(word, "await-again") == 0) {
        tmini_parser_await_again(&receiver.parser);
    } else if (strncmp(word, "await:", 6) == 0) {
        tell_await(word + 6);
    } else {
        TEST_ASSERT_EQUAL_UINT_MESSAGE(strtoul(strchr(word, ':') + 1, NULL, 0), number_named(word),
                                       word);
    }
}

static void tell_row(const row_t *row)
{
    row_tell(row->steps, tell_word);
}

#define GARBAGE "<x:0055AAA55AAA5455FF "
#define AWAIT_INFO "await:0:04:20 "
#define AWAIT_HEALTH "await:0:06:3 "
#define AWAIT_FREQUENCY "await:0:04:4 "
#define AWAIT_SCAN "await:1:81:0 "
#define NO_REPLY "!end in-replies:0 "

static const row_t rows[] IN_FLASH = {
    /* ---- Packets ---- */
    ROW(the_manuals_packet_is_found,
        "<manual !19@0 packets:1 in-packets:67 errors:0 skipped:0 pending:0 !none"),
    ROW(nothing_is_found_where_nothing_has_come, "!none pending:0"),
    ROW(a_byte_after_a_frame_is_work, "<start !1@0 !none work:0 <x:AA work:1"),
    ROW(a_candidate_whose_rest_was_lost_is_work, "<start:5 !none work:0 gap work:1"),
    ROW(packets_in_a_row_are_delivered_one_at_a_time,
        "<start <manual <start !1@0 pending:80 !19@13 pending:13 !1@80 !none packets:3 "
        "in-packets:93"),
    ROW(a_delivered_packet_keeps_its_place_until_the_next_call,
        "<manual !19@0 unread:67 room:189 !none room:256"),
    ROW(garbage_before_and_between_packets_is_skipped_and_counted,
        GARBAGE "<manual " GARBAGE "<manual !19@9 skipped:9 !19@85 skipped:18"),
    ROW(garbage_is_skipped_as_soon_as_it_cannot_begin_a_packet,
        "<x:01555AA5 !none skipped:4 pending:0 <x:AA !none pending:1 <x:54 !none skipped:6 "
        "pending:0"),
    ROW(garbage_after_a_packet_is_skipped_in_the_same_poll,
        "<start !1@0 <x:00 !none skipped:1 pending:0"),
    ROW(aa_before_a_packet_does_not_hide_it, "<x:AAAA <start !1@2 skipped:2"),
    ROW(the_gap_before_a_packet_is_reported_with_its_last_byte,
        "<start <x:1122 <start <start <x:AA <start !1@0 gap:0 !1@15 gap:2 last:0x22 !1@28 gap:0 "
        "!1@42 gap:1 last:0xAA"),
    ROW(a_reply_ends_a_gap_too, AWAIT_SCAN "<x:77 <scan <start !reply !1@8 gap:0"),
    /* ---- Replies ---- */
    ROW(an_awaited_start_reply_is_found_and_the_packets_after_it,
        AWAIT_SCAN "<scan <start !scan@0 !1@7"),
    ROW(an_awaited_device_information_is_found, AWAIT_INFO "<info !info@0"),
    ROW(a_reply_is_found_after_garbage_and_half_a_start_sign,
        AWAIT_HEALTH "<x:5AA500A5 <health !health@4"),
    ROW(packets_are_found_while_a_reply_is_awaited,
        AWAIT_HEALTH "<start <manual <health !1@0 !19@13 !reply skipped:0"),
    ROW(a_reply_that_is_not_awaited_is_skipped_at_once, "<frequency !none skipped:11"),
    ROW(a_reply_of_another_type_is_not_taken, "await:0:06:4 <frequency " NO_REPLY),
    ROW(a_reply_of_another_length_is_not_taken,
        AWAIT_INFO "<frequency " NO_REPLY AWAIT_FREQUENCY "<info " NO_REPLY),
    ROW(a_reply_of_another_mode_is_not_taken,
        "await:1:04:0 <frequency " NO_REPLY "await:0:81:5 <scan <start:5 " NO_REPLY),
    ROW(undefined_modes_are_not_taken,
        AWAIT_HEALTH "<x:A55A0300008006201122 " NO_REPLY "<x:A55A030000C006201122 " NO_REPLY),
    ROW(both_bytes_of_the_sign_are_compared,
        AWAIT_HEALTH "<x:AA5A0300000006201122 " NO_REPLY "<x:A5550300000006201122 " NO_REPLY),
    ROW(the_length_of_a_continuous_reply_is_ignored,
        AWAIT_SCAN "<x:A55A0000004081 <start !reply !1@7 " AWAIT_SCAN
                   "<x:A55AFFFFFF7F81 <start !reply !1@27 skipped:0"),
    ROW(a_delivered_reply_ends_the_waiting, AWAIT_HEALTH "<health <health !reply !none skipped:10"),
    ROW(a_reply_can_be_awaited_again,
        AWAIT_HEALTH "<health !reply " AWAIT_FREQUENCY "<frequency !reply in-replies:21 skipped:0"),
    ROW(the_reply_delivered_last_can_be_awaited_again_without_its_header,
        AWAIT_HEALTH "3( <health ) !reply await-again !reply !none skipped:10"),
    ROW(a_reply_that_comes_after_the_waiting_is_skipped,
        AWAIT_HEALTH "await:none <health !none skipped:10"),
    ROW(when_the_waiting_ends_a_part_of_the_reply_is_looked_at_again, /* It was cut off. */
        AWAIT_INFO "<info:12 <start !none pending:25 await:none !1@12 skipped:12"),
    ROW(another_reply_awaited_meanwhile_is_found_in_what_is_pending,
        AWAIT_INFO "<info:10 <health !none " AWAIT_HEALTH "!health@10"),
    ROW(when_the_waiting_ends_a_lone_first_byte_of_a_reply_is_skipped,
        AWAIT_INFO "<x:A5 !none pending:1 await:none !none skipped:1 pending:0"),
    ROW(waiting_for_a_reply_takes_nothing_from_an_empty_ring,
        AWAIT_INFO "!none await:none !none skipped:0 pending:0 <start !1@0"),
    ROW(a_packet_inside_a_reply_that_is_not_awaited_is_found, "<info:7 <start !1@7"),
    /* ---- Candidates that are abandoned ---- */
    ROW(an_abandoned_candidate_costs_the_bytes_before_the_next_one, /* An AA, which was none. */
        "<manual:66 !none abandon skipped:30 pending:36 !none skipped:66 pending:0"),
    ROW(what_an_abandoned_candidate_hid_is_found,
        "<manual:20 <start !none abandon !1@20 skipped:20"),
    ROW(an_abandoned_reply_is_searched_too, AWAIT_INFO "<info:9 <start !none abandon !1@9"),
    ROW(a_lone_first_byte_can_be_abandoned, "<x:AA !none abandon skipped:1 pending:0"),
    ROW(without_a_candidate_there_is_nothing_to_abandon,
        "abandon skipped:0 <start !1@0 abandon unread:13 skipped:0"),
    ROW(a_candidate_that_has_become_complete_is_not_abandoned,
        "<start:12 !none <start+12 abandon !1@0"),
    ROW(bytes_that_have_not_been_looked_at_are_not_abandoned,
        "<start:1 abandon skipped:0 <start+1 !1@0"),
    /* ---- A ring that overflows ---- */
    ROW(refused_bytes_are_counted_as_overrun,
        "<zeros:300 !none overrun:44 skipped:256 <zeros:260 !none overrun:48"),
    ROW(each_of_several_overflows_leaves_its_gap_where_it_was, /* Before all has been read. */
        "<start <start <zeros:231 !1 gap:0 <start !1 gap:0 !none overrun:14 2( <start <start "
        "<zeros:231 !1 gap:65535 <start !1 gap:0 !none ) overrun:42"),
    ROW(no_packet_spans_a_gap, /* The bytes before it and those after it would form one. */
        "<manual:40 !none gap !none skipped:40 <manual+40 !none skipped:67 <start !1 gap:65535"),
    ROW(packets_before_and_after_an_overflow_are_found, /* The fourth is cut by 12 bytes. */
        "4( <manual ) !19@12 !19@79 !19@146 !none <start abandon !1 overrun:12 skipped:55"),
    ROW(bytes_refused_while_a_packet_is_read_leave_it_intact,
        "<manual !19@0 <zeros:300 intact:1 !none overrun:111"),
    /* ---- DMA ---- */
    ROW(a_dma_ring_may_hold_half_its_size, "dma <start <zeros:230 <start !1@0 !1@243 overrun:0"),
    ROW(what_dma_may_have_overwritten_is_dropped_and_counted, /* The first packet's first byte. */
        "dma <start <zeros:231 <start !1@244 overrun:1 skipped:243"),
    ROW(overruns_of_dma_add_up, "dma <zeros:300 !none overrun:44 <zeros:260 !none overrun:48"),
    ROW(an_overrun_of_dma_is_a_gap_of_65535, "dma <start !1@0 <zeros:44 <start <zeros:243 !1@57 "
                                             "gap:65535 overrun:44 <start !1@313 gap:243"),
    ROW(a_candidate_that_dma_overran_is_forgotten, /* The packet is inside it. */
        "dma <manual:60 !none <start <zeros:217 !1@60 overrun:34 errors:0 skipped:26"),
    ROW(many_laps_of_dma_are_counted_and_survived,
        "dma 2( <zeros:900 ) <start !1@1800 overrun:1557 skipped:243"),
    ROW(after_a_lap_reported_by_mistake_nothing_is_found_twice,
        "dma <start !1@0 lap !none overrun:512 <start <zeros:174 <start <x:00 lap !1@1037 "
        "gap:65535 !1@1224 overrun:1024"),
    ROW(a_packet_that_dma_overwrites_while_it_is_read_is_not_intact, /* It was delivered. */
        "dma <manual !19@0 intact:1 <zeros:189 intact:1 <zeros:1 intact:0 !none overrun:0 "
        "skipped:190"),
    /* ---- Skipping ---- */
    ROW(skipping_drops_all_unread_bytes, "<start <x:22 skip-all skipped:14 pending:0 last:0x22 "
                                         "<manual !19@14 gap:14 <x:AA skip-all pending:0"),
    ROW(a_frame_delivered_is_not_skipped, "<manual !19@0 skip-all skipped:0 !none"),
};

void test_rows(void)
{
    run_rows(rows, tell_row);
}

/* -------------------------------------------------------------------------------- large rings */

#if SIZE_MAX > 65535 /* Otherwise an index cannot count that far. */

static tmini_ring_t large;
static tmini_parser_t parser;

/* A ring of 128 KiB with this many unread bytes. Only the bytes from `place` on have memory
 * (`memory`), so the test may read only the first of them. */
static void open_large(bool dma, size_t place, size_t unread)
{
    uint8_t *const first = (uint8_t *)((uintptr_t)memory - place);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&large, first, 131072, dma));
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_parser_init(&parser, &large, 0));
    large.head = unread;
}

static void goes_on(size_t effort, tmini_frame_type_t expected, size_t pending)
{
    TEST_ASSERT_EQUAL_INT(expected, tmini_parser_next_after(&parser, effort));
    TEST_ASSERT_EQUAL_UINT(pending, tmini_parser_pending(&parser));
}

static uint32_t overrun(void)
{
    tmini_parser_counters_t counters;
    tmini_parser_counters(&parser, &counters);
    return counters.bytes_overrun;
}

#endif

void test_65536_unread_bytes_are_not_taken_for_none(void)
{
#if SIZE_MAX > 65535
    memcpy(memory, start_packet, 13);
    open_large(false, 0, 65536);
    goes_on(0, TMINI_FRAME_PACKET, 65523);
    memset(memory, 0, 13);
    open_large(false, 0, 65536); /* The effort left is 1000 bytes. */
    goes_on(TMINI_PARSER_EFFORT - 1000, TMINI_FRAME_MORE, 64536);
    open_large(false, 65535, 65536);
    tmini_parser_skip_all(&parser);
    TEST_ASSERT_EQUAL_UINT(0, tmini_parser_pending(&parser));
    memory[0] = 0xAA;
    open_large(false, 0, 1);
    goes_on(0, TMINI_FRAME_NONE, 1);
    large.head = 65537;
    TEST_ASSERT_FALSE(tmini_parser_abandon(&parser));
#endif
}

void test_what_dma_has_overwritten_of_128_kib_is_counted(void)
{
#if SIZE_MAX > 65535
    memcpy(&memory[10], start_packet, 13);
    open_large(true, 0, 65546);
    goes_on(0, TMINI_FRAME_PACKET, 65523);
    TEST_ASSERT_EQUAL_UINT32(10, overrun());
    open_large(true, 0, 131072 + 23);
    goes_on(0, TMINI_FRAME_PACKET, 0);
    TEST_ASSERT_EQUAL_UINT32(131072, overrun());
#endif
}
