/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The parts of frames that the parser's tests do not cover: a sample that wraps around the end of
 * the ring, and a reply whose content DMA overwrites. */

#include <string.h>

#include "tmini/parts/tmini_frame.h"
#include "unity.h"

#define SIZE 32u
#define GUARD 0x5A

static tmini_ring_t ring;
static tmini_frame_t frame;
static uint8_t memory[SIZE];

/* The content of the ring, from its oldest byte on. */
static const uint8_t letters[] = "abcdefghijklmnopqrstuvwxyzABCDEF";

static void hold_letters_from(size_t place, bool dma)
{
    TEST_ASSERT_EQUAL_INT(TMINI_OK, tmini_ring_init(&ring, memory, SIZE, dma));
    ring.head = place;
    ring.stop = place;
    ring.tail = place;
    for (size_t i = 0; i < SIZE; i++) {
        memory[(place + i) % SIZE] = letters[i];
    }
    frame = (tmini_frame_t){.ring = &ring};
}

void setUp(void) {}

void tearDown(void) {}

/* The samples from sample `index` on; `place` is their address, NULL if the sample's two parts were
 * joined in a copy. Sample 0 follows the packet's header of ten bytes: it is "klm". */
static void expect_samples(size_t index, size_t wanted, size_t count, const uint8_t *place)
{
    uint8_t joined[4] = {0, 0, 0, GUARD};
    size_t got = wanted;
    const uint8_t *const samples = tmini_frame_samples(&frame, index, &got, joined);
    TEST_ASSERT_EQUAL_UINT(count, got);
    TEST_ASSERT_EQUAL_PTR(place != NULL ? place : joined, samples);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(&letters[10 + 3 * index], samples, 3 * count);
    TEST_ASSERT_EQUAL_HEX8(GUARD, joined[3]);
}

void test_samples_that_lie_in_one_piece_are_read_where_they_are(void)
{
    hold_letters_from(1, false);
    expect_samples(0, 7, 7, &memory[11]); /* Up to the memory's last byte. */
    expect_samples(1, 4, 4, &memory[14]);
    expect_samples(6, 1, 1, &memory[29]);
}

void test_of_samples_in_two_pieces_the_whole_ones_of_the_first_piece_come_first(void)
{
    hold_letters_from(11, false);
    expect_samples(0, 7, 3, &memory[21]); /* Eleven bytes before the end. */
    expect_samples(2, 2, 1, &memory[27]);
}

void test_a_sample_that_straddles_the_memorys_end_is_put_together(void)
{
    hold_letters_from(11, false);
    expect_samples(3, 4, 1, NULL); /* Two bytes at the end, one at the beginning. */
    expect_samples(3, 1, 1, NULL);
    expect_samples(4, 2, 2, &memory[1]);
    hold_letters_from(12, false);
    expect_samples(3, 2, 1, NULL); /* One byte at the end, two at the beginning. */
}

void test_a_replys_content_is_what_follows_its_header_of_seven_bytes(void)
{
    uint8_t content[5] = {0, 0, 0, 0, GUARD};
    hold_letters_from(23, false);
    TEST_ASSERT_TRUE(tmini_frame_content(&frame, content, 4));
    TEST_ASSERT_EQUAL_HEX8_ARRAY("hijk\x5A", content, 5);
}

void test_content_that_dma_may_have_overwritten_is_not_intact(void)
{
    uint8_t content[4];
    hold_letters_from(0, true);
    tmini_ring_publish(&ring, SIZE / 2);
    TEST_ASSERT_TRUE(tmini_frame_content(&frame, content, 4));
    TEST_ASSERT_TRUE(tmini_frame_intact(&frame));
    tmini_ring_publish(&ring, SIZE / 2 + 1);
    TEST_ASSERT_FALSE(tmini_frame_content(&frame, content, 4));
    TEST_ASSERT_FALSE(tmini_frame_intact(&frame));
}
