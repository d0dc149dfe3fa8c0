/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* tmini decode: what a recording holds, as a summary, as CSV or as JSON. */

#include <stdio.h>

#include "options.h"
#include "output.h"
#include "points.h"
#include "recording.h"

/* What the summary needs from scans that no longer exist when it is printed. */
typedef struct {
    count_t valid;        /* Points with a distance. */
    count_t bytes_before; /* Skipped bytes before the first packet. */
    count_t bytes_until;  /* Skipped bytes before the latest packet. */
    unsigned lowest_chz, highest_chz;
    count_t nearest_scan; /* Of the last complete scan. */
    tmini_point_t nearest;
} gist_t;

static void note_packet(gist_t *gist, const tape_t *tape)
{
    const stream_t *const stream = &tape->stream;
    const unsigned chz = stream->frequency_chz;
    tmini_point_t points[UINT8_MAX];
    const size_t count =
        tmini_packet_points(&stream->decoder.packet, TMINI_FILTER_NONE, points, UINT8_MAX);
    gist->bytes_until = tape_skipped(tape);
    gist->bytes_before = stream->packets == 1 ? gist->bytes_until : gist->bytes_before;
    gist->valid += points_survey(points, count).valid;
    if (chz > 0) {
        gist->lowest_chz = gist->lowest_chz == 0 || chz < gist->lowest_chz ? chz : gist->lowest_chz;
        gist->highest_chz = chz > gist->highest_chz ? chz : gist->highest_chz;
    }
    if (stream->has_scan && stream->scan.complete) {
        const survey_t survey = points_survey(stream->scan.points, stream->scan.count);
        gist->nearest_scan = stream->number;
        gist->nearest = survey.nearest != NULL ? *survey.nearest : (tmini_point_t){0};
    }
}

/* An unfinished scan at the end of the recording is no error. */
static void print_scans(const gist_t *gist, const stream_t *stream)
{
    (void)printf("scans       %s%s\npoints      %llu, %llu of them with a distance",
                 scans_text(stream), stream->decoder.builder.open ? "; the next one has begun" : "",
                 stream->points, gist->valid);
    if (stream->points_before > 0) {
        (void)printf("; %llu before the first start packet", stream->points_before);
    }
    (void)printf("\nfrequency   ");
    if (gist->lowest_chz < gist->highest_chz) {
        (void)printf("%s to ", frequency_text(gist->lowest_chz));
    }
    (void)puts(frequency_text(gist->highest_chz));
}

static void print_nearest(const gist_t *gist)
{
    if (gist->nearest_scan == 0) {
        (void)puts("nearest     unknown: no scan is complete");
    } else if (gist->nearest.distance_mm == 0) {
        (void)printf("nearest     nothing in sight in scan %llu\n", gist->nearest_scan);
    } else {
        (void)printf("nearest     %s (scan %llu)\n", place_text(&gist->nearest),
                     gist->nearest_scan);
    }
}

static void print_unit(const stream_t *stream)
{
    tmini_ct_info_t info;
    char text[FAULTS_TEXT_SIZE];
    tmini_ct_read(&stream->decoder.ct, &info);
    if ((info.known & TMINI_KNOWN_FIRMWARE) != 0) {
        (void)printf("unit        firmware %d.%d, hardware %d", info.firmware_major,
                     info.firmware_minor, info.hardware);
        if ((info.known & TMINI_KNOWN_DAY) != 0) {
            (void)printf(", made on %d-%02d-%02d", info.year, info.month, info.day);
        }
        if ((info.known & TMINI_KNOWN_SERIAL) != 0) {
            (void)printf(", serial %d%02d%02d%08u", info.year, info.month, info.day, info.number);
        }
        (void)putchar('\n');
    }
    (void)printf("health      %s\n", health_text(stream, text));
}

static const char *plural(count_t count)
{
    return count == 1 ? "" : "s";
}

static void print_summary(const gist_t *gist, const tape_t *tape)
{
    const stream_t *const stream = &tape->stream;
    print_scans(gist, stream);
    print_nearest(gist);
    print_unit(stream);
    (void)printf("errors      %llu wrong checksum%s, %llu stray byte%s between packets",
                 tape_checksum_errors(tape), plural(tape_checksum_errors(tape)),
                 stream->stray_bytes, plural(stream->stray_bytes));
    if (stream->damaged > 0) {
        (void)printf(": about %llu packet%s damaged (%s)", stream->damaged, plural(stream->damaged),
                     damaged_text(stream));
    }
    (void)printf("\nstream      %llu bytes in %.3f s%s: %llu packets,\n"
                 "            %llu LastCRC bytes, %llu bytes before the first packet, "
                 "%llu after the last\n",
                 tape->bytes, (double)tape->time_us / 1e6,
                 tape->chunks.version > 0 ? "" : " (at 4000 samples per second)", stream->packets,
                 stream->last_crc_bytes, gist->bytes_before,
                 tape_skipped(tape) - gist->bytes_until);
}

static void print_counters(FILE *file, const char *format, const tape_t *tape)
{
    const stream_t *const stream = &tape->stream;
    (void)fprintf(file, format, stream->packets, stream->start_packets, stream->points,
                  tape_checksum_errors(tape), tape->bytes, tape_skipped(tape));
}

/* To the file, if the options name one; otherwise to standard error, as text for people. */
static int report_counters(const tape_t *tape, const options_t *options)
{
    if (options->stats != NULL) {
        FILE *const file = output_open(options->stats);
        if (file == NULL) {
            return STATUS_FAILED;
        }
        print_counters(file,
                       "{\"packets\":%llu,\"start_packets\":%llu,\"points\":%llu,"
                       "\"checksum_errors\":%llu,\"bytes\":%llu,\"bytes_skipped\":%llu}\n",
                       tape);
        return output_close(file, options->stats, STATUS_OK);
    }
    if ((options->csv || options->json) && !options->quiet) {
        print_counters(stderr,
                       "packets %llu, start packets %llu, points %llu, "
                       "checksum errors %llu, bytes %llu, bytes skipped %llu\n",
                       tape);
    }
    return STATUS_OK;
}

/* Stops if writing fails, for example on a full disk; main() prints the reason. */
static int print_packets(recording_t *recording, const options_t *options)
{
    stream_t *const stream = &recording->tape.stream;
    if (options->csv) {
        (void)puts(ROWS_HEADER);
    }
    while (ferror(stdout) == 0 && recording_next(recording)) {
        if (options->csv) {
            rows_print_packet(stream);
        } else if (stream->has_scan) {
            rows_print_scan(stream);
        }
    }
    if (options->json && stream_end(stream)) {
        rows_print_scan(stream);
    }
    return ferror(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static int summarise(recording_t *recording)
{
    gist_t gist = {0};
    while (recording_next(recording)) {
        note_packet(&gist, &recording->tape);
    }
    if (recording->tape.stream.packets > 0) {
        print_summary(&gist, &recording->tape);
    }
    return STATUS_OK;
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
    status =
        options->csv || options->json ? print_packets(&recording, options) : summarise(&recording);
    status = status == STATUS_OK ? report_counters(&recording.tape, options) : status;
    recording_close(&recording);
    return status == STATUS_OK ? recording_verdict(&recording) : status;
}

const command_t command_decode = {
    .name = "decode",
    .usage = "FILE|- [--csv|--json] [--stats FILE|-] [--max-samples N]",
    .summary = "what a recording holds: a summary, or every sample",
    .details = "Without --csv or --json: scans, points, frequency, nearest obstacle, errors.\n"
               "With them, the same columns and members as `tmini scan`. A recording may be of\n"
               "any length.",
    .accepts = "CJSMq",
    .has_operand = true,
    .run = run,
};
