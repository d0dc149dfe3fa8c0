/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the tool says on standard error, and with which status it leaves. */

#ifndef MESSAGE_H
#define MESSAGE_H

#include <stdbool.h>

enum {
    STATUS_OK = 0,
    STATUS_FAILED = 1, /* Something went wrong while running. */
    STATUS_USAGE = 2,  /* The command line was wrong. */
};

#if defined(__GNUC__)
#define MESSAGE_FORMAT __attribute__((format(printf, 2, 3)))
#else
#define MESSAGE_FORMAT
#endif

/* Prints a line: a remark, unless silenced; or behind "tmini: " why the program leaves with this
 * status. Returns the status, so that a command can end with it. */
int message_print(int status, const char *format, ...) MESSAGE_FORMAT;

#define message_note(...) (void)message_print(STATUS_OK, __VA_ARGS__)
#define message_fail(...) message_print(STATUS_FAILED, __VA_ARGS__)
#define message_usage(...) message_print(STATUS_USAGE, __VA_ARGS__)

/* After message_silence(true) there are no remarks. */
void message_silence(bool silent);

#endif
