/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The seeded random numbers that randomised tests use. */

#include "random.h"

#include "unity.h"

static random_t dice;

void setUp(void)
{
    random_seed(&dice, 1);
}

void test_the_same_seed_gives_the_same_numbers(void)
{
    random_t other;
    random_seed(&other, 1);
    for (int i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_UINT64(random_u64(&other), random_u64(&dice));
    }
}

void test_another_seed_gives_other_numbers(void)
{
    random_t other;
    random_seed(&other, 0);
    TEST_ASSERT_NOT_EQUAL(random_u64(&other), random_u64(&dice));
}

void test_every_number_in_a_range_comes_up_about_equally_often(void)
{
    unsigned seen[10] = {0};
    for (int i = 0; i < 100000; i++) {
        const uint32_t number = random_between(&dice, 5, 14);
        TEST_ASSERT_TRUE(number >= 5u && number <= 14u);
        seen[number - 5u]++;
    }
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_UINT_WITHIN(400, 10000, seen[i]);
    }
}

void test_below_0_and_below_1_are_0(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, random_below(&dice, 0));
    TEST_ASSERT_EQUAL_UINT32(0, random_below(&dice, 1));
}

/* In an exponential distribution 36.8 % lie beyond the mean, 13.5 % beyond twice the mean. */
void test_gaps_are_exponentially_distributed(void)
{
    uint64_t sum = 0;
    unsigned beyond = 0;
    unsigned far_beyond = 0;
    for (int i = 0; i < 100000; i++) {
        const uint64_t gap = random_gap(&dice, 1000);
        TEST_ASSERT_TRUE(gap >= 1u);
        sum += gap;
        beyond += gap > 1000u ? 1u : 0u;
        far_beyond += gap > 2000u ? 1u : 0u;
    }
    TEST_ASSERT_UINT_WITHIN(10, 1000, (unsigned)(sum / 100000u));
    TEST_ASSERT_UINT_WITHIN(500, 36788, beyond);
    TEST_ASSERT_UINT_WITHIN(500, 13534, far_beyond);
}
