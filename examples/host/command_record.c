/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini record: the lidar's raw bytes into a file. */

#include "commands.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "device.h"
#include "message.h"

/* How often progress is shown. */
#define PROGRESS_MS 200u

/* More than comes through the line in the time that a start may take. */
#define HELD_MAX 400000u

/* Until the lidar has started, what it says is held: a file that exists is not to be lost to a lidar
 * that does not answer. */
typedef struct {
    FILE *file; /* NULL until then. */
    uint64_t bytes;
    size_t held_count;
    uint8_t held[HELD_MAX];
} tape_t;

static void write_tape(void *context, const uint8_t *bytes, size_t count)
{
    tape_t *const tape = context;
    if (tape->file != NULL) {
        tape->bytes += fwrite(bytes, 1, count, tape->file);
    } else if (count <= HELD_MAX - tape->held_count) {
        memcpy(tape->held + tape->held_count, bytes, count);
        tape->held_count += count;
    }
}

static int open_tape(tape_t *tape, const char *path)
{
    FILE *const file = fopen(path, "wb");
    if (file == NULL) {
        return message_fail("cannot write %s: %s", path, strerror(errno));
    }
    tape->bytes = fwrite(tape->held, 1, tape->held_count, file);
    tape->file = file;
    return STATUS_OK;
}

/* Returns `status`, unless the file is not whole. */
static int close_tape(tape_t *tape, const char *path, int status)
{
    if (tape->file == NULL) {
        return status;
    }
    errno = 0;
    const bool failed = ferror(tape->file) != 0;
    if (fclose(tape->file) != 0 || failed) {
        return message_fail("cannot write %s: %s", path,
                            errno != 0 ? strerror(errno) : "the disk may be full");
    }
    if (status == STATUS_OK) {
        message_note("%" PRIu64 " bytes in %s", tape->bytes, path);
    }
    return status;
}

static void show_progress(const device_t *device, const tape_t *tape, uint32_t elapsed_ms,
                          const char *end)
{
    tmini_counters_t counters;
    tmini_counters(&device->lidar, &counters);
    (void)fprintf(stderr,
                  "%4" PRIu32 ".%" PRIu32 " s  %8" PRIu64 " bytes  %5" PRIu32 " scans  %" PRIu32
                  " wrong checksums  %" PRIu32 " bytes overrun%s",
                  elapsed_ms / 1000, elapsed_ms / 100 % 10, tape->bytes, counters.scans,
                  counters.parser.checksum_errors, counters.parser.bytes_overrun, end);
}

static uint32_t now_ms(void)
{
    return tmini_posix_port.now_ms(NULL);
}

/* Until the time is over or Ctrl-C is pressed. The first is no reason to end with an error, nor is the
 * second. */
static int roll(device_t *device, const options_t *options, const tape_t *tape)
{
    const uint32_t begun_ms = now_ms();
    uint32_t shown_ms = begun_ms - PROGRESS_MS;
    while (device_is_usable(device) && ferror(tape->file) == 0) {
        (void)device_wait(device, PROGRESS_MS / 4);
        const uint32_t elapsed_ms = now_ms() - begun_ms;
        const bool is_over = options->seconds > 0 && elapsed_ms / 1000 >= options->seconds;
        if (!options->quiet && (is_over || now_ms() - shown_ms >= PROGRESS_MS)) {
            shown_ms = now_ms();
            show_progress(device, tape, elapsed_ms, is_over ? "\n" : "\r");
        }
        if (is_over) {
            return STATUS_OK;
        }
    }
    if (!options->quiet) {
        (void)fputc('\n', stderr); /* The progress stays. */
    }
    return device->serial.state == TMINI_POSIX_OK ? STATUS_OK : device_why(device);
}

/* From before the start command, on a quiet line, to the last byte after the stop command: so the
 * recording begins and ends with whole packets. */
static int record(device_t *device, const options_t *options, tape_t *tape)
{
    int status = device_finish(device, tmini_stop(&device->lidar), TMINI_EVENT_STOPPED);
    if (status != STATUS_OK) {
        return status;
    }
    tmini_posix_tap(&device->serial, write_tape, tape);
    status = device_start(device);
    if (status == STATUS_OK) {
        status = open_tape(tape, options->operand);
    }
    if (status == STATUS_OK) {
        status = roll(device, options, tape);
    }
    if (device->serial.state == TMINI_POSIX_OK) {
        (void)device_stop(device);
    }
    tmini_posix_tap(&device->serial, NULL, NULL);
    return status;
}

static int run(const options_t *options)
{
    static tape_t tape;
    if (options->operand == NULL) {
        return message_usage("record into which file? Usage: tmini record %s",
                             command_record.usage);
    }
    device_t *device = NULL;
    const int opened = device_open(&device, options);
    if (opened != STATUS_OK) {
        return opened;
    }
    const int status = close_tape(&tape, options->operand, record(device, options, &tape));
    device_close(device);
    return status;
}

const command_t command_record = {
    .name = "record",
    .usage = "-p PORT FILE [--seconds N]",
    .summary = "the lidar's raw bytes into a file, until Ctrl-C or for N seconds",
    .details = "\n"
               "FILE then holds all that the lidar sent from the start command on, for `tmini "
               "decode`,\n`plot` and `view`.",
    .accepts = "psq",
    .operand = "FILE",
    .run = run,
};
