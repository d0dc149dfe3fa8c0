/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The ring of received bytes: filled by a CPU or by DMA, read by the parser. */

#include "tmini/parts/tmini_ring.h"

#include "unity.h"

#include <string.h>

#define SIZE 16u
#define GUARD 0xEEu

/* The ring's memory has guards on each side: the ring must never write there. */
static uint8_t area[3 * SIZE];
static uint8_t *const memory = &area[SIZE];
static tmini_ring_t ring;
static const uint8_t letters[] = "abcdefghijklmnopqrstuvwxyz";

void setUp(void)
{
    memset(area, GUARD, sizeof area);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, SIZE, false));
}

void tearDown(void)
{
    TEST_ASSERT_EACH_EQUAL_HEX8(GUARD, area, SIZE);
    TEST_ASSERT_EACH_EQUAL_HEX8(GUARD, &area[2 * SIZE], SIZE);
}

static void use_dma(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, SIZE, true));
}

/* Sets the indices as after `count` bytes were written and read. */
static void age(size_t count)
{
    ring.head = count;
    ring.stop = count;
    ring.tail = count;
}

static void put_letters(size_t first, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        tmini_ring_put(&ring, letters[first + i]);
    }
}

static void expect_unread(const char *expected)
{
    const size_t count = strlen(expected);
    TEST_ASSERT_EQUAL_UINT(count, tmini_ring_unread(&ring));
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_INT(expected[i], tmini_ring_peek(&ring, i));
    }
}

/* ---------------------------------------------------------------------------------------- init */

static void expect_refused_arguments(uint8_t *bytes, size_t size)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ring_init(&ring, bytes, size, false));
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ring_init(&ring, bytes, size, true));
}

void test_a_null_pointer_is_an_argument_error(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_ERROR_ARGUMENT, tmini_ring_init(NULL, memory, SIZE, false));
    expect_refused_arguments(NULL, SIZE);
}

void test_a_size_that_is_no_power_of_two_is_an_argument_error(void)
{
    expect_refused_arguments(memory, 0);
    expect_refused_arguments(memory, 1); /* The indices could not distinguish full from empty. */
    expect_refused_arguments(memory, 3);
    expect_refused_arguments(memory, 12);
    expect_refused_arguments(memory, 15);
    expect_refused_arguments(memory, SIZE_MAX);
    expect_refused_arguments(memory, SIZE_MAX / 2 + 1);
    expect_refused_arguments(memory, SIZE_MAX / 4 + 1);
}

void test_the_largest_size_is_an_eighth_of_what_an_index_can_count(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, SIZE_MAX / 8 + 1, false));
    TEST_ASSERT_EQUAL_UINT(SIZE_MAX / 8 + 1, tmini_ring_room(&ring));
    tmini_ring_gap(&ring);
    TEST_ASSERT_TRUE(tmini_ring_is_closed(&ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_unread(&ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_room(&ring));
}

void test_every_power_of_two_is_a_size(void)
{
    for (size_t size = 2; size <= SIZE; size *= 2) {
        TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, size, false));
        put_letters(0, SIZE + 1);
        TEST_ASSERT_EQUAL_UINT(size, tmini_ring_unread(&ring));
    }
}

/* No call in any order stores a byte. */
static void expect_refusal(void)
{
    tmini_ring_put(&ring, 'a');
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_write(&ring, letters, 5));
    tmini_ring_gap(&ring);
    tmini_ring_publish(&ring, 3);
    tmini_ring_put(&ring, 'b');
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_room(&ring));
    TEST_ASSERT_EQUAL_UINT(7, tmini_ring_overrun(&ring));
}

void test_a_ring_that_was_not_initialised_refuses_every_byte(void)
{
    ring = (tmini_ring_t){0};
    tmini_ring_publish(&ring, 3);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_unread(&ring));
    expect_refusal();
}

void test_a_ring_whose_initialisation_failed_refuses_every_byte(void)
{
    put_letters(0, 3);
    (void)tmini_ring_init(&ring, memory, 12, false);
    expect_refusal();
}

void test_initialisation_empties_a_ring(void)
{
    put_letters(0, SIZE + 2);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, SIZE, false));
    expect_unread("");
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&ring));
}

/* ------------------------------------------------------------------------------------ CPU-fed */

void test_bytes_come_out_in_the_order_in_which_they_went_in(void)
{
    put_letters(0, 3);
    expect_unread("abc");
    tmini_ring_discard(&ring, 1);
    expect_unread("bc");
    put_letters(3, 1);
    expect_unread("bcd");
    tmini_ring_discard(&ring, 3);
    expect_unread("");
}

void test_the_head_reports_how_many_were_stored_whether_read_or_not(void)
{
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_head(&ring));
    put_letters(0, 3);
    tmini_ring_discard(&ring, 2);
    put_letters(3, 2);
    TEST_ASSERT_EQUAL_UINT(5, tmini_ring_head(&ring));
    put_letters(0, SIZE); /* Three bytes are refused. */
    TEST_ASSERT_EQUAL_UINT(18, tmini_ring_distance(0, tmini_ring_head(&ring)));
}

void test_a_full_ring_refuses_bytes_and_keeps_what_it_has(void)
{
    put_letters(0, SIZE);
    expect_unread("abcdefghijklmnop");
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&ring));
    put_letters(SIZE, 3);
    expect_unread("abcdefghijklmnop");
    TEST_ASSERT_EQUAL_UINT(3, tmini_ring_overrun(&ring));
}

void test_a_discarded_byte_makes_room_for_exactly_one(void)
{
    put_letters(0, SIZE);
    tmini_ring_discard(&ring, 1);
    put_letters(SIZE, 2);
    expect_unread("bcdefghijklmnopq");
    TEST_ASSERT_EQUAL_UINT(1, tmini_ring_overrun(&ring));
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

void test_room_that_is_made_late_is_found(void)
{
    put_letters(0, SIZE - 1);
    tmini_ring_discard(&ring, SIZE - 1);
    put_letters(0, SIZE);
    expect_unread("abcdefghijklmnop");
    put_letters(0, 1);
    TEST_ASSERT_EQUAL_UINT(1, tmini_ring_overrun(&ring));
}

void test_the_window_of_a_cpu_fed_ring_is_its_size(void)
{
    TEST_ASSERT_EQUAL_UINT(SIZE, ring.window);
}

void test_an_offset_beyond_the_unread_bytes_still_reads_inside_the_memory(void)
{
    put_letters(0, SIZE);
    TEST_ASSERT_EQUAL_INT('a', tmini_ring_peek(&ring, SIZE));
    TEST_ASSERT_EQUAL_INT('p', tmini_ring_peek(&ring, SIZE_MAX));
    tmini_ring_discard(&ring, 5);
    TEST_ASSERT_EQUAL_INT('b', tmini_ring_peek(&ring, 12));
}

/* -------------------------------------------------------------------------------------- blocks */

void test_a_block_is_stored_like_its_bytes_one_by_one(void)
{
    tmini_ring_write(&ring, letters, 5);
    tmini_ring_write(&ring, &letters[5], 2);
    expect_unread("abcdefg");
}

void test_a_block_may_be_a_single_byte(void)
{
    tmini_ring_write(&ring, letters, 1);
    expect_unread("a");
}

void test_an_empty_block_changes_nothing(void)
{
    tmini_ring_write(&ring, letters, 0);
    expect_unread("");
    put_letters(0, SIZE);
    tmini_ring_write(&ring, letters, 0);
    expect_unread("abcdefghijklmnop");
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&ring));
}

void test_a_block_wraps_around_the_memorys_end(void)
{
    put_letters(0, 12);
    tmini_ring_discard(&ring, 12);
    tmini_ring_write(&ring, letters, 10);
    expect_unread("abcdefghij");
    TEST_ASSERT_EQUAL_HEX8_ARRAY("efghij", memory, 6);
}

void test_a_block_that_ends_at_the_memorys_end_fits(void)
{
    put_letters(0, 12);
    tmini_ring_discard(&ring, 12);
    tmini_ring_write(&ring, letters, 4);
    expect_unread("abcd");
    TEST_ASSERT_EQUAL_INT('a', memory[0]); /* The first of the twelve bytes. */
}

void test_a_block_that_just_fits_does_not_close_the_ring(void)
{
    TEST_ASSERT_EQUAL_UINT(SIZE, tmini_ring_write(&ring, letters, SIZE));
    TEST_ASSERT_FALSE(tmini_ring_is_closed(&ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_write(&ring, letters, 0));
    TEST_ASSERT_FALSE(tmini_ring_is_closed(&ring));
}

void test_a_block_of_the_rings_size_fits_at_every_position(void)
{
    for (size_t start = 0; start < 2 * SIZE; start++) {
        age(start);
        tmini_ring_write(&ring, letters, SIZE);
        expect_unread("abcdefghijklmnop");
    }
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&ring));
}

void test_the_part_of_a_block_that_does_not_fit_is_refused_and_counted(void)
{
    put_letters(0, 10);
    tmini_ring_discard(&ring, 2);
    tmini_ring_write(&ring, &letters[10], 11);
    expect_unread("cdefghijklmnopqr");
    TEST_ASSERT_EQUAL_UINT(3, tmini_ring_overrun(&ring));
    tmini_ring_write(&ring, letters, 4);
    expect_unread("cdefghijklmnopqr");
    TEST_ASSERT_EQUAL_UINT(7, tmini_ring_overrun(&ring));
    tmini_ring_write(&ring, letters, SIZE_MAX / 2); /* Closed: none of them is read. */
    TEST_ASSERT_EQUAL_UINT(SIZE_MAX / 2 + 7, tmini_ring_overrun(&ring));
}

void test_a_block_larger_than_the_ring_is_cut(void)
{
    tmini_ring_write(&ring, letters, 26);
    expect_unread("abcdefghijklmnop");
    TEST_ASSERT_EQUAL_UINT(10, tmini_ring_overrun(&ring));
}

/* ----------------------------------------------------------------------------------- wraparound */

void test_indices_wrap_around_with_size_t(void)
{
    age(SIZE_MAX - 2);
    put_letters(0, SIZE);
    expect_unread("abcdefghijklmnop");
    put_letters(0, 1);
    TEST_ASSERT_EQUAL_UINT(1, tmini_ring_overrun(&ring));
    tmini_ring_discard(&ring, SIZE);
    tmini_ring_open(&ring);
    tmini_ring_write(&ring, letters, 10);
    tmini_ring_discard(&ring, 4);
    tmini_ring_write(&ring, letters, 11);
    expect_unread("efghijabcdefghij");
    TEST_ASSERT_EQUAL_UINT(2, tmini_ring_overrun(&ring));
}

/* -------------------------------------------------------------------------------- a closed ring */

/* Each time the indices move by a quarter of their range, so after four times they have wrapped. */
void test_a_ring_may_be_closed_and_opened_any_number_of_times(void)
{
    const size_t begin = SIZE_MAX - 2;
    age(begin);
    for (size_t time = 1; time <= 9; time++) {
        put_letters(0, SIZE + 1);
        TEST_ASSERT_TRUE(tmini_ring_is_closed(&ring));
        expect_unread("abcdefghijklmnop");
        TEST_ASSERT_TRUE(tmini_ring_intact(&ring));
        tmini_ring_discard(&ring, SIZE);
        expect_unread("");
        put_letters(0, 1);
        tmini_ring_open(&ring);
        TEST_ASSERT_FALSE(tmini_ring_is_closed(&ring));
        TEST_ASSERT_EQUAL_UINT(SIZE, tmini_ring_room(&ring));
        TEST_ASSERT_EQUAL_UINT(2 * time, tmini_ring_overrun(&ring));
        TEST_ASSERT_EQUAL_UINT(time * SIZE, tmini_ring_distance(begin, tmini_ring_head(&ring)));
        TEST_ASSERT_EQUAL_UINT(time * SIZE, tmini_ring_distance(begin, tmini_ring_tail(&ring)));
    }
}

void test_a_closed_ring_that_is_closed_again_stays_so(void)
{
    put_letters(0, 3);
    tmini_ring_gap(&ring);
    tmini_ring_gap(&ring);
    tmini_ring_put(&ring, 'x');
    expect_unread("abc");
    tmini_ring_discard(&ring, 3);
    tmini_ring_open(&ring);
    put_letters(3, 2);
    expect_unread("de");
}

void test_a_refused_byte_closes_the_ring_however_much_room_there_is_then(void)
{
    put_letters(0, SIZE);
    TEST_ASSERT_FALSE(tmini_ring_is_closed(&ring)); /* Full, but no byte is missing. */
    put_letters(SIZE, 1);
    TEST_ASSERT_TRUE(tmini_ring_is_closed(&ring));
    tmini_ring_discard(&ring, 10);
    put_letters(0, 2);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_write(&ring, letters, 3));
    expect_unread("klmnop");
    TEST_ASSERT_EQUAL_UINT(6, tmini_ring_overrun(&ring));
}

void test_a_ring_is_full_from_the_last_byte_that_fits_until_room_is_made(void)
{
    age(SIZE_MAX - 3); /* The indices wrap around meanwhile. */
    put_letters(0, SIZE - 1);
    TEST_ASSERT_FALSE(tmini_ring_is_full(&ring));
    put_letters(SIZE - 1, 1);
    TEST_ASSERT_TRUE(tmini_ring_is_full(&ring));
    tmini_ring_discard(&ring, 1);
    TEST_ASSERT_FALSE(tmini_ring_is_full(&ring));
}

void test_a_closed_ring_is_full_until_it_is_opened(void)
{
    put_letters(0, SIZE + 1);
    tmini_ring_discard(&ring, SIZE);
    TEST_ASSERT_TRUE(tmini_ring_is_full(&ring));
    tmini_ring_open(&ring);
    TEST_ASSERT_FALSE(tmini_ring_is_full(&ring));
}

void test_a_block_that_was_cut_closes_the_ring_too(void)
{
    put_letters(0, 10);
    TEST_ASSERT_EQUAL_UINT(6, tmini_ring_write(&ring, &letters[10], 7));
    TEST_ASSERT_TRUE(tmini_ring_is_closed(&ring));
    TEST_ASSERT_EQUAL_UINT(1, tmini_ring_overrun(&ring));
}

void test_a_ring_that_was_opened_again_takes_bytes_from_where_it_was(void)
{
    put_letters(0, SIZE + 1);
    tmini_ring_discard(&ring, SIZE);
    tmini_ring_open(&ring);
    TEST_ASSERT_FALSE(tmini_ring_is_closed(&ring));
    put_letters(3, 2);
    expect_unread("de");
    TEST_ASSERT_EQUAL_UINT(SIZE + 2, tmini_ring_distance(0, tmini_ring_head(&ring)));
}

void test_a_gap_closes_the_ring_without_counting_bytes(void)
{
    put_letters(0, 3);
    tmini_ring_gap(&ring);
    TEST_ASSERT_TRUE(tmini_ring_is_closed(&ring));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_overrun(&ring));
    put_letters(3, 1);
    expect_unread("abc");
    TEST_ASSERT_EQUAL_UINT(1, tmini_ring_overrun(&ring));
}

void test_there_is_room_for_what_would_be_stored(void)
{
    TEST_ASSERT_EQUAL_UINT(SIZE, tmini_ring_room(&ring));
    put_letters(0, 10);
    TEST_ASSERT_EQUAL_UINT(SIZE - 10, tmini_ring_room(&ring));
    tmini_ring_discard(&ring, 4);
    TEST_ASSERT_EQUAL_UINT(SIZE - 6, tmini_ring_room(&ring));
    TEST_ASSERT_EQUAL_UINT(SIZE - 6, tmini_ring_write(&ring, letters, SIZE));
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_room(&ring));
    tmini_ring_discard(&ring, 4);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_room(&ring)); /* The ring is closed. */
}

void test_a_block_is_stored_across_the_wrap_of_size_t(void)
{
    age(SIZE_MAX - 2);
    tmini_ring_write(&ring, letters, 20);
    expect_unread("abcdefghijklmnop");
    TEST_ASSERT_EQUAL_UINT(4, tmini_ring_overrun(&ring));
}

void test_the_count_of_refused_bytes_wraps_around_with_size_t(void)
{
    ring.overrun = SIZE_MAX - 1;
    put_letters(0, SIZE + 1);
    TEST_ASSERT_EQUAL_UINT(SIZE_MAX, tmini_ring_overrun(&ring));
    tmini_ring_write(&ring, letters, 3);
    TEST_ASSERT_EQUAL_UINT(2, tmini_ring_overrun(&ring));
}

/* ----------------------------------------------------------------------------------------- DMA */

/* Acts as DMA: the memory changes, then the position is published. */
static void dma_writes(size_t first, size_t count, size_t at)
{
    for (size_t i = 0; i < count; i++) {
        memory[(at + i) % SIZE] = letters[first + i];
    }
    tmini_ring_publish(&ring, (at + count) % SIZE);
}

/* As from a program that has forgotten rx_dma: it notices at once, not at its first overrun. */
void test_a_ring_that_the_cpu_feeds_ignores_positions_of_dma(void)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, SIZE, false));
    tmini_ring_publish(&ring, 6);
    TEST_ASSERT_EQUAL_UINT(0, tmini_ring_unread(&ring));
    TEST_ASSERT_EQUAL_UINT(SIZE, tmini_ring_room(&ring));
}

void test_a_lap_that_was_not_seen_leaves_the_newest_half_intact_at_most(void)
{
    use_dma();
    dma_writes(0, 4, 0);
    TEST_ASSERT_TRUE(tmini_ring_intact(&ring));
    tmini_ring_gap(&ring);
    TEST_ASSERT_FALSE(tmini_ring_intact(&ring));
    TEST_ASSERT_EQUAL_UINT(SIZE + 4, tmini_ring_unread(&ring));
    tmini_ring_publish(&ring, 6);
    TEST_ASSERT_EQUAL_UINT(SIZE + 6, tmini_ring_unread(&ring));
    tmini_ring_discard(&ring, SIZE + 6 - SIZE / 2);
    TEST_ASSERT_TRUE(tmini_ring_intact(&ring));
    TEST_ASSERT_FALSE(tmini_ring_is_closed(&ring));
}

void test_the_window_of_a_dma_ring_is_half_its_size(void)
{
    use_dma();
    TEST_ASSERT_EQUAL_UINT(SIZE / 2, ring.window);
}

void test_published_bytes_can_be_read(void)
{
    use_dma();
    expect_unread("");
    dma_writes(0, 3, 0);
    expect_unread("abc");
    dma_writes(3, 2, 3);
    expect_unread("abcde");
}

void test_publishing_the_same_position_again_changes_nothing(void)
{
    use_dma();
    dma_writes(0, 3, 0);
    tmini_ring_publish(&ring, 3);
    expect_unread("abc");
}

void test_a_position_equal_to_the_size_means_0(void)
{
    use_dma();
    dma_writes(0, 8, 0);
    memcpy(&memory[8], "ijklmnop", 8);
    tmini_ring_publish(&ring, SIZE);
    expect_unread("abcdefghijklmnop");
    tmini_ring_publish(&ring, 0);
    expect_unread("abcdefghijklmnop");
}

void test_a_position_before_the_last_one_has_wrapped_around_the_memorys_end(void)
{
    use_dma();
    dma_writes(0, 8, 0);
    dma_writes(8, 6, 8);
    tmini_ring_discard(&ring, 12);
    dma_writes(14, 5, 14);
    expect_unread("mnopqrs");
}

void test_more_unread_bytes_than_the_window_are_an_overrun(void)
{
    use_dma();
    dma_writes(0, 8, 0);
    TEST_ASSERT_EQUAL_UINT(SIZE / 2, tmini_ring_unread(&ring));
    dma_writes(8, 8, 8);
    dma_writes(16, 8, 0);
    TEST_ASSERT_EQUAL_UINT(24, tmini_ring_unread(&ring));
    tmini_ring_discard(&ring, 16);
    expect_unread("qrstuvwx");
}

void test_unread_bytes_are_intact_while_they_fit_the_window(void)
{
    put_letters(0, SIZE + 1);
    TEST_ASSERT_TRUE(tmini_ring_intact(&ring)); /* The CPU overwrites nothing. */
    use_dma();
    dma_writes(0, 8, 0);
    TEST_ASSERT_TRUE(tmini_ring_intact(&ring));
    dma_writes(8, 1, 8);
    TEST_ASSERT_FALSE(tmini_ring_intact(&ring));
    tmini_ring_discard(&ring, 1);
    TEST_ASSERT_TRUE(tmini_ring_intact(&ring));
}

void test_dma_positions_are_right_across_the_wrap_of_size_t(void)
{
    use_dma();
    age(SIZE_MAX - 2); /* Position 13. */
    dma_writes(0, 7, 13);
    expect_unread("abcdefg");
    tmini_ring_discard(&ring, 5);
    dma_writes(7, 4, 4);
    expect_unread("fghijk");
}

/* This is a wrong use, but must do no harm: tearDown() checks the guards. */
void test_bytes_put_into_a_dma_ring_stay_inside_its_memory(void)
{
    use_dma();
    for (size_t i = 0; i < 5 * SIZE; i++) {
        put_letters(0, 1);
        tmini_ring_gap(&ring);
        put_letters(0, 1);
        tmini_ring_publish(&ring, (3 * i) % SIZE);
        tmini_ring_discard(&ring, tmini_ring_unread(&ring));
    }
}

/* ----------------------------------------------------------------------------- reading in place */

void test_unread_bytes_are_copied_across_the_memorys_end(void)
{
    uint8_t copy[6] = {0};
    age(12);
    put_letters(0, 10);
    tmini_ring_copy(&ring, 2, copy, 5);
    TEST_ASSERT_EQUAL_HEX8_ARRAY("cdefg\0", copy, 6);
    tmini_ring_copy(&ring, 2, copy, 0);
    TEST_ASSERT_EQUAL_HEX8_ARRAY("cdefg\0", copy, 6);
}

void test_unread_bytes_in_one_piece_are_read_where_they_are(void)
{
    size_t count = 5;
    age(5);
    put_letters(0, SIZE);
    TEST_ASSERT_EQUAL_PTR(&memory[7], tmini_ring_piece(&ring, 2, &count));
    TEST_ASSERT_EQUAL_UINT(5, count);
    count = 9;
    TEST_ASSERT_EQUAL_PTR(&memory[7], tmini_ring_piece(&ring, 2, &count));
    TEST_ASSERT_EQUAL_UINT(9, count); /* Up to the memory's last byte. */
}

void test_of_unread_bytes_in_two_pieces_the_first_piece_comes_first(void)
{
    size_t count = 10;
    age(5);
    put_letters(0, SIZE);
    TEST_ASSERT_EQUAL_PTR(&memory[7], tmini_ring_piece(&ring, 2, &count));
    TEST_ASSERT_EQUAL_UINT(9, count);
    count = 5;
    TEST_ASSERT_EQUAL_PTR(&memory[0], tmini_ring_piece(&ring, 11, &count));
    TEST_ASSERT_EQUAL_UINT(5, count);
}

/* -------------------------------------------------------------------------------- large rings */

/* A ring of this size. Only the 16 bytes from `place` on have memory. */
static void use_large(size_t size, size_t place)
{
    uint8_t *const first = (uint8_t *)((uintptr_t)memory - place);
    memset(memory, GUARD, SIZE);
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, first, size, false));
    age(place);
}

static void bytes_are_right_at(size_t size, size_t place)
{
    uint8_t copy[5] = {0};
    size_t count = size;
    use_large(size, place);
    TEST_ASSERT_EQUAL_UINT(3, tmini_ring_write(&ring, letters, 3));
    put_letters(3, 2);
    TEST_ASSERT_EQUAL_HEX8_ARRAY("abcde", memory, 5);
    expect_unread("abcde");
    tmini_ring_copy(&ring, 0, copy, 5);
    TEST_ASSERT_EQUAL_HEX8_ARRAY("abcde", copy, 5);
    TEST_ASSERT_EQUAL_PTR(memory, tmini_ring_piece(&ring, 0, &count));
    TEST_ASSERT_EQUAL_UINT(size - place, count);
    ring.tail = 0;
    TEST_ASSERT_EQUAL_INT('a', tmini_ring_peek(&ring, place));
    TEST_ASSERT_EQUAL_PTR(memory, tmini_ring_piece(&ring, place, &count));
    use_large(size, place);
    ring.tail = place + 1 - size; /* Room for one byte. */
    put_letters(0, 2);
    TEST_ASSERT_EQUAL_UINT(1, tmini_ring_overrun(&ring));
}

void test_places_beyond_8_and_16_bits_are_not_cut(void)
{
    bytes_are_right_at(512, 256);
#if SIZE_MAX > 65535
    bytes_are_right_at(131072, 65536);
#endif
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
