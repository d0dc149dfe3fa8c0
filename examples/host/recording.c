/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#define _POSIX_C_SOURCE 200809L

#include "recording.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "causes.h"
#include "mount.h"
#include "output.h"

/* Shorter recordings are read at once. */
#define LONG_SIZE 20000000u

static void show_progress(recording_t *recording)
{
    const unsigned percent =
        recording->size < LONG_SIZE ? 0 : (unsigned)(recording->consumed * 100 / recording->size);
    if (percent != recording->shown_percent && !recording->is_impatient) {
        recording->shown_percent = percent;
        message_progress(percent >= 100, "%3u %% of %s", percent, recording->name);
    }
}

/* Reads the bytes that are there, without waiting for a full buffer: they may come live through a
 * pipe. */
static size_t read_some(recording_t *recording, uint8_t *bytes)
{
    ssize_t count = 0;
    do {
        count = read(recording->fd, bytes, sizeof recording->block);
    } while (count < 0 && errno == EINTR);
    recording->error = count < 0 ? errno : 0;
    recording->consumed += count > 0 ? (count_t)count : 0;
    show_progress(recording);
    return count > 0 ? (size_t)count : 0;
}

/* Some blocks of a hex dump end no line, and so give no bytes. */
static size_t read_dump(recording_t *recording)
{
    size_t count = 0;
    size_t made = 0;
    do {
        count = read_some(recording, recording->text);
        made = hexdump_take(&recording->dump, recording->text, count, recording->block);
    } while (made == 0 && count > 0);
    return made;
}

static void read_block(recording_t *recording)
{
    const bool is_first = recording->consumed == 0;
    recording->at = 0;
    recording->count =
        recording->is_dump ? read_dump(recording) : read_some(recording, recording->block);
    if (is_first && hexdump_is(recording->block, recording->count)) {
        message_note("%s is a hex dump", recording->name);
        recording->is_dump = true;
        memcpy(recording->text, recording->block, recording->count);
        recording->count =
            hexdump_take(&recording->dump, recording->text, recording->count, recording->block);
        recording->count = recording->count > 0 ? recording->count : read_dump(recording);
    }
}

/* The tape's tap. */
static void keep_first(void *context, const uint8_t *bytes, size_t count)
{
    recording_t *const recording = context;
    const size_t room = sizeof recording->first - recording->kept;
    const size_t kept = count < room ? count : room;
    memcpy(recording->first + recording->kept, bytes, kept);
    recording->kept += kept;
}

/* Gives the tape more bytes, or none at the end. Returns false if there are none yet. */
static bool feed(recording_t *recording)
{
    struct pollfd entry = {.fd = recording->fd, .events = POLLIN};
    if (recording->at == recording->count) {
        if (recording->is_impatient && poll(&entry, 1, 0) == 0) {
            return false;
        }
        read_block(recording);
    }
    recording->at += tape_feed(&recording->tape, recording->block + recording->at,
                               recording->count - recording->at);
    return true;
}

static void begin(recording_t *recording)
{
    const options_t *const options = recording->options;
    recording->at = recording->count = 0;
    recording->consumed = 0;
    recording->is_at_end = false;
    recording->is_dump = false;
    recording->dump = (hexdump_t){.count = 0};
    recording->kept = 0;
    tape_begin(&recording->tape, mount_of(options), (uint8_t)options->max_samples);
    recording->tape.tap = keep_first;
    recording->tape.tap_context = recording;
    while (!recording->tape.is_begun && feed(recording)) {
    }
}

bool recording_next(recording_t *recording)
{
    tape_next_t next = tape_next(&recording->tape);
    while (next == TAPE_NEEDS_BYTES && feed(recording)) {
        next = tape_next(&recording->tape);
    }
    recording->is_at_end = next == TAPE_END;
    return next == TAPE_PACKET || next == TAPE_SCAN;
}

int recording_open(recording_t *recording, const options_t *options)
{
    const bool is_standard = strcmp(options->operand, "-") == 0;
    struct stat status;
    memset(recording, 0, sizeof *recording);
    recording->options = options;
    recording->name = is_standard ? "standard input" : options->operand;
    recording->fd = is_standard ? STDIN_FILENO : open(options->operand, O_RDONLY);
    if (recording->fd < 0) {
        return message_fail("cannot open %s: %s", options->operand, strerror(errno));
    }
    if (fstat(recording->fd, &status) == 0 && S_ISREG(status.st_mode)) {
        recording->size = (count_t)status.st_size;
    }
    begin(recording);
    if (recording->tape.chunks.version > CHUNK_VERSION) {
        recording_close(recording);
        return message_fail("%s is of version %u: this tmini is too old for it", recording->name,
                            recording->tape.chunks.version);
    }
    return STATUS_OK;
}

void recording_close(recording_t *recording)
{
    if (recording->fd != STDIN_FILENO) {
        (void)close(recording->fd);
    }
}

bool recording_rewind(recording_t *recording)
{
    if (lseek(recording->fd, 0, SEEK_SET) != 0) {
        return false;
    }
    begin(recording);
    return true;
}

/* What the bytes show if they hold no packet, or damaged ones. */
static int explain(const recording_t *recording)
{
    static traits_t traits;
    char text[CAUSE_TEXT_SIZE];
    const count_t packets = recording->tape.stream.packets;
    const facts_t facts = {.is_file = true,
                           .received = recording->tape.bytes,
                           .packets = packets,
                           .is_damaged = recording->tape.stream.damaged > 0,
                           .users = "",
                           .traits = &traits};
    traits_find(&traits, recording->first, recording->kept);
    const cause_t *const cause = cause_find(&facts);
    if (packets == 0 && cause != NULL) {
        return message_fail("%s (%llu bytes): %s", recording->name, recording->tape.bytes,
                            cause_text(cause, &facts, text));
    }
    if (cause != NULL && cause->is_sign) {
        message_note("%s: %s", recording->name, cause_text(cause, &facts, text));
    }
    return STATUS_OK;
}

int recording_verdict(const recording_t *recording)
{
    const tape_t *const tape = &recording->tape;
    const unsigned damages = tape->chunks.damages;
    if (recording->error != 0) {
        return message_fail("cannot read %s: %s", recording->name, strerror(recording->error));
    }
    if (tape->bytes == 0) {
        return message_fail("%s is empty: nothing was recorded. Was the lidar scanning?",
                            recording->name);
    }
    if (tape->stream.packets == 0 || tape->stream.damaged > 0) {
        const int status = explain(recording);
        if (status != STATUS_OK) {
            return status;
        }
    }
    if (damages > 0) {
        message_note("%s is damaged in %u place%s: bytes are missing or wrong there",
                     recording->name, damages, damages == 1 ? "" : "s");
    }
    return STATUS_OK;
}

const char *recording_base_name(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL && slash[1] != '\0' ? slash + 1 : path;
}
