/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ring of received bytes: filled by a CPU or by DMA, read by the parser. */

#include "rows.h"

#include "tmini/parts/tmini_ring.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define SIZE 16u
#define GUARD 0xEEu

/* The ring's memory has guards on each side: the ring must never write there. */
static uint8_t area[3 * SIZE];
static uint8_t *const memory = &area[SIZE];
static tmini_ring_t ring;

static void init(size_t size, bool dma)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, size, dma));
}

void setUp(void)
{
    memset(area, GUARD, sizeof area);
    init(SIZE, false);
}

void tearDown(void)
{
    TEST_ASSERT_EACH_EQUAL_HEX8(GUARD, area, SIZE);
    TEST_ASSERT_EACH_EQUAL_HEX8(GUARD, &area[2 * SIZE], SIZE);
}

/* Sets the indices as after `count` bytes were written and read. */
static void age(size_t count)
{
    ring.head = count;
    ring.stop = count;
    ring.tail = count;
}

static void expect_unread(const char *expected)
{
    const size_t count = strlen(expected);
    TEST_ASSERT_EQUAL_UINT(count, tmini_ring_unread(&ring));
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_INT(expected[i], tmini_ring_peek(&ring, i));
    }
}

/* ---------------------------------------------------------------------------------------- rows */

/* Words of the rows:
 *
 *     put:abc write:abc=2     these bytes come one by one; as a block, of which two are stored
 *     init:8 dma      the ring is set up, with 8 bytes of memory; with all 16 and for DMA
 *     no:12 no-memory blank   a size, and a NULL, that it refuses; it was not set up
 *     large:512:256   it has 512 bytes, of which only the 16 from 256 on have memory
 *     age:-3 tail-at:0        the indices are 3 before their wraparound; the tail alone is set
 *     at:8:abc        DMA writes there and publishes its position; publish:11
 *     discard:2 gap open      calls
 *     unread:abc memory:abc   what is unread, what the memory begins with
 *     peek:5:a copy:2:cde     the byte with this offset; a copy of bytes from there on
 *     piece:2:9=5     of 9 bytes from offset 2 on, 5 lie in one piece
 *     overrun:1 room:16 …     see tell_word() */

static void refuse(uint8_t *bytes, size_t size)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ring_init(NULL, bytes, size, false));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ring_init(&ring, bytes, size, false));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ring_init(&ring, bytes, size, true));
}

static void tell_write(const char *text)
{
    const size_t count = strcspn(text, "=");
    const size_t stored = tmini_ring_write(&ring, (const uint8_t *)text, count);
    TEST_ASSERT_EQUAL_UINT(text[count] == '=' ? strtoul(text + count + 1, NULL, 10) : stored,
                           stored);
}

static void tell_dma(size_t place, const char *text)
{
    for (; *text != '\0'; text++) {
        memory[place++ % SIZE] = (uint8_t)*text;
    }
    tmini_ring_publish(&ring, place % SIZE);
}

static void expect_copy(size_t offset, const char *text)
{
    uint8_t copy[8];
    memset(copy, GUARD, sizeof copy);
    tmini_ring_copy(&ring, offset, copy, strlen(text));
    TEST_ASSERT_EQUAL_HEX8(GUARD, copy[strlen(text)]);
    for (size_t i = 0; text[i] != '\0'; i++) {
        TEST_ASSERT_EQUAL_HEX8(text[i], copy[i]);
    }
}

static void expect_piece(size_t offset, const char *text)
{
    char *rest;
    size_t count = strtoul(text, &rest, 10);
    const uint8_t *const piece = tmini_ring_piece(&ring, offset, &count);
    TEST_ASSERT_EQUAL_PTR(&memory[(ring.tail + offset) % SIZE], piece);
    TEST_ASSERT_EQUAL_UINT(strtoul(rest + 1, NULL, 10), count);
}

/* Its indices are at `place`. */
static void use_large(size_t size, size_t place)
{
    uint8_t *const first = (uint8_t *)((uintptr_t)memory - place);
    memset(memory, GUARD, SIZE);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, first, size, false));
    age(place);
}

static void tell_word(char *word)
{
    const row_number_t numbers[] = {
        {"overrun", tmini_ring_overrun(&ring)},
        {"room", tmini_ring_room(&ring)},
        {"count", tmini_ring_unread(&ring)},
        {"head", tmini_ring_distance(0, tmini_ring_head(&ring))},
        {"tail", tmini_ring_distance(0, tmini_ring_tail(&ring))},
        {"window", ring.window},
        {"closed", tmini_ring_is_closed(&ring)},
        {"full", tmini_ring_is_full(&ring)},
        {"intact", tmini_ring_intact(&ring)},
    };
    const char *const text = row_text(word);
    const char *const rest = row_text(text);
    const size_t number = (size_t)strtol(text, NULL, 10);
    if (row_is(word, "put")) {
        for (size_t i = 0; text[i] != '\0'; i++) {
            tmini_ring_put(&ring, (uint8_t)text[i]);
        }
    } else if (row_is(word, "write")) {
        tell_write(text);
    } else if (row_is(word, "init") || row_is(word, "dma")) {
        init(number > 0 ? number : SIZE, word[0] == 'd');
    } else if (row_is(word, "no") || row_is(word, "no-memory")) {
        refuse(word[2] == ':' ? memory : NULL, word[2] == ':' ? number : SIZE);
    } else if (row_is(word, "blank")) {
        ring = (tmini_ring_t){0};
    } else if (row_is(word, "large")) {
        use_large(number, (size_t)strtol(rest, NULL, 10));
    } else if (row_is(word, "tail-at")) {
        ring.tail = number;
    } else if (row_is(word, "age")) {
        age(number);
    } else if (row_is(word, "at")) {
        tell_dma(number, rest);
    } else if (row_is(word, "publish")) {
        tmini_ring_publish(&ring, number);
    } else if (row_is(word, "discard")) {
        tmini_ring_discard(&ring, number);
    } else if (row_is(word, "gap")) {
        tmini_ring_gap(&ring);
    } else if (row_is(word, "open")) {
        tmini_ring_open(&ring);
    } else if (row_is(word, "unread")) {
        expect_unread(text);
    } else if (row_is(word, "memory")) {
        TEST_ASSERT_EQUAL_HEX8_ARRAY(text, memory, strlen(text));
    } else if (row_is(word, "peek")) {
        TEST_ASSERT_EQUAL_HEX8(rest[0], tmini_ring_peek(&ring, number));
    } else if (row_is(word, "copy")) {
        expect_copy(number, rest);
    } else if (row_is(word, "piece")) {
        expect_piece(number, rest);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

/* It fills the ring. */
#define ALL "abcdefghijklmnop"
#define PUT_ALL "put:" ALL " "
#define TAKES_NOTHING \
    "publish:3 count:0 put:a write:abcde=0 gap publish:3 put:b count:0 room:0 overrun:7 "
#define IS_RIGHT "write:abc=3 put:de memory:abcde unread:abcde copy:0:abcde "

static const row_t rows[] IN_FLASH = {
    /* ---- Setting up ---- */
    ROW(no_memory_or_a_size_that_is_no_power_of_two_is_an_argument_error,
        "no-memory no:0 no:1 no:3 no:12 no:15 no:-1"), /* 1: full would be like empty. */
    ROW(every_power_of_two_is_a_size,
        "init:2 " PUT_ALL "count:2 init:4 " PUT_ALL "count:4 init:8 " PUT_ALL
        "count:8 init:16 " PUT_ALL "put:q count:16"),
    ROW(a_ring_without_memory_refuses_every_byte, /* No call in any order stores one. */
        "blank " TAKES_NOTHING "init put:abc no:12 " TAKES_NOTHING),
    /* ---- Filled by a CPU ---- */
    ROW(bytes_come_out_in_the_order_in_which_they_went_in,
        "put:abc unread:abc discard:1 unread:bc put:d unread:bcd discard:3 unread:"),
    ROW(the_head_reports_how_many_were_stored_whether_read_or_not, /* Three are refused. */
        "head:0 put:abc discard:2 put:de head:5 " PUT_ALL "head:18"),
    ROW(a_full_ring_refuses_bytes_and_keeps_what_it_has,
        PUT_ALL "unread:" ALL " overrun:0 put:qrs unread:" ALL " overrun:3"),
    ROW(a_discarded_byte_makes_room_for_exactly_one,
        PUT_ALL "discard:1 put:qr unread:bcdefghijklmnopq overrun:1"),
    ROW(room_that_is_made_late_is_found,
        "put:abcdefghijklmno discard:15 " PUT_ALL "unread:" ALL " put:q overrun:1"),
    ROW(indices_wrap_around_with_size_t,
        "age:-3 " PUT_ALL "unread:" ALL " put:a overrun:1 discard:16 open write:abcdefghij "
        "discard:4 write:abcdefghijk unread:efghijabcdefghij overrun:2"),
    /* ---- Blocks ---- */
    ROW(a_block_is_stored_like_its_bytes_one_by_one,
        "write:abcde write:f write:gh unread:abcdefgh"),
    ROW(an_empty_block_changes_nothing,
        "write: unread: " PUT_ALL "write: unread:" ALL " overrun:0"),
    ROW(a_block_wraps_around_the_memorys_end,
        "put:ABCDEFGHIJKL discard:12 write:abcdefghij unread:abcdefghij memory:efghij"),
    ROW(a_block_that_ends_at_the_memorys_end_fits,
        "put:ABCDEFGHIJKL discard:12 write:abcd unread:abcd memory:A"),
    ROW(the_part_of_a_block_that_does_not_fit_is_refused_and_counted,
        "put:abcdefghij discard:2 write:klmnopqrstu=8 unread:cdefghijklmnopqr overrun:3 "
        "write:abcd=0 unread:cdefghijklmnopqr overrun:7"),
    ROW(a_block_that_just_fits_does_not_close_the_ring,
        "write:" ALL "=16 closed:0 write:=0 closed:0"),
    ROW(a_block_larger_than_the_ring_is_cut,
        "write:" ALL "qrstuvwxyz=16 unread:" ALL " overrun:10"),
    ROW(a_block_is_stored_across_the_wrap_of_size_t,
        "age:-3 write:" ALL "qrst unread:" ALL " overrun:4"),
    /* ---- Reading ---- */
    ROW(an_offset_beyond_the_unread_bytes_still_reads_inside_the_memory,
        PUT_ALL "peek:16:a peek:-1:p discard:5 peek:12:b"),
    ROW(unread_bytes_are_copied_across_the_memorys_end,
        "age:12 put:abcdefghij copy:2:cdefg copy:2:"),
    ROW(unread_bytes_in_one_piece_are_read_where_they_are, /* Up to the memory's last byte. */
        "age:5 " PUT_ALL "piece:2:5=5 piece:2:9=9"),
    ROW(of_unread_bytes_in_two_pieces_the_first_piece_comes_first,
        "age:5 " PUT_ALL "piece:2:10=9 piece:11:5=5"),
    ROW(initialisation_empties_a_ring, PUT_ALL "put:q init unread: overrun:0"),
    /* ---- A closed ring ---- */
    ROW(a_ring_may_be_closed_and_opened_any_number_of_times, /* After four, the indices wrap. */
        "age:-3 9( " PUT_ALL "put:q closed:1 unread:" ALL " intact:1 discard:16 unread: put:a open "
        "closed:0 room:16 ) overrun:18 head:141 tail:141"),
    ROW(a_closed_ring_that_is_closed_again_stays_so,
        "put:abc gap gap put:x unread:abc discard:3 open put:de unread:de"),
    ROW(a_refused_byte_closes_the_ring_however_much_room_there_is_then, /* Full is not closed. */
        PUT_ALL "closed:0 put:q closed:1 discard:10 put:ab write:abc=0 unread:klmnop overrun:6"),
    ROW(a_ring_is_full_from_the_last_byte_that_fits_until_room_is_made, /* The indices wrap. */
        "age:-4 put:abcdefghijklmno full:0 put:p full:1 discard:1 full:0"),
    ROW(a_closed_ring_is_full_until_it_is_opened, PUT_ALL "put:q discard:16 full:1 open full:0"),
    ROW(a_block_that_was_cut_closes_the_ring_too,
        "put:abcdefghij write:klmnopq=6 closed:1 overrun:1"),
    ROW(a_ring_that_was_opened_again_takes_bytes_from_where_it_was,
        PUT_ALL "put:q discard:16 open closed:0 put:de unread:de head:18"),
    ROW(a_gap_closes_the_ring_without_counting_bytes,
        "put:abc gap closed:1 overrun:0 put:d unread:abc overrun:1"),
    ROW(there_is_room_for_what_would_be_stored, /* At the end it is closed. */
        "room:16 put:abcdefghij room:6 discard:4 room:10 write:" ALL "=10 room:0 discard:4 room:0"),
    ROW(the_window_is_the_rings_size_and_with_dma_half_of_it, "window:16 dma window:8"),
    /* ---- DMA ---- */
    ROW(a_ring_that_the_cpu_feeds_ignores_positions_of_dma, "publish:6 count:0 room:16"),
    ROW(a_lap_that_was_not_seen_leaves_the_newest_half_intact_at_most,
        "dma at:0:abcd intact:1 gap intact:0 count:20 publish:6 count:22 discard:14 intact:1 "
        "closed:0"),
    ROW(published_bytes_can_be_read,
        "dma unread: at:0:abc unread:abc publish:3 unread:abc at:3:de unread:abcde"),
    ROW(a_position_equal_to_the_size_means_0,
        "dma at:0:abcdefgh at:8:ijklmnop publish:16 unread:" ALL " publish:0 unread:" ALL),
    ROW(a_position_before_the_last_one_has_wrapped_around_the_memorys_end,
        "dma at:0:abcdefgh at:8:ijklmn discard:12 at:14:opqrs unread:mnopqrs"),
    ROW(more_unread_bytes_than_the_window_are_an_overrun,
        "dma at:0:abcdefgh count:8 at:8:ijklmnop at:0:qrstuvwx count:24 discard:16 "
        "unread:qrstuvwx"),
    ROW(unread_bytes_are_intact_while_they_fit_the_window, /* The CPU overwrites nothing. */
        PUT_ALL "put:q intact:1 dma at:0:abcdefgh intact:1 at:8:i intact:0 discard:1 intact:1"),
    ROW(dma_positions_are_right_across_the_wrap_of_size_t, /* Position 13. */
        "dma age:-3 at:13:abcdefg unread:abcdefg discard:5 at:4:hijk unread:fghijk"),
    /* ---- Large rings ---- */
    ROW(places_beyond_8_bits_are_not_cut,
        "large:512:256 " IS_RIGHT "piece:0:512=256 tail-at:0 peek:256:a piece:256:512=256 "
        "large:512:256 tail-at:-255 put:ab overrun:1"), /* Room for one byte. */
#if SIZE_MAX > 65535
    ROW(places_beyond_16_bits_are_not_cut,
        "large:131072:65536 " IS_RIGHT "piece:0:131072=65536 tail-at:0 peek:65536:a "
        "piece:65536:131072=65536 large:131072:65536 tail-at:-65535 put:ab overrun:1"),
#endif
};

void test_rows(void)
{
    tell_rows(rows, tell_word);
}

/* ------------------------------------------------------------------------ what words cannot say */

void test_the_largest_size_is_an_eighth_of_what_an_index_can_count(void)
{
    refuse(memory, SIZE_MAX / 2 + 1);
    refuse(memory, SIZE_MAX / 4 + 1);
    init(SIZE_MAX / 8 + 1, false);
    TEST_ASSERT_EQUAL_UINT(SIZE_MAX / 8 + 1, tmini_ring_room(&ring));
    tmini_ring_gap(&ring);
    TEST_ASSERT_TRUE(tmini_ring_is_closed(&ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_unread(&ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_room(&ring));
}

/* Also across the end of the memory and the wraparound of size_t. */
void test_bytes_and_blocks_in_turn_lose_nothing_at_any_place(void)
{
    uint8_t put = 0;
    uint8_t taken = 0;
    age(SIZE_MAX - 5 * SIZE + 3);
    for (unsigned round = 0; round < 1000; round++) {
        const uint8_t block[] = {(uint8_t)(put + 1), (uint8_t)(put + 2), (uint8_t)(put + 3)};
        tmini_ring_put(&ring, put);
        put = (uint8_t)(put + 1 + tmini_ring_write(&ring, block, round % 4));
        while (tmini_ring_unread(&ring) > round % 7) {
            TEST_ASSERT_EQUAL_HEX8(taken++, tmini_ring_peek(&ring, 0));
            tmini_ring_discard(&ring, 1);
        }
    }
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&ring));
}

void test_the_count_of_refused_bytes_wraps_around_with_size_t(void)
{
    ring.overrun = SIZE_MAX - 1;
    row_tell(PUT_ALL "put:q", tell_word);
    TEST_ASSERT_EQUAL_UINT(SIZE_MAX, tmini_ring_overrun(&ring));
    tmini_ring_write(&ring, memory, SIZE_MAX / 2); /* Closed: none of them is read. */
    TEST_ASSERT_EQUAL_UINT(SIZE_MAX / 2 - 1, tmini_ring_overrun(&ring));
}

/* This is a wrong use, but must do no harm: tearDown() checks the guards. */
void test_bytes_put_into_a_dma_ring_stay_inside_its_memory(void)
{
    init(SIZE, true);
    for (size_t i = 0; i < 5 * SIZE; i++) {
        row_tell("put:a gap put:a", tell_word);
        tmini_ring_publish(&ring, (3 * i) % SIZE);
        tmini_ring_discard(&ring, tmini_ring_unread(&ring));
    }
}

/* Too large for a small machine. */
void test_a_block_of_more_than_65536_bytes_is_stored_whole(void)
{
#if defined(__linux__)
    static uint8_t large[131072];
    static uint8_t block[65540];
    block[65539] = 'z';
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, large, sizeof large, false));
    TEST_ASSERT_EQUAL_UINT(65540, tmini_ring_write(&ring, block, 65540));
    TEST_ASSERT_EQUAL_UINT(65540, tmini_ring_unread(&ring));
    TEST_ASSERT_EQUAL_INT('z', large[65539]);
#endif
}
