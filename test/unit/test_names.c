/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Names of statuses, events, states and faults. */

#include "rows.h"

#include "tmini/tmini_names.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

static const char *faults_text(uint8_t faults)
{
    static char text[TMINI_FAULTS_TEXT_SIZE];
    TEST_ASSERT_EQUAL_PTR(text, tmini_faults_text(faults, text, sizeof text));
    text[0] = '\0';
    return tmini_faults_text(faults, text, SIZE_MAX / 2 + 1); /* 0 in a narrower type. */
}

static const char *name_of(const char *kind, int number)
{
    return strncmp(kind, "status", 6) == 0   ? tmini_status_name((tmini_status_t)number)
           : strncmp(kind, "event", 5) == 0  ? tmini_event_name((tmini_event_t)number)
           : strncmp(kind, "state", 5) == 0  ? tmini_state_name((tmini_state_t)number)
           : strncmp(kind, "faults", 6) == 0 ? faults_text((uint8_t)number)
                                             : tmini_fault_name((tmini_fault_t)number);
}

/* "KIND NUMBER=NAME; NUMBER=NAME …" */
static void expect_names(const row_t *row)
{
    const char *text = strchr(row->steps, ' ');
    while (*text != '\0') {
        char *name;
        char expected[TMINI_FAULTS_TEXT_SIZE];
        const int number = (int)strtol(text, &name, 0);
        const size_t length = strcspn(++name, ";");
        memcpy(expected, name, length);
        expected[length] = '\0';
        TEST_ASSERT_EQUAL_STRING(expected, name_of(row->steps, number));
        text = name + length + strspn(name + length, ";");
    }
}

static const row_t rows[] IN_FLASH = {
    ROW(success_is_0_errors_are_negative_and_each_has_a_phrase,
        "status 0=ok; -1=invalid argument; -2=not while scanning; -3=timeout; -4=write failed; "
        "-5=unexpected reply; -6=aborted; -7=listen only: nothing is sent; -8=unknown status; "
        "1=unknown status"),
    ROW(each_event_has_a_name,
        "event 0=none; 1=started; 2=stopped; 3=information; 4=health; 5=frequency; 6=rebooted; "
        "7=command failed; 8=unwanted scanning; 9=recovered; 10=faults changed; 11=packet; "
        "12=scan; 13=paused; 14=lost; 15=more to do; 16=unknown event; -1=unknown event"),
    ROW(each_state_has_a_name, "state 0=unknown; 1=idle; 2=busy; 3=stopping; 4=starting; "
                               "5=scanning; 6=recovering; 7=unknown state"),
    ROW(each_fault_has_the_name_of_its_module,
        "fault 1=sensor; 2=encoder; 4=wireless power; 8=PD; 16=LD; 32=data; 64=frequency"),
    ROW(what_is_not_one_fault_has_a_name_too,
        "fault 0=unknown fault; 3=unknown fault; 128=unknown fault"),
    ROW(faults_are_listed_in_the_order_of_their_bits, /* The reserved bit is none. */
        "faults 0=none; 0x02=encoder; 0x22=encoder, data; 0x7F=sensor, encoder, wireless power, "
        "PD, LD, data, frequency; 0x80=none; 0x81=sensor"),
};

void test_rows(void)
{
    run_rows(rows, expect_names);
}

void test_a_status_beyond_16_bits_has_a_name_too(void)
{
    if (sizeof(tmini_status_t) > 2) {
        TEST_ASSERT_EQUAL_STRING("unknown status", tmini_status_name((tmini_status_t)-65536));
    }
}

void test_a_text_that_does_not_fit_is_cut_off_and_nothing_is_written_after_it(void)
{
    char text[8] = "1234567";
    (void)tmini_faults_text(0x22, text, 6);
    TEST_ASSERT_EQUAL_STRING("encod", text);
    TEST_ASSERT_EQUAL_INT('7', text[6]);
    (void)tmini_faults_text(0, text, 3);
    TEST_ASSERT_EQUAL_STRING("no", text);
    (void)tmini_faults_text(0, text, 1);
    TEST_ASSERT_EQUAL_STRING("", text);
    text[0] = 'x';
    TEST_ASSERT_EQUAL_PTR(text, tmini_faults_text(0x22, text, 0));
    TEST_ASSERT_EQUAL_INT('x', text[0]);
}
