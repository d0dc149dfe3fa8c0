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

#include "mount.h"
#include "output.h"

/* With the largest packet waiting for its last byte (775), this much still fits in the ring. */
#define BLOCK_SIZE 2048u

/* Shorter recordings are read at once. */
#define LONG_SIZE 20000000u

#define US_A_SAMPLE 250u /* Section 1. */

/* To someone who waits for a long one. */
static void show_progress(recording_t *recording)
{
    const unsigned percent =
        recording->size < LONG_SIZE ? 0 : (unsigned)(recording->consumed * 100 / recording->size);
    if (percent != recording->shown_percent && !recording->is_impatient) {
        recording->shown_percent = percent;
        message_progress(percent >= 100, "%3u %% of %s", percent, recording->name);
    }
}

/* What is there, rather than all that fits: it may come through a pipe, and live. Returns false at
 * the end, or when there is nothing yet. */
static bool fill(recording_t *recording)
{
    struct pollfd entry = {.fd = recording->fd, .events = POLLIN};
    ssize_t more = 0;
    recording->is_waiting = recording->is_impatient && poll(&entry, 1, 0) == 0;
    if (recording->is_waiting) {
        return false;
    }
    recording->count -= recording->at;
    memmove(recording->buffer, recording->buffer + recording->at, recording->count);
    recording->at = 0;
    do {
        more = read(recording->fd, recording->buffer + recording->count,
                    sizeof recording->buffer - recording->count);
    } while (more < 0 && errno == EINTR);
    recording->error = more < 0 ? errno : 0;
    recording->count += more > 0 ? (size_t)more : 0;
    recording->consumed += more > 0 ? (size_t)more : 0;
    show_progress(recording);
    return more > 0;
}

/* With as much of the file as it takes to tell. Returns false at the end, or when there is not
 * enough yet. */
static bool begin_chunk(recording_t *recording)
{
    bool is_end = false;
    size_t head = 0;
    while (!chunks_begin(&recording->chunks, recording->buffer + recording->at,
                         recording->count - recording->at, is_end, &head)) {
        if (is_end || recording->is_waiting) {
            return false;
        }
        is_end = recording->count - recording->at == sizeof recording->buffer || !fill(recording);
    }
    recording->at += head;
    return true;
}

/* Bytes of a chunk are next; false at the end, or when its time has not come yet. */
static bool find_chunk(recording_t *recording)
{
    while (recording->chunks.left == 0) {
        if (!begin_chunk(recording)) {
            return false;
        }
    }
    recording->is_waiting = recording->chunks.time_us > recording->until_us;
    return !recording->is_waiting;
}

/* More bytes of the lidar's into the ring; returns false at the end, or when there are none yet. */
static bool refill(recording_t *recording)
{
    recording->is_waiting = recording->is_live;
    if (recording->fd < 0) {
        return false;
    }
    if ((recording->is_timed && !find_chunk(recording)) ||
        (recording->at == recording->count && !fill(recording))) {
        return false;
    }
    size_t count = recording->count - recording->at;
    count = count < BLOCK_SIZE ? count : BLOCK_SIZE;
    if (recording->is_timed) {
        count = count < recording->chunks.left ? count : recording->chunks.left;
        recording->chunks.left -= (uint32_t)count;
    }
    tmini_ring_write(&recording->ring, recording->buffer + recording->at, count);
    recording->at += count;
    recording->bytes += count;
    return true;
}

static void begin(recording_t *recording)
{
    recording->at = recording->count = 0;
    recording->bytes = recording->bytes_in_packets = recording->consumed = 0;
    recording->chunks = (chunks_t){0};
    recording->is_at_end = false;
    (void)tmini_ring_init(&recording->ring, recording->memory, sizeof recording->memory, false);
    (void)tmini_parser_init(&recording->parser, &recording->ring, recording->max_samples);
    stream_init(&recording->stream, recording->mount);
}

static void read_magic(recording_t *recording)
{
    while (recording->count < CHUNK_MAGIC_SIZE && fill(recording)) {
    }
    recording->chunks.version = chunk_version(recording->buffer, recording->count);
    recording->is_timed = recording->chunks.version > 0;
    recording->at = recording->is_timed ? CHUNK_MAGIC_SIZE : 0;
}

static void take(recording_t *recording)
{
    tmini_packet_open(&recording->packet, tmini_parser_frame(&recording->parser));
    recording->time_us =
        recording->is_timed ? recording->chunks.time_us : recording->stream.points * US_A_SAMPLE;
    recording->bytes_in_packets += TMINI_PACKET_SIZE((count_t)recording->packet.count);
    (void)stream_take(&recording->stream, &recording->packet,
                      (uint32_t)(recording->time_us / 1000));
    recording->bytes_until = recording_skipped(recording);
    if (recording->stream.packets == 1) {
        recording->bytes_before = recording->bytes_until;
    }
}

bool recording_next(recording_t *recording)
{
    while (!recording->is_at_end) {
        const tmini_frame_type_t frame = tmini_parser_next(&recording->parser);
        if (frame == TMINI_FRAME_PACKET) {
            take(recording);
            return true;
        }
        if (frame == TMINI_FRAME_NONE && !refill(recording)) {
            if (recording->is_waiting) {
                return false;
            }
            recording->is_at_end = tmini_parser_pending(&recording->parser) == 0;
            tmini_parser_abandon(&recording->parser);
        }
    }
    return false;
}

count_t recording_checksum_errors(const recording_t *recording)
{
    tmini_parser_counters_t counters;
    tmini_parser_counters(&recording->parser, &counters);
    return counters.checksum_errors;
}

count_t recording_skipped(const recording_t *recording)
{
    return recording->bytes - recording->bytes_in_packets -
           tmini_parser_pending(&recording->parser);
}

int recording_open(recording_t *recording, const options_t *options)
{
    const bool is_standard = strcmp(options->operand, "-") == 0;
    struct stat status;
    *recording = (recording_t){.max_samples = (uint8_t)options->max_samples,
                               .until_us = UINT64_MAX,
                               .mount = mount_of(options)};
    recording->name = is_standard ? "standard input" : options->operand;
    recording->fd = is_standard ? STDIN_FILENO : open(options->operand, O_RDONLY);
    if (recording->fd < 0) {
        return message_fail("cannot open %s: %s", options->operand, strerror(errno));
    }
    if (fstat(recording->fd, &status) == 0 && S_ISREG(status.st_mode)) {
        recording->size = (count_t)status.st_size;
    }
    begin(recording);
    read_magic(recording);
    if (recording->chunks.version > CHUNK_VERSION) {
        recording_close(recording);
        return message_fail("%s is of version %u: this tmini is too old for it", recording->name,
                            recording->chunks.version);
    }
    return STATUS_OK;
}

void recording_begin_live(recording_t *recording, bool is_timed)
{
    *recording = (recording_t){.fd = -1, .is_live = true, .is_timed = is_timed};
    begin(recording);
}

void recording_feed(recording_t *recording, const uint8_t *bytes, size_t count, uint64_t time_us)
{
    recording->chunks.time_us = time_us;
    recording->bytes += count;
    while (count > 0) {
        const size_t stored = tmini_ring_write(&recording->ring, bytes, count);
        bytes += stored;
        count -= stored;
        while (recording_next(recording)) {
        }
    }
}

void recording_end_live(recording_t *recording)
{
    recording->is_live = false;
    while (recording_next(recording)) {
    }
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
    read_magic(recording);
    return true;
}

int recording_verdict(const recording_t *recording)
{
    if (recording->error != 0) {
        return message_fail("cannot read %s: %s", recording->name, strerror(recording->error));
    }
    if (recording->bytes == 0) {
        return message_fail("%s is empty: nothing was recorded. Was the lidar scanning?",
                            recording->name);
    }
    if (recording->stream.packets == 0) {
        return message_fail("%s holds no lidar packet in %llu bytes: it is not a recording "
                            "of a T-mini Plus,\nor was recorded with another baud rate than "
                            "230400, or before the lidar scanned.",
                            recording->name, recording->bytes);
    }
    if (recording->chunks.damages > 0) {
        message_note("%s is damaged in %u place%s: bytes are missing or wrong there",
                     recording->name, recording->chunks.damages,
                     recording->chunks.damages == 1 ? "" : "s");
    }
    return STATUS_OK;
}

const char *recording_base_name(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL && slash[1] != '\0' ? slash + 1 : path;
}
