/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini record: what the lidar sends into a file, raw or with time stamps. */

#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "chunk.h"
#include "device.h"
#include "output.h"
#include "points.h"
#include "recording.h"

/* How often progress is shown. */
#define PROGRESS_MS 200u

/* More than comes through the line in the time that a start may take. */
#define HELD_MAX 400000u

/* Until the lidar has started, what it sends is held: a file that exists is not to be lost to a
 * lidar that does not answer. */
typedef struct {
    const char *path;
    FILE *file; /* NULL until then. */
    uint64_t begun_us;
    uint64_t stamp_us;     /* Of the chunk before. */
    recording_t recording; /* The same bytes, as they will be read. */
    size_t held_count;
    uint8_t held[HELD_MAX];
} tape_t;

static uint64_t now_us(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static void put(tape_t *tape, const uint8_t *bytes, size_t count)
{
    if (tape->file != NULL) {
        (void)fwrite(bytes, 1, count, tape->file);
    } else if (count <= HELD_MAX - tape->held_count) {
        memcpy(tape->held + tape->held_count, bytes, count);
        tape->held_count += count;
    }
}

/* The port's tap: its blocks are smaller than a chunk may be. A pause of more than the 71 minutes
 * that fit in 32 bits is shortened to them. */
static void write_tape(void *context, const uint8_t *bytes, size_t count)
{
    tape_t *const tape = context;
    const uint64_t now = now_us();
    const uint64_t since = now - tape->stamp_us;
    uint8_t head[CHUNK_HEAD_SIZE];
    chunk_write_head(head, since < UINT32_MAX ? (uint32_t)since : UINT32_MAX, bytes, count);
    put(tape, head, tape->recording.is_timed ? sizeof head : 0);
    put(tape, bytes, count);
    recording_feed(&tape->recording, bytes, count, now - tape->begun_us);
    tape->stamp_us = now;
}

/* What is there of the recording, and how good it is. */
static const char *tape_text(const tape_t *tape)
{
    static char text[160];
    (void)snprintf(text, sizeof text, "%.1f s, %llu bytes; scans: %s; %llu wrong checksums",
                   (double)(tape->stamp_us - tape->begun_us) / 1e6, tape->recording.bytes,
                   scans_text(&tape->recording.stream),
                   recording_checksum_errors(&tape->recording));
    return text;
}

/* Until the time is over or Ctrl-C is pressed, neither of which is a failure. */
static int roll(device_t *device, const options_t *options, tape_t *tape)
{
    put(tape, tape->held, tape->held_count);
    const uint32_t begun_ms = device_ms(device);
    uint32_t shown_ms = begun_ms;
    bool is_over = false;
    while (!is_over && device_is_usable(device) && ferror(tape->file) == 0) {
        (void)device_wait(device, PROGRESS_MS / 4);
        is_over = options->seconds > 0 && device_ms(device) - begun_ms >= options->seconds * 1000;
        if (device_ms(device) - shown_ms >= PROGRESS_MS) {
            shown_ms = device_ms(device);
            message_progress(false, "%s", tape_text(tape));
            (void)fflush(tape->file); /* For who reads along, and against a power failure. */
        }
    }
    return device_is_there(device) ? STATUS_OK : device_why(device);
}

/* From before the start command, on a quiet line, to the last byte after the stop command: so the
 * recording begins and ends with whole packets. */
static int record(device_t *device, const options_t *options)
{
    static tape_t tape;
    const char *const ending = strrchr(options->operand, '.');
    if (!device_stop(device)) {
        return device_why(device);
    }
    tape.path = options->operand;
    recording_begin_live(&tape.recording,
                         options->timed || (ending != NULL && strcmp(ending, ".tmini") == 0));
    tape.begun_us = tape.stamp_us = now_us();
    put(&tape, chunk_magic, tape.recording.is_timed ? sizeof chunk_magic : 0);
    tmini_posix_tap(&device->port, write_tape, &tape);
    int status = device_start(device);
    if (status == STATUS_OK) {
        tape.file = output_open(tape.path);
        status = tape.file != NULL ? roll(device, options, &tape) : STATUS_FAILED;
    }
    (void)device_stop(device);
    tmini_posix_tap(&device->port, NULL, NULL);
    if (tape.file == NULL) {
        return status;
    }
    recording_end_live(&tape.recording);
    message_note("%s: %s", tape.file == stdout ? "standard output" : tape.path, tape_text(&tape));
    return output_close(tape.file, tape.path, status);
}

static int run(const options_t *options)
{
    if (options->operand == NULL) {
        return message_usage("record into which file? Usage: tmini record %s",
                             command_record.usage);
    }
    if (strcmp(options->operand, "-") == 0 && isatty(STDOUT_FILENO) != 0) {
        return message_usage("raw bytes would spoil the terminal: let a program read them, for "
                             "example `| tmini decode -`");
    }
    return device_use(options, record);
}

const command_t command_record = {
    .name = "record",
    .usage = "[-p PORT] FILE|- [--seconds N] [--timed] [--wait] [--listen]",
    .summary = "what the lidar sends into a file, until Ctrl-C or for N seconds",
    .details =
        "FILE then holds all that the lidar sent from the start command on, for `tmini decode`,\n"
        "`plot` and `view`. A FILE.tmini, or any with --timed, also holds when it came; others\n"
        "hold the raw bytes alone.",
    .accepts = "psTWLq",
    .has_operand = true,
    .run = run,
};
