/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini decode: what a recording holds, as a summary, as CSV or as JSON. */

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "options.h"
#include "message.h"
#include "points.h"
#include "recording.h"

/* What the summary says of scans that are gone by then. */
typedef struct {
    uint64_t valid; /* Points with a distance. */
    unsigned lowest_chz, highest_chz;
    uint64_t nearest_scan; /* Of the last complete scan. */
    tmini_point_t nearest;
} gist_t;

static void note_packet(gist_t *gist, const recording_t *recording)
{
    tmini_point_t points[UINT8_MAX];
    const size_t count =
        tmini_packet_points(&recording->packet, TMINI_FILTER_NONE, points, UINT8_MAX);
    gist->valid += points_valid(points, count);
    const unsigned chz = recording->stream.frequency_chz;
    if (chz > 0) {
        gist->lowest_chz = gist->lowest_chz == 0 || chz < gist->lowest_chz ? chz : gist->lowest_chz;
        gist->highest_chz = chz > gist->highest_chz ? chz : gist->highest_chz;
    }
    if (recording->stream.has_scan && recording->stream.scan.complete) {
        const tmini_scan_t *const scan = &recording->stream.scan;
        const tmini_point_t *const nearest = points_nearest(scan->points, scan->count);
        gist->nearest_scan = recording->stream.number;
        gist->nearest = nearest != NULL ? *nearest : (tmini_point_t){0};
    }
}

/* The scan that the recording's end cuts off is nobody's fault. */
static void print_scans(const gist_t *gist, const stream_t *stream)
{
    const uint64_t incomplete = stream->scans - stream->complete;
    (void)printf("scans       %" PRIu64 " complete", stream->complete);
    if (incomplete > 0) {
        (void)printf(", %" PRIu64 " with packets missing", incomplete);
    }
    (void)printf("%s\npoints      %" PRIu64 ", %" PRIu64 " of them with a distance",
                 stream->is_open ? "; the next one has begun" : "", stream->points, gist->valid);
    if (stream->points_before > 0) {
        (void)printf("; %" PRIu64 " before the first start packet", stream->points_before);
    }
    (void)printf("\nfrequency   %s", gist->lowest_chz == gist->highest_chz || gist->lowest_chz == 0
                                         ? ""
                                         : frequency_text(gist->lowest_chz));
    (void)printf("%s%s\n", gist->lowest_chz == gist->highest_chz ? "" : " to ",
                 frequency_text(gist->highest_chz));
}

static void print_nearest(const gist_t *gist)
{
    const tmini_point_t *const nearest = &gist->nearest;
    if (gist->nearest_scan == 0) {
        (void)puts("nearest     unknown: no scan is complete");
    } else if (nearest->distance_mm == 0) {
        (void)printf("nearest     nothing in sight in scan %" PRIu64 "\n", gist->nearest_scan);
    } else {
        (void)printf("nearest     %d.%03d m at %d.%d degrees clockwise: %s (scan %" PRIu64 ")\n",
                     nearest->distance_mm / 1000, nearest->distance_mm % 1000,
                     nearest->angle_q6 / 64, nearest->angle_q6 % 64 * 10 / 64,
                     direction_name(nearest->angle_q6), gist->nearest_scan);
    }
}

static void print_unit(const stream_t *stream)
{
    tmini_ct_info_t info;
    char text[FAULTS_TEXT_SIZE];
    tmini_ct_read(&stream->ct, &info);
    if ((info.known & TMINI_KNOWN_FIRMWARE) != 0) {
        (void)printf("unit        firmware %d.%d, hardware %d", info.firmware_major,
                     info.firmware_minor, info.hardware);
        if ((info.known & TMINI_KNOWN_DAY) != 0) {
            (void)printf(", made on %d-%02d-%02d", info.year, info.month, info.day);
        }
        if ((info.known & TMINI_KNOWN_SERIAL) != 0) {
            (void)printf(", serial %d%02d%02d%08" PRIu32, info.year, info.month, info.day,
                         info.number);
        }
        (void)putchar('\n');
    }
    (void)printf("health      %s\n",
                 stream->faults != FAULTS_UNKNOWN ? faults_text(stream->faults, text)
                 : stream_telling(stream) == TELLS_NOTHING
                     ? "not told: this unit sends no information within the stream"
                     : "unknown: no revolution arrived whole");
}

static void print_summary(const gist_t *gist, const recording_t *recording)
{
    const stream_t *const stream = &recording->stream;
    const unsigned permille = stream_damaged_permille(stream);
    print_scans(gist, stream);
    print_nearest(gist);
    print_unit(stream);
    (void)printf("errors      %" PRIu64 " wrong checksums, %" PRIu64 " stray bytes between packets",
                 recording->checksum_errors, stream->stray_bytes);
    if (stream->damaged > 0) {
        (void)printf(": about %" PRIu64 " packets damaged (%u.%u %%)", stream->damaged,
                     permille / 10, permille % 10);
    }
    (void)printf(
        "\nstream      %" PRIu64 " bytes in %" PRIu64 ".%03d s%s: %" PRIu64 " packets, %" PRIu64
        " guard bytes; %" PRIu64 " bytes before the first packet, %" PRIu64 " after the last\n",
        recording->bytes, recording->time_us / 1000000, (int)(recording->time_us / 1000 % 1000),
        recording->is_timed ? "" : " (at 4000 samples a second)", stream->packets,
        stream->guard_bytes, recording->bytes_before,
        recording_skipped(recording) - recording->bytes_until);
}

static void print_counters(FILE *file, const char *format, const recording_t *recording)
{
    (void)fprintf(file, format, recording->stream.packets, recording->stream.start_packets,
                  recording->stream.points, recording->checksum_errors, recording->bytes,
                  recording_skipped(recording));
}

static int write_counters(const char *path, const recording_t *recording)
{
    FILE *const file = strcmp(path, "-") == 0 ? stdout : fopen(path, "w");
    if (file == NULL) {
        return message_fail("cannot write %s: %s", path, strerror(errno));
    }
    print_counters(file,
                   "{\"packets\":%" PRIu64 ",\"start_packets\":%" PRIu64 ",\"points\":%" PRIu64
                   ",\"checksum_errors\":%" PRIu64 ",\"bytes\":%" PRIu64
                   ",\"bytes_skipped\":%" PRIu64 "}\n",
                   recording);
    const bool is_written = file == stdout || fclose(file) == 0;
    return is_written ? STATUS_OK : message_fail("cannot write %s: %s", path, strerror(errno));
}

/* A disk that is full is not written to for ever; main() says why. */
static int print_packets(recording_t *recording, const options_t *options)
{
    if (options->format == FORMAT_CSV) {
        (void)puts(ROWS_HEADER);
    }
    while (ferror(stdout) == 0 && recording_next(recording)) {
        if (options->format == FORMAT_CSV) {
            rows_print_packet(&recording->stream, &recording->packet);
        } else if (recording->stream.has_scan) {
            rows_print_scan(&recording->stream);
        }
        recording_show_progress(recording, options);
    }
    if (options->format == FORMAT_JSON && stream_end(&recording->stream)) {
        rows_print_scan(&recording->stream);
    }
    return ferror(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static void summarise(recording_t *recording, const options_t *options)
{
    gist_t gist = {0};
    while (recording_next(recording)) {
        note_packet(&gist, recording);
        recording_show_progress(recording, options);
    }
    if (recording->stream.packets > 0) {
        print_summary(&gist, recording);
    }
}

static int run(const options_t *options)
{
    static recording_t recording;
    if (options->operand == NULL) {
        return message_usage("decode what? Usage: tmini decode %s", command_decode.usage);
    }
    int status = recording_open(&recording, options);
    if (status != STATUS_OK) {
        return status;
    }
    if (options->format == FORMAT_TEXT) {
        summarise(&recording, options);
    } else {
        status = print_packets(&recording, options);
    }
    if (status == STATUS_OK && options->stats != NULL) {
        status = write_counters(options->stats, &recording);
    } else if (status == STATUS_OK && options->format != FORMAT_TEXT && !options->quiet) {
        print_counters(stderr,
                       "packets %" PRIu64 ", start packets %" PRIu64 ", points %" PRIu64
                       ", checksum errors %" PRIu64 ", bytes %" PRIu64 ", bytes skipped %" PRIu64
                       "\n",
                       &recording);
    }
    recording_close(&recording);
    return status == STATUS_OK ? recording_verdict(&recording) : status;
}

const command_t command_decode = {
    .name = "decode",
    .usage = "FILE|- [--csv|--json] [--stats FILE|-] [--max-samples N]",
    .summary = "what a recording holds: a summary, or every sample",
    .details =
        "Without --csv or --json: scans, points, frequency, nearest obstacle, errors. With\n"
        "them, the same columns and members as `tmini scan`, without end in the memory of a\n"
        "few scans.",
    .accepts = "CJSMq",
    .has_operand = true,
    .run = run,
};
