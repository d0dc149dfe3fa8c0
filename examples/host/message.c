/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "message.h"

#include <stdarg.h>
#include <stdio.h>

static bool is_silent;

int message_print(int status, const char *format, ...)
{
    if (status == STATUS_OK && is_silent) {
        return status;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)fflush(stdout); /* So that the two streams stay in order on a terminal. */
    (void)fputs(status == STATUS_OK ? "" : "tmini: ", stderr);
    (void)vfprintf(stderr, format, arguments);
    (void)fputc('\n', stderr);
    va_end(arguments);
    return status;
}

void message_silence(bool silent)
{
    is_silent = silent;
}
