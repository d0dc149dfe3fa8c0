/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A recording in a file, or that comes through a pipe: raw bytes as the lidar sent them, or the
 * same in chunks with time stamps. Read packet by packet. */

#ifndef RECORDING_H
#define RECORDING_H

#include "options.h"
#include "tape.h"

/* Members down to `tape` may be read. */
typedef struct {
    const char *name;
    bool is_at_end;
    bool is_impatient; /* May be set: recording_next() then does not wait for a pipe's bytes. */
    tape_t tape;

    const options_t *options;
    int fd;
    int error;        /* errno of a failed read, or 0. */
    count_t size;     /* Of the file; 0: not known. */
    count_t consumed; /* Of them. */
    unsigned shown_percent;
    size_t at, count; /* In `block`: what has been read and not yet fed. */
    uint8_t block[16384];
} recording_t;

/* Opens the recording that is the options' operand; "-" is standard input. Returns STATUS_OK, or
 * the status to leave with, and says why. */
int recording_open(recording_t *recording, const options_t *options);
void recording_close(recording_t *recording);

/* Finds the next valid packet: see `tape`. Returns false at the end (`is_at_end`), or if no more
 * bytes are there yet. */
bool recording_next(recording_t *recording);

/* Back to its beginning. Returns false if that cannot be: it comes through a pipe. */
bool recording_rewind(recording_t *recording);

/* At the end: says what is wrong if the file could not be read, was empty, damaged, or holds
 * nothing of a lidar. Returns the status to leave with. */
int recording_verdict(const recording_t *recording);

/* The path without its folders. */
const char *recording_base_name(const char *path);

#endif
