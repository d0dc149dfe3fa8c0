/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Names of statuses. */

#include "tmini/tmini_status.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_each_status_has_a_phrase_that_tells_it_from_the_others(void)
{
    TEST_ASSERT_EQUAL_STRING("ok", tmini_status_name(TMINI_OK));
    TEST_ASSERT_EQUAL_STRING("invalid argument", tmini_status_name(TMINI_ERROR_ARGUMENT));
    TEST_ASSERT_EQUAL_STRING("not while scanning", tmini_status_name(TMINI_ERROR_STATE));
    TEST_ASSERT_EQUAL_STRING("busy with another command", tmini_status_name(TMINI_ERROR_BUSY));
    TEST_ASSERT_EQUAL_STRING("timeout", tmini_status_name(TMINI_ERROR_TIMEOUT));
    TEST_ASSERT_EQUAL_STRING("write failed", tmini_status_name(TMINI_ERROR_WRITE));
    TEST_ASSERT_EQUAL_STRING("unexpected reply", tmini_status_name(TMINI_ERROR_REPLY));
    TEST_ASSERT_EQUAL_STRING("aborted", tmini_status_name(TMINI_ERROR_ABORTED));
}

void test_success_is_0_and_errors_are_negative(void)
{
    TEST_ASSERT_EQUAL_INT(0, TMINI_OK);
    TEST_ASSERT_EQUAL_INT(-1, TMINI_ERROR_ARGUMENT);
    TEST_ASSERT_EQUAL_INT(-2, TMINI_ERROR_STATE);
    TEST_ASSERT_EQUAL_INT(-3, TMINI_ERROR_BUSY);
    TEST_ASSERT_EQUAL_INT(-4, TMINI_ERROR_TIMEOUT);
    TEST_ASSERT_EQUAL_INT(-5, TMINI_ERROR_WRITE);
    TEST_ASSERT_EQUAL_INT(-6, TMINI_ERROR_REPLY);
    TEST_ASSERT_EQUAL_INT(-7, TMINI_ERROR_ABORTED);
}

void test_any_other_value_has_a_name_too(void)
{
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_status_name((tmini_status_t)1));
    TEST_ASSERT_EQUAL_STRING("unknown status", tmini_status_name((tmini_status_t)-8));
}
