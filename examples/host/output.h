/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the tool says on standard error, with which status it leaves, and the files it writes. */

#ifndef OUTPUT_H
#define OUTPUT_H

#include <stdbool.h>
#include <stdio.h>

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

/* Prints a line: a remark, unless silenced; or, after "tmini: ", the reason for this exit status.
 * Returns the status, so that a command can end with it. */
int message_print(int status, const char *format, ...) MESSAGE_FORMAT;

#define message_note(...) (void)message_print(STATUS_OK, __VA_ARGS__)
#define message_fail(...) message_print(STATUS_FAILED, __VA_ARGS__)
#define message_usage(...) message_print(STATUS_USAGE, __VA_ARGS__)

/* Shows progress on a terminal, unless silenced; it overwrites the progress shown before, and the
 * last one remains. */
void message_progress(bool is_last, const char *format, ...) MESSAGE_FORMAT;

/* After message_silence(true) there are no remarks and no progress. */
void message_silence(bool silent);

/* Opens a file to write; "-" is standard output. Returns NULL, and says why, if that cannot be. */
FILE *output_open(const char *path);

/* Closes it. Returns `status`; or STATUS_FAILED, and says so, if not all could be written. (Of
 * standard output main() says it.) */
int output_close(FILE *file, const char *path, int status);

#endif
