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

static void open_receiver(size_t size, bool dma, uint8_t max_samples)
{
    (dma ? receiver_open_dma : receiver_open)(&receiver, memory, size, max_samples);
}

static void feed(const uint8_t *more, size_t count)
{
    receiver_feed(&receiver, more, count);
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

/* The ring must hold the largest packet, by default of 80 samples and 250 bytes, and the longest
 * reply, of 27 bytes; if DMA fills it, half of it must. */
void test_a_ring_is_large_enough_or_an_argument_error(void)
{
    static const struct {
        uint16_t size;
        bool dma;
        uint8_t max_samples;
        bool is_enough;
    } cases[] = {{128, false, 0, false},  {256, false, 0, true},    {256, false, 82, true},
                 {256, false, 83, false}, {512, false, 255, false}, {1024, false, 255, true},
                 {16, false, 1, false},   {32, false, 1, true},     {32, true, 1, false},
                 {64, true, 1, true},     {256, true, 0, false},    {512, true, 0, true},
                 {64, true, 7, true},     {64, true, 8, false},     {0, false, 1, false}};
    tmini_ring_t ring;
    tmini_parser_t parser;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        (void)tmini_ring_init(&ring, memory, cases[i].size, cases[i].dma);
        TEST_ASSERT_EQUAL_INT(cases[i].is_enough ? TMINI_OK : TMINI_ERROR_ARGUMENT,
                              tmini_parser_init(&parser, &ring, cases[i].max_samples));
    }
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_parser_init(NULL, &receiver.ring, 0));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_parser_init(&parser, NULL, 0));
}

/* -------------------------------------------------------------------------------------- damage */

/* The bytes in `bytes` were a packet once, and two intact packets follow: both are found. */
static void costs_only_itself(size_t size, uint8_t max_samples)
{
    stream.size = size;
    stream_add(&stream, start_packet, 13);
    stream_add(&stream, manual_packet, 67);
    receiver_open(&receiver, memory, 1024, max_samples);
    feed(bytes, stream.size);
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next_at_end(&receiver));
    TEST_ASSERT_EQUAL_UINT(size, receiver_frame_offset(&receiver));
    TEST_ASSERT_EQUAL_INT(TMINI_FRAME_PACKET, receiver_next_at_end(&receiver));
    TEST_ASSERT_EQUAL_UINT(size + 13, receiver_frame_offset(&receiver));
    expect_skipped((uint32_t)size);
}

void test_each_part_of_a_packet_counts_in_its_checksum(void)
{
    static const uint8_t changed[] = {2, 5, 7, 8, 9, 10, 11, 12, 64, 65, 66};
    for (size_t i = 0; i < sizeof changed; i++) {
        memcpy(bytes, manual_packet, 67);
        bytes[changed[i]] ^= 0x40;
        costs_only_itself(67, 0);
        TEST_ASSERT_EQUAL_UINT32(1, receiver_counters(&receiver).checksum_errors);
    }
}

void test_a_packet_cut_anywhere_costs_no_other_packet(void)
{
    for (size_t size = 1; size < 67; size++) {
        memcpy(bytes, manual_packet, size);
        costs_only_itself(size, 0);
    }
}

/* The LSN of a packet of 19 samples is damaged to every other value, where packets have at most 80
 * samples, or 255. */
void test_a_corrupted_length_does_not_cost_the_next_packet(void)
{
    for (unsigned lsn = 0; lsn < 512; lsn++) {
        if (lsn % 256 != 19) {
            memcpy(bytes, manual_packet, 67);
            bytes[3] = (uint8_t)lsn;
            costs_only_itself(67, lsn < 256 ? 0 : 255);
        }
    }
}

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

/* Changes the byte at `place` of the turn, takes it away (`more` is -1) or adds one before it (1).
 * All other packets must be found, at their places. */
static void damage(size_t place, int more, uint8_t value)
{
    unsigned expected = 0;
    unsigned found = 0;
    make_turn();
    memmove(&bytes[place + (more > 0)], &bytes[place + (more < 0)],
            stream.size - place - (more < 0));
    bytes[place] = more < 0 ? bytes[place] : value;
    stream.size += (size_t)more;
    receiver_open(&receiver, memory, 256, 0);
    feed(bytes, stream.size);
    while (receiver_next_at_end(&receiver) != TMINI_FRAME_NONE) {
        for (unsigned i = 0; i < PACKETS; i++) {
            const size_t moved = places[i] >= place + (more < 0) ? (size_t)more : 0;
            found |= (unsigned)(receiver_frame_offset(&receiver) == places[i] + moved) << i;
        }
    }
    for (unsigned i = 0; i < PACKETS; i++) {
        const size_t first = places[i] + (size_t)(more > 0);
        expected |= (unsigned)(place < first || place >= (size_t)places[i] + sizes[i]) << i;
    }
    TEST_ASSERT_EQUAL_HEX(expected, found & expected);
}

/* Frames, points and counters are those of the reference decoder, with chunks of this size. */
static void expect_like_reference(size_t chunk)
{
    const receiver_course_t course = {.chunk = chunk};
    receiver_open(&receiver, memory, 256, 0);
    (void)receiver_compare(&receiver, &course, bytes, stream.size);
}

void test_a_damaged_byte_costs_no_packet_but_its_own(void)
{
    static const uint8_t values[] = {0x00, 0x01, 0x02, 0x50, 0x55, 0xA5, 0xAA, 0xFF};
    for (size_t place = 0; place < 91; place++) {
        for (int more = -1; more <= 1; more++) {
            for (size_t i = 0; i < (more < 0 ? 1 : sizeof values); i++) {
                damage(place, more, values[i]);
            }
            expect_like_reference(1 + place % 40); /* With the last value; test/system has all. */
        }
    }
}

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

/* From each place in the ring on, also where its indices wrap. */
void test_the_same_frames_are_found_wherever_they_lie_in_the_ring(void)
{
    static const reference_reply_t info = {0, 0x04, 20};
    const receiver_course_t course = {.chunk = 11, .awaited = &info};
    make_turn();
    stream_add(&stream, info_reply, sizeof info_reply);
    for (unsigned dma = 0; dma <= 1; dma++) {
        const size_t size = dma ? 512 : 256;
        for (size_t before = 0; before <= size; before += 1 + 2 * dma) {
            open_receiver(size, dma, 0);
            receiver_age(&receiver, (size_t)0 - before);
            (void)receiver_compare(&receiver, &course, bytes, stream.size);
        }
    }
}

void test_every_bit_of_the_length_is_compared(void)
{
    for (unsigned bit = 0; bit < 30; bit++) {
        receiver_open(&receiver, memory, 256, 0);
        receiver_await(&receiver, &(const reference_reply_t){0, 0x06, 3});
        memcpy(bytes, health_reply, 10);
        bytes[2 + bit / 8] ^= (uint8_t)(1u << bit % 8);
        feed(bytes, 10);
        TEST_ASSERT_EQUAL_INT(TMINI_FRAME_NONE, receiver_next_at_end(&receiver));
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

/* Words of the rows:
 *
 *     <start <manual <info <health <frequency <scan    these bytes come; <manual:40: the first 40;
 *                     <manual+40: what follows them
 *     <x:AA55 <zeros:300      these bytes; <P:40: a packet of 40 samples
 *     ring:512:100 dma        an empty ring of 512 bytes, packets of at most 100 samples; for DMA
 *     !19@0           the next frame is a packet of 19 samples, which began at this offset
 *     !health@4       the next frame is this reply; 4 bytes before it have been skipped
 *     !none           there is no frame; !end: nor will there be, if no more bytes come
 *     await:0:06:3    a reply of this mode, type and length is awaited; await:none
 *     skipped:9 pending:0 …   see tell_word() */

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
    if (row_is(word, "x")) {
        feed(bytes, row_bytes(at + 1, bytes));
    } else if (row_is(word, "zeros")) {
        memset(bytes, 0, number);
        feed(bytes, number);
    } else if (row_is(word, "P")) {
        stream.size = 0;
        (void)stream_add_packet(&stream, 0, (uint8_t)number, 0, 1000);
        feed(bytes, stream.size);
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
    reference_reply_t awaited = {.mode = (uint8_t)strtoul(word, &rest, 10)};
    awaited.type = (uint8_t)strtoul(rest + 1, &rest, 16);
    awaited.length = (uint32_t)strtoul(rest + 1, NULL, 10);
    receiver_await(&receiver, &awaited);
}

static void tell_word(char *word)
{
    const tmini_parser_counters_t counters = receiver_counters(&receiver);
    const tmini_frame_t *const frame = tmini_parser_frame(&receiver.parser);
    const row_number_t numbers[] = {
        {"skipped", counters.bytes_skipped},
        {"pending", tmini_parser_pending(&receiver.parser)},
        {"packets", counters.packets},
        {"in-packets", counters.bytes_in_packets},
        {"in-replies", counters.bytes_in_replies},
        {"errors", counters.checksum_errors},
        {"overrun", counters.bytes_overrun},
        {"unread", tmini_ring_unread(&receiver.ring)},
        {"room", receiver_room(&receiver)},
        {"work", tmini_parser_has_work(&receiver.parser)},
        {"intact", tmini_frame_intact(frame)},
        {"content", tmini_frame_content(frame, bytes, 0)}, /* May be used. */
        {"gap", receiver.packet.gap},
        {"last", frame->last_skipped},
    };
    if (word[0] == '<') {
        tell_feed(word + 1);
    } else if (word[0] == '!') {
        tell_frame(word + 1);
    } else if (row_is(word, "dma")) {
        open_receiver(512, true, 0);
    } else if (row_is(word, "ring")) {
        open_receiver(row_number(word), false, (uint8_t)row_number(row_text(word)));
    } else if (row_is(word, "lap")) { /* Was perhaps missed; it counts 512 bytes. */
        tmini_ring_gap(&receiver.ring);
        receiver.received += 512;
    } else if (row_is(word, "gap") && row_text(word)[0] == '\0') {
        tmini_ring_gap(&receiver.ring);
    } else if (row_is(word, "abandon")) {
        receiver_abandon(&receiver);
    } else if (row_is(word, "skip-all")) {
        tmini_parser_skip_all(&receiver.parser);
    } else if (row_is(word, "await-again")) {
        tmini_parser_await_again(&receiver.parser);
    } else if (row_is(word, "await")) {
        tell_await(row_text(word));
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

#define GARBAGE "<x:0055AAA55AAA5455FF "
#define AWAIT_INFO "await:0:04:20 "
#define AWAIT_HEALTH "await:0:06:3 "
#define AWAIT_FREQUENCY "await:0:04:4 "
#define AWAIT_SCAN "await:1:81:0 "
#define NO_REPLY "!end in-replies:0 "

/* A packet whose samples contain the header of a packet of 40 samples, then a whole packet. */
#define INSIDE "<x:AA5500280100410100000000 <start <x:3333 "
#define OUTER "<x:AA552009C900090750D7 " INSIDE
#define OUTER_DAMAGED "<x:AA552009C900090751D7 " INSIDE

static const row_t rows[] IN_FLASH = {
    /* ---- Packets ---- */
    ROW(a_packet_is_delivered_with_its_last_byte_and_not_before,
        "<manual:66 !none pending:66 <manual+66 !19@0 pending:0"),
    ROW(a_candidate_is_no_work_until_it_can_be_looked_at_further, /* AA 55, the header, the end. */
        "<x:AA work:1 !none work:0 <x:55 work:1 !none work:0 <x:75013F003F009E work:0 <x:56 "
        "work:1 !none work:0 <x:1554 work:0 <x:02 work:1 !1@0"),
    ROW(packets_may_have_up_to_the_configured_number_of_samples, /* 0: the default, 80. */
        "ring:1024:1 <P:1 !1 <P:2 !end ring:1024:40 <P:40 !40 <P:41 !end ring:1024:80 <P:80 !80 "
        "<P:81 !end ring:1024:254 <P:254 !254 ring:1024:254 <P:255 !end ring:1024:255 <P:255 !255 "
        "ring:1024:0 <P:80 !80 <P:81 !end"),
    ROW(a_packet_that_fills_the_ring_is_found, "ring:256:82 <P:82 room:0 overrun:0 !82@0"),
    ROW(a_packet_without_samples_is_not_taken,
        "<x:AA552000C900C9008A55 <start !1@10 errors:0 skipped:10"),
    ROW(a_start_packet_of_two_samples_is_not_taken,
        "<x:AA55790201000100D357000000000000 <start !1@16 errors:0 skipped:16"),
    ROW(a_check_bit_of_0_makes_no_packet_even_with_a_right_checksum, /* FSA's, then LSA's. */
        "<x:AA55000100000100AB54000000 <start !1@13 errors:0 <x:AA55000101000000AB54000000 <start "
        "!1@39 errors:0 skipped:26"),
    ROW(headers_and_packets_inside_a_valid_packet_are_its_samples,
        OUTER "<start !9@0 !1@37 !none skipped:0"),
    ROW(inside_a_damaged_packet_a_false_header_hides_nothing, /* It needs 130 bytes. */
        OUTER_DAMAGED "!none pending:27 <manual <manual !1@22 errors:2 !19@37 !19@104"),
    ROW(a_gap_is_counted_up_to_65535,
        "327( <zeros:200 !none ) <zeros:134 !none <start !1@65534 gap:65534 327( <zeros:200 !none "
        ") <zeros:135 !none skipped:131069 <start !1 gap:65535 327( <zeros:200 !none ) <zeros:137 "
        "!none <start !1 gap:65535"),
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
    ROW(a_reply_is_delivered_with_its_last_byte_and_not_before,
        AWAIT_INFO "<info:26 !none pending:26 <info+26 !info@0 pending:0"),
    ROW(a_packet_inside_an_awaited_reply_is_its_content,
        AWAIT_INFO "<info:10 <start <info+23 !reply in-replies:27 !none packets:0"),
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
    ROW(a_candidate_of_256_bytes_can_be_abandoned_or_cut_off_by_a_gap, /* Of 310. */
        "ring:512:100 <x:AA55206495A963005AE8 <zeros:246 !none pending:256 abandon skipped:256 "
        "ring:512:100 <x:AA55206495A963005AE8 <zeros:246 !none gap !none skipped:256"),
    /* ---- A ring that overflows ---- */
    ROW(refused_bytes_leave_a_gap_where_they_are_missing, /* There would be room for the fifth. */
        "<zeros:55 4( <manual ) !19 gap:55 !19 gap:0 <manual !19 gap:0 overrun:134 !none <manual "
        "!19 gap:65535 overrun:134"),
    ROW(refused_bytes_are_counted_as_overrun,
        "<zeros:300 !none overrun:44 skipped:256 <zeros:260 !none overrun:48"),
    ROW(each_of_several_overflows_leaves_its_gap_where_it_was, /* Before all has been read. */
        "<start <start <zeros:231 !1 gap:0 <start !1 gap:0 !none overrun:14 2( <start <start "
        "<zeros:231 !1 gap:65535 <start !1 gap:0 !none ) overrun:42"),
    ROW(a_packet_that_is_just_complete_before_a_gap_is_found,
        "<manual:40 !none <manual+40 gap !19@0 !none skipped:0"),
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
    ROW(a_reply_that_dma_overwrites_while_it_is_read_may_not_be_used,
        "dma " AWAIT_HEALTH "<health !health@0 <zeros:246 content:1 <zeros:1 content:0"),
    /* ---- Skipping ---- */
    ROW(skipping_drops_all_unread_bytes, "<start <x:22 skip-all skipped:14 pending:0 last:0x22 "
                                         "<manual !19@14 gap:14 <x:AA skip-all pending:0"),
    ROW(a_frame_delivered_is_not_skipped, "<manual !19@0 skip-all skipped:0 !none"),
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

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
