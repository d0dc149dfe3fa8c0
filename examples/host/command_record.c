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

/* More bytes than any reply: something streams. */
#define STREAM_BYTES 1000u

typedef struct {
    const char *path;
    FILE *file; /* NULL until the first byte has come. */
    bool has_failed;
    bool is_timed;
    const tmini_posix_t *port;
    uint64_t begun_us;
    uint64_t stamp_us; /* The time of the chunk before. */
    tape_t tape;       /* Decodes the same bytes as a reader will. */
} recorder_t;

static void put(recorder_t *recorder, const uint8_t *bytes, size_t count)
{
    if (recorder->file != NULL) {
        (void)fwrite(bytes, 1, count, recorder->file);
    }
    while (count > 0) {
        const size_t taken = tape_feed(&recorder->tape, bytes, count);
        bytes += taken;
        count -= taken;
        while (tape_next(&recorder->tape) != TAPE_NEEDS_BYTES) {
        }
    }
}

/* With the first byte, so that a lidar that sends nothing overwrites no file. */
static void open_file(recorder_t *recorder)
{
    recorder->file = output_open(recorder->path);
    recorder->has_failed = recorder->file == NULL;
    put(recorder, tmini_timed_magic, recorder->is_timed ? sizeof tmini_timed_magic : 0);
}

/* The port's tap. Its blocks always fit in a chunk. A longer pause counts as 71 minutes, which fit
 * in 32 bits. */
static void write_block(void *context, const uint8_t *bytes, size_t count)
{
    recorder_t *const recorder = context;
    const uint64_t now = (uint64_t)tmini_posix_now_us(recorder->port);
    const uint64_t since = now - recorder->stamp_us;
    uint8_t head[CHUNK_HEAD_SIZE];
    if (recorder->file == NULL && !recorder->has_failed) {
        open_file(recorder);
    }
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

static bool can_write(const recorder_t *recorder)
{
    return !recorder->has_failed && (recorder->file == NULL || ferror(recorder->file) == 0);
}

/* Runs until the time is over or Ctrl-C is pressed; both are success. */
static int roll(device_t *device, const options_t *options, recorder_t *recorder)
{
    const uint32_t begun_ms = device_ms(device);
    uint32_t shown_ms = begun_ms;
    bool is_over = false;
    while (!is_over && device_is_usable(device) && can_write(recorder)) {
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

/* The lidar sends something, but no packet is found in it: records it all the same. */
static int roll_raw(device_t *device, const options_t *options, recorder_t *recorder)
{
    char text[CAUSE_TEXT_SIZE];
    facts_t facts;
    device_facts(device, &facts);
    const cause_t *const cause = cause_find(&facts);
    message_note("nothing of it can be decoded: %s.\nRecording all bytes …",
                 cause != NULL && cause->text != NULL ? cause_text(cause, &facts, text)
                                                      : "no packet is valid");
    device_start_raw(device);
    return roll(device, options, recorder);
}

/* Between opening the port and the start: a lidar that streams already is stopped, so that the
 * recording holds whole packets. */
static int start_and_roll(device_t *device, const options_t *options, recorder_t *recorder)
{
    const bool is_stopped = device_stop(device);
    const uint64_t before = device->witness.received;
    if (device_try_start(device)) {
        return can_write(recorder) ? roll(device, options, recorder) : STATUS_FAILED;
    }
    const uint64_t came = is_stopped ? device->witness.received - before : before;
    if (device_is_usable(device) && came > STREAM_BYTES && can_write(recorder)) {
        return roll_raw(device, options, recorder);
    }
    return device_why(device);
}

/* Records from the opening of the port to the last byte after the stop command. */
static int record(device_t *device, const options_t *options)
{
    static recorder_t recorder;
    const char *const ending = strrchr(options->operand, '.');
    recorder.path = options->operand;
    recorder.is_timed = options->timed || (ending != NULL && strcmp(ending, ".tmini") == 0);
    recorder.port = &device->port;
    recorder.begun_us = recorder.stamp_us = (uint64_t)tmini_posix_now_us(recorder.port);
    tape_begin(&recorder.tape, NULL, 0);
    device_tap(device, write_block, &recorder);
    const int status = start_and_roll(device, options, &recorder);
    (void)device_stop(device);
    device_tap(device, NULL, NULL);
    if (recorder.file == NULL) {
        return status;
    }
    (void)tape_feed(&recorder.tape, recorder.tape.buffer, 0);
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
    return output_may_open(options->operand, options->force) ? device_use(options, record)
                                                             : STATUS_FAILED;
}

const command_t command_record = {
    .name = "record",
    .usage = "[-p PORT] FILE|- [--seconds N] [--timed] [--force] [--wait]\n"
             "             [--listen]",
    .summary = "all that the lidar sends, until Ctrl-C or for N seconds",
    .details = "FILE then holds all that came from the opening of the port on, also what is no\n"
               "packet, for `tmini decode`, `plot` and `view`. A FILE.tmini, or any FILE with\n"
               "--timed, also holds the times; others hold only the raw bytes. An existing FILE\n"
               "is overwritten only with --force.",
    .accepts = "psTXWLq",
    .has_operand = true,
    .run = run,
};
