/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "rows.h"

#include "unity.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const row_t *current;
static void (*run_row)(const row_t *row);

static void run_current(void)
{
    run_row(current);
}

#ifdef __linux__ /* An emulated machine may have no environment. */
static bool is_row_found = false;

static void demand_the_row(void)
{
    if (!is_row_found) {
        (void)fputs("there is no such row\n", stderr);
        _Exit(1);
    }
}

static bool is_chosen(const char *name)
{
    const char *const only = getenv("TMINI_TEST_ROW");
    const bool is_it = only == NULL || strcmp(only, name) == 0;
    is_row_found |= is_it;
    return is_it;
}
#elif !defined __AVR__
static bool is_chosen(const char *name)
{
    return name != NULL;
}
#endif

void rows_run(const row_t *rows, size_t count, void (*run)(const row_t *row))
{
    const char *const name = Unity.CurrentTestName;
    const UNITY_LINE_TYPE line = Unity.CurrentTestLineNumber;
    run_row = run;
#ifdef __linux__
    (void)atexit(demand_the_row);
#endif
    for (size_t i = 0; i < count; i++) {
#ifdef __AVR__
        static row_t row;
        memcpy_P(&row, &rows[i], sizeof row);
        current = &row;
        UnityDefaultTestRun(run_current, "", (int)current->line);
#else
        current = &rows[i];
        if (is_chosen(current->name)) {
            UnityDefaultTestRun(run_current, current->name, (int)current->line);
        }
#endif
    }
    Unity.CurrentTestName = name;
    Unity.CurrentTestLineNumber = line;
}

/* The place after the ")" that belongs to a "(" before `text`. */
static const char *end_of(const char *text)
{
    for (unsigned open = 1; open > 0; text++) {
        TEST_ASSERT_NOT_EQUAL('\0', *text);
        open += *text == '(' ? 1u : 0u;
        open -= *text == ')' ? 1u : 0u;
    }
    return text;
}

/* Ends before a ")" that belongs to no "(". */
void row_tell(const char *text, void (*tell)(char *word))
{
    for (text += strspn(text, " "); *text != '\0' && *text != ')'; text += strspn(text, " ")) {
        const size_t length = strcspn(text, " ");
        char word[ROW_WORD_MAX];
        TEST_ASSERT_TRUE(length < sizeof word);
        memcpy(word, text, length);
        word[length] = '\0';
        text += length;
        if (word[length - 1] == '(') {
            for (unsigned times = (unsigned)atoi(word); times > 0; times--) {
                row_tell(text, tell);
            }
            text = end_of(text);
        } else {
            tell(word);
        }
    }
}

static void (*tell_word)(char *word);

static void tell_steps(const row_t *row)
{
    row_tell(row->steps, tell_word);
}

void rows_tell(const row_t *rows, size_t count, void (*tell)(char *word))
{
    tell_word = tell;
    rows_run(rows, count, tell_steps);
}

bool row_is(const char *word, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(word, name, length) == 0 && (word[length] == ':' || word[length] == '\0');
}

const char *row_text(const char *word)
{
    const char *const colon = strchr(word, ':');
    return colon != NULL ? colon + 1 : "";
}

uint32_t row_number(const char *word)
{
    return (uint32_t)strtoul(row_text(word), NULL, 0);
}

long row_angle(const char *text, char **rest)
{
    const long number = strtol(text, rest, 10);
    return **rest == 'd' ? number * 64 + strtol(*rest + 1, rest, 10) : number;
}

size_t row_bytes(const char *digits, uint8_t *bytes)
{
    size_t count = 0;
    for (; digits[0] != '\0'; digits += 2) {
        const char pair[3] = {digits[0], digits[1], '\0'};
        bytes[count++] = (uint8_t)strtoul(pair, NULL, 16);
    }
    return count;
}

bool rows_expect(const char *word, const row_number_t *numbers, size_t count)
{
    const UNITY_LINE_TYPE line = Unity.CurrentTestLineNumber;
    const size_t length = strcspn(word, ":<>");
    while (count > 0 && (strlen(numbers->name) != length || strncmp(numbers->name, word, length))) {
        numbers++;
        count--;
    }
    if (count == 0) {
        return false;
    }
    UNITY_TEST_ASSERT(word[length] != '\0', line, word);
    const uint32_t wanted = (uint32_t)strtoul(&word[length + 1], NULL, 0);
    if (word[length] == '>') {
        UNITY_TEST_ASSERT_GREATER_THAN_UINT32(wanted, numbers->number, line, word);
    } else if (word[length] == '<') {
        UNITY_TEST_ASSERT_SMALLER_THAN_UINT32(wanted, numbers->number, line, word);
    } else {
        UNITY_TEST_ASSERT_EQUAL_UINT32(wanted, numbers->number, line, word);
    }
    return true;
}

bool rows_store(const char *word, const row_member_t *members, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (row_is(word, members[i].name)) {
            member_store(members[i].member, members[i].size, row_number(word));
            return true;
        }
    }
    return false;
}
