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
#define MESSAGE_FORMAT __attribute__((format(printf, 1, 2)))
#else
#define MESSAGE_FORMAT
#endif

/* Prints "tmini: …" and returns STATUS_FAILED, so that a command can end with it. */
int message_fail(const char *format, ...) MESSAGE_FORMAT;

/* The same with STATUS_USAGE. */
int message_usage(const char *format, ...) MESSAGE_FORMAT;

/* Prints a line of information, unless silenced. */
void message_note(const char *format, ...) MESSAGE_FORMAT;

/* After message_silence(true) there are errors only. */
void message_silence(bool silent);

#endif
