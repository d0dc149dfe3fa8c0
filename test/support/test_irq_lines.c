/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The model of interrupt lines that the models of boards use. */

#include "irq_lines.h"

#include "unity.h"

enum { LOW, HIGH };

static unsigned low_flag;
static unsigned high_flag;
static bool low_clears;
static unsigned locked_up;
static char order[16];
static unsigned length;

static bool is_low_up(void)
{
    return low_flag > 0;
}

static bool is_high_up(void)
{
    return high_flag > 0;
}

static void note(char what)
{
    if (length < sizeof order - 1) {
        order[length++] = what;
    }
}

static void handle_low(void)
{
    note('l');
    irq_access();
    low_flag -= low_clears;
    note('.');
}

static void handle_high(void)
{
    note('h');
    irq_access();
    high_flag--;
}

static void note_lock_up(unsigned line)
{
    locked_up = line + 1;
}

static void raise_high(void)
{
    high_flag = 1;
}

void setUp(void)
{
    low_flag = 0;
    high_flag = 0;
    low_clears = true;
    locked_up = 0;
    length = 0;
    for (unsigned i = 0; i < sizeof order; i++) {
        order[i] = '\0';
    }
    irq_reset(note_lock_up);
    irq.lines[LOW] = (irq_line_t){.is_up = is_low_up, .handler = handle_low, .priority = 5};
    irq.lines[HIGH] = (irq_line_t){.is_up = is_high_up, .handler = handle_high, .priority = 4};
}

void tearDown(void) {}

void test_a_line_that_is_down_interrupts_nothing(void)
{
    irq_access();
    TEST_ASSERT_EQUAL_STRING("", order);
}

void test_a_handler_is_entered_again_as_long_as_its_line_is_up(void)
{
    low_flag = 3;
    irq_access();
    TEST_ASSERT_EQUAL_STRING("l.l.l.", order);
    TEST_ASSERT_EQUAL_UINT32(3, irq.lines[LOW].served);
    TEST_ASSERT_FALSE(irq_is_in_handler());
}

void test_a_handler_that_leaves_its_flag_is_a_lock_up(void)
{
    low_flag = 1;
    low_clears = false;
    irq_access();
    TEST_ASSERT_EQUAL_UINT(LOW + 1, locked_up);
}

void test_the_higher_priority_comes_first_and_interrupts_the_lower(void)
{
    low_flag = 1;
    high_flag = 1;
    irq_access();
    TEST_ASSERT_EQUAL_STRING("hl.", order);
    low_flag = 1;
    irq_happen_after(1, raise_high); /* While the handler of the lower priority runs. */
    irq_access();
    TEST_ASSERT_EQUAL_STRING("hl.lh.", order);
    TEST_ASSERT_EQUAL_UINT32(1, irq.nested);
}

void test_lines_of_equal_priority_come_one_after_the_other(void)
{
    irq.lines[HIGH].priority = 5;
    low_flag = 1;
    irq_happen_after(1, raise_high);
    irq_access();
    TEST_ASSERT_EQUAL_STRING("l.h", order);
    TEST_ASSERT_EQUAL_UINT32(0, irq.nested);
}

void test_masked_or_disabled_lines_wait(void)
{
    low_flag = 1;
    irq.masked = true;
    irq_access();
    irq.masked = false;
    irq.lines[LOW].disabled = true;
    irq_access();
    TEST_ASSERT_EQUAL_STRING("", order);
    irq.lines[LOW].disabled = false;
    irq_access();
    TEST_ASSERT_EQUAL_STRING("l.", order);
}

void test_an_event_happens_once_at_the_access_it_is_meant_for(void)
{
    irq_happen_after(2, raise_high);
    irq_access();
    irq_access();
    TEST_ASSERT_EQUAL_STRING("", order);
    irq_access();
    TEST_ASSERT_EQUAL_STRING("h", order);
    irq_access();
    TEST_ASSERT_EQUAL_STRING("h", order);
}
