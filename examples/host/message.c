/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "message.h"

#include <stdarg.h>
#include <stdio.h>

static bool silenced;

static void print(const char *prefix, const char *format, va_list arguments)
{
    (void)fflush(stdout); /* So that the two streams stay in order on a terminal. */
    (void)fputs(prefix, stderr);
    (void)vfprintf(stderr, format, arguments);
    (void)fputc('\n', stderr);
}

int message_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print("tmini: ", format, arguments);
    va_end(arguments);
    return STATUS_FAILED;
}

int message_usage(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print("tmini: ", format, arguments);
    va_end(arguments);
    return STATUS_USAGE;
}

void message_note(const char *format, ...)
{
    if (silenced) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    print("", format, arguments);
    va_end(arguments);
}

void message_silence(bool silent)
{
    silenced = silent;
}
