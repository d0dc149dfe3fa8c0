/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Recordings: raw bytes as the lidar sent them, or the same in chunks with time stamps. Read packet
 * by packet, with the library's ring, parser and packet modules and without any port; in constant
 * memory, however long. No reply is awaited, so replies in a recording count as skipped bytes. */

#ifndef RECORDING_H
#define RECORDING_H

#include "chunk.h"
#include "options.h"
#include "stream.h"
#include "tmini/parts/tmini_parser.h"

/* Members down to `stream` may be read. */
typedef struct {
    const char *name;
    count_t bytes; /* Of the lidar's. */
    count_t bytes_in_packets;
    count_t bytes_before; /* The first packet, and up to the latest one: skipped ones. */
    count_t bytes_until;
    uint64_t time_us; /* Of the latest packet. */
    bool is_timed;    /* Otherwise the time is that of 4000 samples per second. */
    bool is_at_end;
    bool is_impatient;     /* May be set: recording_next() then does not wait for a pipe's bytes. */
    uint64_t until_us;     /* May be set: what came later in a timed one is not there yet. */
    tmini_packet_t packet; /* The latest. */
    stream_t stream;

    int fd;          /* -1: a live one. */
    chunks_t chunks; /* Of a timed one. */
    bool is_waiting;
    bool is_live;
    int error;    /* errno of a failed read, or 0. */
    count_t size; /* Of the file; 0: not known. */
    count_t consumed;
    uint8_t max_samples;
    const tmini_mount_t *mount;
    unsigned shown_percent;
    size_t at, count; /* In `buffer`: what has been read and not yet decoded. */
    uint8_t buffer[32768];
    tmini_ring_t ring;
    tmini_parser_t parser;
    uint8_t memory[4096];
} recording_t;

/* Opens the recording that is the options' operand; "-" is standard input. Returns STATUS_OK, or
 * the status to leave with, and says why. */
int recording_open(recording_t *recording, const options_t *options);
void recording_close(recording_t *recording);

/* One that is being made: its bytes are fed as they come, and its packets counted as they will be
 * when it is read. */
void recording_begin_live(recording_t *recording, bool is_timed);
void recording_feed(recording_t *recording, const uint8_t *bytes, size_t count, uint64_t time_us);
void recording_end_live(recording_t *recording);

/* Finds the next valid packet and gives it to the stream. At the end of the file, what waits for
 * more bytes is re-examined byte by byte. Returns false when nothing is left (`is_at_end`), or
 * there yet. */
bool recording_next(recording_t *recording);

/* Back to its beginning. Returns false if that cannot be: it comes through a pipe. */
bool recording_rewind(recording_t *recording);

/* Bytes that belonged to no packet, of those decoded so far. */
count_t recording_skipped(const recording_t *recording);

/* Wrong checksums so far. */
count_t recording_checksum_errors(const recording_t *recording);

/* At the end: says what is wrong if the file could not be read, was empty, damaged, or holds
 * nothing of a lidar. Returns the status to leave with. */
int recording_verdict(const recording_t *recording);

/* The path without its folders. */
const char *recording_base_name(const char *path);

#endif
