/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A table whose rows are tests: each has a name, which is a claim, and runs alone, with setUp() and
 * tearDown(). A row that fails is reported by its name and line, and the others run on.
 *
 *     TMINI_TEST_ROW=test_a_claim build/test/bin/test_x    only this one of the rows */

#ifndef ROWS_H
#define ROWS_H

#include "members.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* `steps` is what the table's runner understands; mostly words. A table is declared as
 *
 *     static const row_t rows[] IN_FLASH = {ROW(a_claim, "steps"), …}; */
#ifdef __AVR__ /* Rows would fill its RAM. Names are left out: the line identifies the row. */
#include <avr/pgmspace.h>
#define IN_FLASH PROGMEM
typedef struct {
    unsigned line;
    char steps[300];
} row_t;
#define ROW(claim, steps) \
    {                     \
        __LINE__, steps   \
    }
#else
#define IN_FLASH
typedef struct {
    unsigned line;
    const char *name;
    const char *steps;
} row_t;
#define ROW(claim, steps)               \
    {                                   \
        __LINE__, "test_" #claim, steps \
    }
#endif

/* Runs each row by `run`. It must be the last statement of a test function. */
#define run_rows(rows, run) rows_run(rows, sizeof(rows) / sizeof(rows)[0], run)
void rows_run(const row_t *rows, size_t count, void (*run)(const row_t *row));

/* Calls `tell` with each word of a text. Words are separated by spaces; those in "30( … )" come 30
 * times. `tell_rows` runs rows that are nothing but words; it, too, must be the last statement. */
#define ROW_WORD_MAX 80
void row_tell(const char *text, void (*tell)(char *word));
#define tell_rows(rows, tell) rows_tell(rows, sizeof(rows) / sizeof(rows)[0], tell)
void rows_tell(const row_t *rows, size_t count, void (*tell)(char *word));

/* Whether the word is "name" or "name:…"; the text after its first ":", "" if there is none; and
 * the number there, or 0. */
bool row_is(const char *word, const char *name);
const char *row_text(const char *word);
uint32_t row_number(const char *word);

/* An angle in sixty-fourths of a degree, of which "d" makes degrees: 180d+1. */
long row_angle(const char *text, char **rest);

/* Bytes in hexadecimal digits, such as "AA55"; returns how many there are. */
size_t row_bytes(const char *digits, uint8_t *bytes);

/* For words such as "count:21", which name a number and the value that is expected; or "count>20",
 * "count<22": it is more or less. If the word's name is none of these, returns false. */
typedef struct {
    const char *name;
    uint32_t number;
} row_number_t;
#define row_expects(word, numbers) rows_expect(word, numbers, sizeof(numbers) / sizeof(numbers)[0])
bool rows_expect(const char *word, const row_number_t *numbers, size_t count);

/* For words such as "attempts:3", which give a member this value: {"attempts",
 * MEMBER(config.attempts)}. If the word's name is none of these, returns false. */
typedef struct {
    const char *name;
    void *member;
    size_t size;
} row_member_t;
#define row_stores(word, members) rows_store(word, members, sizeof(members) / sizeof(members)[0])
bool rows_store(const char *word, const row_member_t *members, size_t count);

#endif
