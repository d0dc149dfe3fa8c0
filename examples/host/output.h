/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Messages on standard error, the exit status, and output files. */

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

/* Prints a line. For STATUS_OK it is a remark, which message_silence() suppresses; for any other
 * status it is "tmini: " and the reason. Returns the status, so that a command can end with it. */
int message_print(int status, const char *format, ...) MESSAGE_FORMAT;

#define message_note(...) (void)message_print(STATUS_OK, __VA_ARGS__)
#define message_fail(...) message_print(STATUS_FAILED, __VA_ARGS__)
#define message_usage(...) message_print(STATUS_USAGE, __VA_ARGS__)

/* Shows progress on a terminal, unless silenced. Each text overwrites the one before; the last one
 * remains. */
void message_progress(bool is_last, const char *format, ...) MESSAGE_FORMAT;

void message_silence(bool silent);

/* Opens a file to write; "-" is standard output. If it cannot be opened, prints the reason and
 * returns NULL. */
FILE *output_open(const char *path);

/* Whether that file may be written: it does not exist, or is no ordinary file, or `force` is given,
 * and its folder exists. If not, prints the reason. */
bool output_may_open(const char *path, bool force);

/* Closes the file. Returns `status`; if not all could be written, prints this and returns
 * STATUS_FAILED. (For standard output main() does this.) */
int output_close(FILE *file, const char *path, int status);

#endif
