/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "console.h"

#include <stdio.h>
#include <string.h>

#include "unity.h"

#define US_PER_BYTE 87u       /* 10 bits at 115200 baud. */
#define LIDAR_US_PER_BYTE 43u /* 23,000 bytes per second. */

/* An example waits at least this long between two turns of its loop, and never within a turn. */
#define SAME_TURN_US 1000u

static struct {
    uint64_t first_us;
    uint64_t last_us;
    uint64_t bytes;
    uint32_t turn; /* Bytes printed in the current turn of the loop. */
    uint32_t most; /* Most bytes printed in one turn. */
    char text[8192];
    size_t length;
} console;

void console_begin(void)
{
    memset(&console, 0, sizeof console);
}

void console_note(uint64_t now_us, size_t bytes)
{
    if (console.bytes == 0) {
        console.first_us = now_us;
    }
    if (now_us - console.last_us >= SAME_TURN_US) {
        console.turn = 0;
    }
    console.last_us = now_us;
    console.bytes += bytes;
    console.turn += (uint32_t)bytes;
    console.most = console.turn > console.most ? console.turn : console.most;
}

void console_write(uint64_t now_us, const char *text)
{
    const size_t length = strlen(text);
    TEST_ASSERT_TRUE_MESSAGE(console.length + length < sizeof console.text,
                             "too much for the model");
    memcpy(&console.text[console.length], text, length + 1);
    console.length += length;
    console_note(now_us, length);
}

int console_print(uint64_t now_us, const char *format, va_list arguments)
{
    char text[300];
    const int length = vsnprintf(text, sizeof text, format, arguments);
    console_write(now_us, text);
    return length;
}

const char *console_text(void)
{
    return console.text;
}

void assert_said(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(console.text, text), console.text);
}

void assert_last_said(const char *text)
{
    const char *line = strrchr(console.text, ',');
    while (line > console.text && line[-1] != '\n') {
        line--;
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line, text), console.text);
}

void assert_console_leaves_time(uint32_t held)
{
    char said[100];
    const uint64_t time_us = console.last_us - console.first_us;
    (void)snprintf(said, sizeof said, "%u bytes at once, %u in %u ms", (unsigned)console.most,
                   (unsigned)console.bytes, (unsigned)(time_us / 1000u));
    TEST_MESSAGE(said);
    TEST_ASSERT_GREATER_THAN_MESSAGE(0, console.most, said);
    TEST_ASSERT_LESS_OR_EQUAL_MESSAGE(held * LIDAR_US_PER_BYTE, console.most * US_PER_BYTE, said);
    TEST_ASSERT_LESS_OR_EQUAL_MESSAGE(time_us / 2, console.bytes * US_PER_BYTE, said);
}
