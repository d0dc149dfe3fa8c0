/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests the ring with the atomic primitives for IAR and ARMCC 5, compiled by GCC with stand-ins.
 * This cannot show that the real compilers accept them. */

#include "tmini/parts/tmini_ring.h"

#include <string.h>

#include "unity.h"

#ifndef TMINI_ATOMIC_CORTEX_M_H
#error "the ring was compiled with other primitives"
#endif

static uint8_t memory[8];
static tmini_ring_t ring;

void setUp(void)
{
    TEST_ASSERT_EQUAL(TMINI_OK, tmini_ring_init(&ring, memory, sizeof memory, false));
}

void tearDown(void) {}

void test_a_value_stored_is_the_value_loaded(void)
{
    size_t value = 1;
    tmini_store(&value, 0x12345678u);
    tmini_fence();
    TEST_ASSERT_EQUAL_UINT32(0x12345678u, tmini_load(&value));
}

void test_bytes_come_out_of_the_ring_in_the_order_they_went_in(void)
{
    for (unsigned i = 0; i < 100; i++) {
        tmini_ring_put(&ring, (uint8_t)i);
        TEST_ASSERT_EQUAL_UINT32(i + 1, tmini_ring_head(&ring));
        TEST_ASSERT_EQUAL_HEX8(i, memory[i % sizeof memory]);
        tmini_store(&ring.tail, i + 1); /* The consumer has taken the byte. */
    }
    TEST_ASSERT_EQUAL_UINT32(0, tmini_ring_overrun(&ring));
}
