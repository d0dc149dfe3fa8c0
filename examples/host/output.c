/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L

#include "output.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_silent;
static bool is_under_way; /* The cursor is on a line that shows progress. */

int message_print(int status, const char *format, ...)
{
    if (status == STATUS_OK && is_silent) {
        return status;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)fflush(stdout); /* So that the two streams stay in order on a terminal. */
    (void)fprintf(stderr, "%s%s", is_under_way ? "\n" : "", status == STATUS_OK ? "" : "tmini: ");
    (void)vfprintf(stderr, format, arguments);
    (void)fputc('\n', stderr);
    va_end(arguments);
    is_under_way = false;
    return status;
}

void message_progress(bool is_last, const char *format, ...)
{
    if (is_silent || isatty(STDERR_FILENO) == 0) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    (void)fputc(is_last ? '\n' : '\r', stderr);
    va_end(arguments);
    is_under_way = !is_last;
}

void message_silence(bool silent)
{
    is_silent = silent;
}

FILE *output_open(const char *path)
{
    FILE *const file = strcmp(path, "-") == 0 ? stdout : fopen(path, "wb");
    if (file == NULL) {
        (void)message_fail("cannot write %s: %s", path, strerror(errno));
    }
    return file;
}

bool output_may_open(const char *path, bool force)
{
    struct stat status;
    const bool exists = stat(path, &status) == 0;
    if (strcmp(path, "-") == 0 || (exists && (force || !S_ISREG(status.st_mode)))) {
        return true;
    }
    if (exists) {
        (void)message_fail("%s exists; --force overwrites it", path);
        return false;
    }
    FILE *const file = fopen(path, "wb");
    if (file == NULL) {
        (void)message_fail("cannot write %s: %s", path, strerror(errno));
        return false;
    }
    (void)fclose(file);
    return remove(path) == 0;
}

int output_close(FILE *file, const char *path, int status)
{
    if (file == stdout) {
        return status;
    }
    const bool is_whole = ferror(file) == 0;
    if (fclose(file) != 0) {
        return message_fail("cannot write %s: %s", path, strerror(errno));
    }
    return is_whole ? status : message_fail("cannot write %s: is the disk full?", path);
}
