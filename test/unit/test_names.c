/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Names of statuses, events, states and faults. */

#include <string.h>

#include "tmini/tmini_names.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_each_status_has_a_phrase_of_its_own(void)
{
    TEST_ASSERT_EQUAL_STRING("ok", tmini_status_name(TMINI_OK));
    TEST_ASSERT_EQUAL_STRING("invalid argument", tmini_status_name(TMINI_ERROR_ARGUMENT));
    TEST_ASSERT_EQUAL_STRING("not while scanning", tmini_status_name(TMINI_ERROR_STATE));
    TEST_ASSERT_EQUAL_STRING("timeout", tmini_status_name(TMINI_ERROR_TIMEOUT));
    TEST_ASSERT_EQUAL_STRING("write failed", tmini_status_name(TMINI_ERROR_WRITE));
    TEST_ASSERT_EQUAL_STRING("unexpected reply", tmini_status_name(TMINI_ERROR_REPLY));
    TEST_ASSERT_EQUAL_STRING("aborted", tmini_status_name(TMINI_ERROR_ABORTED));
    TEST_ASSERT_EQUAL_STRING("listen only: nothing is sent",
                             tmini_status_name(TMINI_ERROR_LISTEN_ONLY));
}

void test_success_is_0_and_errors_are_negative(void)
{
    TEST_ASSERT_EQUAL_INT(0, TMINI_OK);
    TEST_ASSERT_EQUAL_INT(-1, TMINI_ERROR_ARGUMENT);
    TEST_ASSERT_EQUAL_INT(-2, TMINI_ERROR_STATE);
    TEST_ASSERT_EQUAL_INT(-3, TMINI_ERROR_TIMEOUT);
    TEST_ASSERT_EQUAL_INT(-4, TMINI_ERROR_WRITE);
    TEST_ASSERT_EQUAL_INT(-5, TMINI_ERROR_REPLY);
    TEST_ASSERT_EQUAL_INT(-6, TMINI_ERROR_ABORTED);
}

void test_any_other_value_has_a_name_too(void)
{
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_status_name((tmini_status_t)1));
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_status_name((tmini_status_t)-8));
    if (sizeof(tmini_status_t) > 2) {
        TEST_ASSERT_EQUAL_STRING("unknown status", tmini_status_name((tmini_status_t)-65536));
    }
}

/* All names differ from each other and from the name for an unknown value. */
static void names_differ(const char *const *names, size_t count, const char *otherwise)
{
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_NOT_EQUAL_INT(0, strcmp(otherwise, names[i]));
        for (size_t other = 0; other < i; other++) {
            TEST_ASSERT_NOT_EQUAL_INT(0, strcmp(names[other], names[i]));
        }
    }
}

void test_each_event_has_a_name_of_its_own(void)
{
    const char *names[TMINI_EVENT_MORE + 1];
    for (unsigned event = 0; event <= TMINI_EVENT_MORE; event++) {
        names[event] = tmini_event_name((tmini_event_t)event);
    }
    names_differ(names, TMINI_EVENT_MORE + 1, "unknown event");
    TEST_ASSERT_EQUAL_STRING("scan", tmini_event_name(TMINI_EVENT_SCAN));
    TEST_ASSERT_EQUAL_STRING("command failed", tmini_event_name(TMINI_EVENT_COMMAND_FAILED));
    TEST_ASSERT_EQUAL_STRING("unknown event", tmini_event_name((tmini_event_t)16));
    TEST_ASSERT_EQUAL_STRING("unknown event", tmini_event_name((tmini_event_t)-1));
}

void test_each_state_has_a_name_of_its_own(void)
{
    const char *names[TMINI_STATE_RECOVERING + 1];
    for (unsigned state = 0; state <= TMINI_STATE_RECOVERING; state++) {
        names[state] = tmini_state_name((tmini_state_t)state);
    }
    names_differ(names, TMINI_STATE_RECOVERING + 1, "unknown state");
    TEST_ASSERT_EQUAL_STRING("unknown", tmini_state_name(TMINI_STATE_UNKNOWN));
    TEST_ASSERT_EQUAL_STRING("scanning", tmini_state_name(TMINI_STATE_SCANNING));
    TEST_ASSERT_EQUAL_STRING("unknown state", tmini_state_name((tmini_state_t)7));
}

void test_each_fault_has_the_name_of_its_module(void)
{
    TEST_ASSERT_EQUAL_STRING("sensor", tmini_fault_name(TMINI_FAULT_SENSOR));
    TEST_ASSERT_EQUAL_STRING("encoder", tmini_fault_name(TMINI_FAULT_ENCODER));
    TEST_ASSERT_EQUAL_STRING("wireless power", tmini_fault_name(TMINI_FAULT_WIRELESS_POWER));
    TEST_ASSERT_EQUAL_STRING("PD", tmini_fault_name(TMINI_FAULT_PD));
    TEST_ASSERT_EQUAL_STRING("LD", tmini_fault_name(TMINI_FAULT_LD));
    TEST_ASSERT_EQUAL_STRING("data", tmini_fault_name(TMINI_FAULT_DATA));
    TEST_ASSERT_EQUAL_STRING("frequency", tmini_fault_name(TMINI_FAULT_FREQUENCY));
}

void test_what_is_not_one_fault_has_a_name_too(void)
{
    TEST_ASSERT_EQUAL_STRING("unknown fault", tmini_fault_name((tmini_fault_t)0));
    TEST_ASSERT_EQUAL_STRING("unknown fault", tmini_fault_name((tmini_fault_t)3));
    TEST_ASSERT_EQUAL_STRING("unknown fault", tmini_fault_name((tmini_fault_t)128));
}

static void faults_read(uint8_t faults, const char *expected)
{
    char text[TMINI_FAULTS_TEXT_SIZE];
    TEST_ASSERT_EQUAL_PTR(text, tmini_faults_text(faults, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
    text[0] = '\0';
    (void)tmini_faults_text(faults, text, SIZE_MAX / 2 + 1); /* 0 in a narrower type. */
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

void test_faults_are_listed_in_the_order_of_their_bits(void)
{
    faults_read(0, "none");
    faults_read(0x02, "encoder");
    faults_read(0x22, "encoder, data");
    faults_read(0x7F, "sensor, encoder, wireless power, PD, LD, data, frequency");
}

void test_the_reserved_bit_is_no_fault(void)
{
    faults_read(0x80, "none");
    faults_read(0x81, "sensor");
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
