/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini record: writes what the lidar sends to a file, raw or with time stamps. */

#define _POSIX_C_SOURCE 200809L

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "device.h"
#include "output.h"
#include "points.h"
#include "tape.h"

#define PROGRESS_MS 200u

/* More bytes than can come while the lidar starts. */
#define HELD_MAX 400000u

/* Holds received bytes until the lidar has started, so that a lidar that does not answer does not
 * overwrite an existing file. */
typedef struct {
    const char *path;
    FILE *file; /* NULL until the lidar has started. */
    bool is_timed;
    const tmini_posix_t *port;
    uint64_t begun_us;
    uint64_t stamp_us; /* The time of the chunk before. */
    tape_t tape;       /* Decodes the same bytes as a reader will. */
    size_t held_count;
    uint8_t held[HELD_MAX];
} recorder_t;

static void put(recorder_t *recorder, const uint8_t *bytes, size_t count)
{
    if (recorder->file != NULL) {
        (void)fwrite(bytes, 1, count, recorder->file);
    } else if (count <= HELD_MAX - recorder->held_count) {
        memcpy(recorder->held + recorder->held_count, bytes, count);
        recorder->held_count += count;
    }
    while (count > 0) {
        const size_t taken = tape_feed(&recorder->tape, bytes, count);
        bytes += taken;
        count -= taken;
        while (tape_next(&recorder->tape) != TAPE_NEEDS_BYTES) {
        }
    }
}

/* The port's tap. Its blocks always fit in a chunk. A longer pause counts as 71 minutes, which fit
 * in 32 bits. */
static void write_block(void *context, const uint8_t *bytes, size_t count)
{
    recorder_t *const recorder = context;
    const uint64_t now = (uint64_t)tmini_posix_now_us(recorder->port);
    const uint64_t since = now - recorder->stamp_us;
    uint8_t head[CHUNK_HEAD_SIZE];
    tmini_timed_write_head(head, since < UINT32_MAX ? (uint32_t)since : UINT32_MAX, bytes, count);
    put(recorder, head, recorder->is_timed ? sizeof head : 0);
    put(recorder, bytes, count);
    recorder->stamp_us = now;
}

static const char *recorder_text(const recorder_t *recorder)
{
    const tape_t *const tape = &recorder->tape;
    static char text[160];
    (void)snprintf(text, sizeof text, "%.1f s, %llu bytes; scans: %s; %llu wrong checksums",
                   (double)(recorder->stamp_us - recorder->begun_us) / 1e6, tape->bytes,
                   scans_text(&tape->stream), tape_checksum_errors(tape));
    return text;
}

/* Runs until the time is over or Ctrl-C is pressed; both are success. */
static int roll(device_t *device, const options_t *options, recorder_t *recorder)
{
    (void)fwrite(recorder->held, 1, recorder->held_count, recorder->file);
    const uint32_t begun_ms = device_ms(device);
    uint32_t shown_ms = begun_ms;
    bool is_over = false;
    while (!is_over && device_is_usable(device) && ferror(recorder->file) == 0) {
        (void)device_wait(device, PROGRESS_MS / 4);
        is_over = options->seconds > 0 && device_ms(device) - begun_ms >= options->seconds * 1000;
        if (device_ms(device) - shown_ms >= PROGRESS_MS) {
            shown_ms = device_ms(device);
            message_progress(false, "%s", recorder_text(recorder));
            (void)fflush(recorder->file); /* For programs that read the file meanwhile, and in case
                                           * of a power failure. */
        }
    }
    return device_is_there(device) ? STATUS_OK : device_why(device);
}

/* Records from before the start command to the last byte after the stop command, so that the
 * recording begins and ends with whole packets. */
static int record(device_t *device, const options_t *options)
{
    static recorder_t recorder;
    const char *const ending = strrchr(options->operand, '.');
    if (!device_stop(device)) {
        return device_why(device);
    }
    recorder.path = options->operand;
    recorder.is_timed = options->timed || (ending != NULL && strcmp(ending, ".tmini") == 0);
    recorder.port = &device->port;
    recorder.begun_us = recorder.stamp_us = (uint64_t)tmini_posix_now_us(recorder.port);
    tape_begin(&recorder.tape, NULL, 0);
    put(&recorder, tmini_timed_magic, recorder.is_timed ? sizeof tmini_timed_magic : 0);
    tmini_posix_tap(&device->port, write_block, &recorder);
    int status = device_start(device);
    if (status == STATUS_OK) {
        recorder.file = output_open(recorder.path);
        status = recorder.file != NULL ? roll(device, options, &recorder) : STATUS_FAILED;
    }
    (void)device_stop(device);
    tmini_posix_tap(&device->port, NULL, NULL);
    if (recorder.file == NULL) {
        return status;
    }
    (void)tape_feed(&recorder.tape, recorder.held, 0);
    while (tape_next(&recorder.tape) != TAPE_END) {
    }
    message_note("%s: %s", recorder.file == stdout ? "standard output" : recorder.path,
                 recorder_text(&recorder));
    return output_close(recorder.file, recorder.path, status);
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
    .summary = "all that the lidar sends, until Ctrl-C or for N seconds",
    .details = "FILE then holds all that the lidar sent from the start command on, for `tmini\n"
               "decode`, `plot` and `view`. A FILE.tmini, or any FILE with --timed, also\n"
               "holds the times; others hold only the raw bytes.",
    .accepts = "psTWLq",
    .has_operand = true,
    .run = run,
};
