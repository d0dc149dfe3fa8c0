/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The model of interrupt lines that the models of boards use. */

#include "irq_lines.h"
#include "rows.h"

#include "unity.h"

#include <string.h>

enum { LOW, HIGH };

static unsigned low_flag;
static unsigned high_flag;
static bool low_clears;
static unsigned locked_up;
static char order[16];

static bool is_low_up(void)
{
    return low_flag > 0;
}

static bool is_high_up(void)
{
    return high_flag > 0;
}

static void note(const char *what)
{
    (void)strncat(order, what, sizeof order - strlen(order) - 1);
}

static void handle_low(void)
{
    note("l");
    irq_access();
    low_flag -= low_clears;
    note(".");
}

static void handle_high(void)
{
    note("h");
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
    order[0] = '\0';
    irq_reset(note_lock_up);
    irq.lines[LOW] = (irq_line_t){.is_up = is_low_up, .handler = handle_low, .priority = 5};
    irq.lines[HIGH] = (irq_line_t){.is_up = is_high_up, .handler = handle_high, .priority = 4};
}

/* Words of the rows:
 *
 *     low:3 high      the line is up until its handler has run three times, or once
 *     stuck           the handler of the lower priority leaves its flag
 *     equal           both have the same priority
 *     masked:1 disabled:1     all lines, or the lower one
 *     access          the program accesses a register
 *     happens:2       the higher line goes up at an access, after two others
 *     order:l.        what handlers have done: "l" enters the lower one, "." leaves it, "h" is the
 *                     higher one; and see tell_word() */
static void tell_word(char *word)
{
    const row_number_t numbers[] = {
        {"served", irq.lines[LOW].served},
        {"nested", irq.nested},
        {"locked-up", locked_up},
        {"in-handler", irq_is_in_handler()},
    };
    if (row_is(word, "low")) {
        low_flag = row_number(word);
    } else if (row_is(word, "high")) {
        raise_high();
    } else if (row_is(word, "stuck")) {
        low_clears = false;
    } else if (row_is(word, "equal")) {
        irq.lines[HIGH].priority = irq.lines[LOW].priority;
    } else if (row_is(word, "masked")) {
        irq.masked = row_number(word) != 0;
    } else if (row_is(word, "disabled")) {
        irq.lines[LOW].disabled = row_number(word) != 0;
    } else if (row_is(word, "access")) {
        irq_access();
    } else if (row_is(word, "happens")) {
        irq_happen_after(row_number(word), raise_high);
    } else if (row_is(word, "order")) {
        TEST_ASSERT_EQUAL_STRING(row_text(word), order);
    } else {
        TEST_ASSERT_TRUE_MESSAGE(row_expects(word, numbers), word);
    }
}

static const row_t rows[] IN_FLASH = {
    ROW(a_line_that_is_down_interrupts_nothing, "access order:"),
    ROW(a_handler_is_entered_again_as_long_as_its_line_is_up,
        "low:3 access order:l.l.l. served:3 in-handler:0"),
    ROW(a_handler_that_leaves_its_flag_is_a_lock_up, "low:1 stuck access locked-up:1"),
    ROW(the_higher_priority_comes_first_and_interrupts_the_lower, /* While its handler runs. */
        "low:1 high access order:hl. low:1 happens:1 access order:hl.lh. nested:1"),
    ROW(lines_of_equal_priority_come_one_after_the_other,
        "equal low:1 happens:1 access order:l.h nested:0"),
    ROW(masked_or_disabled_lines_wait,
        "low:1 masked:1 access masked:0 disabled:1 access order: disabled:0 access order:l."),
    ROW(an_event_happens_once_at_the_access_it_is_meant_for,
        "happens:2 access access order: access order:h access order:h"),
};

void test_interrupt_lines(void)
{
    tell_rows(rows, tell_word);
}
