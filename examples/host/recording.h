/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A recording in a file or from a pipe: raw bytes as the lidar sent them, or the same in chunks
 * with time stamps. Read packet by packet. */

#ifndef RECORDING_H
#define RECORDING_H

#include "options.h"
#include "hexdump.h"
#include "tape.h"
#include "traits.h"

/* Members down to `tape` may be read. */
typedef struct {
    const char *name;
    bool is_at_end;
    bool is_impatient; /* May be set: recording_next() then does not wait for a pipe's bytes. */
    tape_t tape;

    const options_t *options;
    int fd;
    int error;        /* errno of a failed read, or 0. */
    count_t size;     /* The file's size; 0: unknown. */
    count_t consumed; /* Bytes read so far. */
    unsigned shown_percent;
    size_t at, count; /* In `block`: what has been read and not yet fed. */
    uint8_t block[16384];
    bool is_dump; /* The file is a hex dump. */
    hexdump_t dump;
    uint8_t text[16384];
    size_t kept; /* The lidar's first bytes, which show what it is if they hold no packet. */
    uint8_t first[TRAITS_MAX];
} recording_t;

/* Opens the recording that is the options' operand; "-" is standard input. Returns STATUS_OK; or
 * prints the reason and returns the exit status. */
int recording_open(recording_t *recording, const options_t *options);
void recording_close(recording_t *recording);

/* Finds the next valid packet: see `tape`. Returns false at the end (`is_at_end`), or if more bytes
 * must come first. */
bool recording_next(recording_t *recording);

/* Goes back to the beginning. Returns false if that is impossible, because it comes through a
 * pipe. */
bool recording_rewind(recording_t *recording);

/* Call it at the end: prints an error if the file could not be read, is empty or damaged, or
 * contains no lidar packets. Returns the exit status. */
int recording_verdict(const recording_t *recording);

/* The path without its folders. */
const char *recording_base_name(const char *path);

#endif
